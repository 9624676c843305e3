"""Nodes at which parts of a surface hang together by a point."""

from __future__ import annotations

import numpy as np

from ...arrays import IntArray
from .components import components
from .sides import half_edges, neighbours


def pinched_nodes(triangles: IntArray) -> IntArray:
    """Nodes whose triangles fall into fans that share no edge, as between the tips of slits, ascending.

    Args:
        triangles: Shape (T, 3).
    """
    one, two = neighbours(triangles)
    sides = half_edges(triangles)
    # Half-edge 3 f + j runs from corner j + 1 of triangle f to corner j + 2.
    face, j = np.divmod(np.arange(len(sides)), 3)
    tail, head = 3 * face + (j + 1) % 3, 3 * face + (j + 2) % 3
    alike = sides[one, 0] == sides[two, 0]
    joined = np.concatenate(
        (
            np.stack((tail[one], np.where(alike, tail[two], head[two])), axis=1),
            np.stack((head[one], np.where(alike, head[two], tail[two])), axis=1),
        )
    )
    fans, label = components(3 * len(triangles), joined)
    node_of = np.empty(fans, dtype=np.int64)
    node_of[label] = triangles.reshape(-1)
    nodes, counts = np.unique(node_of, return_counts=True)
    pinched: IntArray = nodes[counts > 1]
    return pinched
