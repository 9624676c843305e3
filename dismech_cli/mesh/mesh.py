"""A mesh as plain arrays with named groups."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen


def _no_edges() -> IntArray:
    return np.empty((0, 2), dtype=np.int64)


def _no_triangles() -> IntArray:
    return np.empty((0, 3), dtype=np.int64)


@frozen(kw_only=True)
class Mesh:
    """Nodes, rod edges and shell triangles.

    Attributes:
        nodes: Positions [m], shape (N, 3).
        edges: Node indices of the rod edges, shape (E, 2).
        triangles: Node indices of the shell triangles, shape (T, 3), consistently oriented.
        node_groups: Named sets of node indices, e.g. gmsh physical groups, ``start`` and ``end``.
        edge_groups: Named sets of indices into ``edges``.
        triangle_groups: Named sets of indices into ``triangles``.
        notes: What the reader changed or wants said, one sentence each ("12 quads split ...").
    """

    nodes: FloatArray
    edges: IntArray = field(default_factory=_no_edges)
    triangles: IntArray = field(default_factory=_no_triangles)
    node_groups: Mapping[str, IntArray] = field(default_factory=dict)
    edge_groups: Mapping[str, IntArray] = field(default_factory=dict)
    triangle_groups: Mapping[str, IntArray] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
