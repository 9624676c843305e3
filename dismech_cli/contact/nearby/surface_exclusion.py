"""Lines and triangles that are too near along a body to touch each other."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from ...arrays import FloatArray, IntArray, distinct, union
from .candidates import among
from .faces import Faces

# A line of a body that is nearer to it at rest than both are thick touches it from this share on.
_TIGHT = 0.999


def with_exclusions(faces: Faces, x: FloatArray, line_pairs: IntArray, sides: IntArray) -> Faces:
    """Faces that leave out what is near along a body, and reach less far where a body lies on itself.

    A sheet folded as sharply as it can comes back to itself after half a circle of its mid-plane. What is
    nearer than that at rest, with all that lies between, is kept apart by bending.

    Args:
        faces: Who may touch.
        x: Nodes at rest [m], shape (N, 3).
        line_pairs: Pairs of lines that are near along a body, shape (P, 2); see
            :func:`.exclusion.near_along`.
        sides: Lines that are the sides of each triangle, shape (T, 3).
    """
    lines = np.arange(len(faces.lines.nodes))
    both = np.concatenate((line_pairs, line_pairs[:, ::-1], np.column_stack((lines, lines))))
    order = np.argsort(sides.reshape(-1), kind="stable")
    first = np.searchsorted(sides.reshape(-1)[order], np.arange(len(lines) + 1))
    counts = np.diff(first)[both[:, 1]]
    start = np.repeat(first[both[:, 1]] - np.cumsum(counts) + counts, counts)
    triangle = order[start + np.arange(len(start))] // 3
    near = distinct(faces.keys(np.column_stack((np.repeat(both[:, 0], counts), triangle))))
    found = replace(faces, excluded=near)
    thick = float(faces.lines.radii.max() + faces.surface.halves.max())
    around = found.search(x, (0.5 * pi - 1.0) * thick)
    pairs = found.pairs(around)
    distance = found.distances(x, pairs)
    close = distance < 0.5 * pi * found.thickness(pairs)
    found = replace(found, excluded=_grown(found, near, around[close]))
    left = ~among(around, found.excluded)
    line, face = found.bodies(pairs)
    tight = left & (line == face) & (distance < found.thickness(pairs))
    own_reach = np.full(len(lines), np.inf)
    np.minimum.at(own_reach, pairs[tight, 0], _TIGHT * distance[tight])
    return replace(found, own_reach=own_reach)


def _grown(faces: Faces, near: IntArray, around: IntArray) -> IntArray:
    """Keys with all of those around that hang together with them, triangle by triangle."""
    count = int(faces.surface.nodes.max()) + 1

    def corners(keys: IntArray) -> IntArray:
        pairs = faces.pairs(keys)
        out: IntArray = pairs[:, :1] * count + faces.surface.nodes[pairs[:, 1]]
        return out

    while len(around):
        joined = among(corners(around), distinct(corners(near))).any(axis=1)
        if not joined.any():
            break
        near, around = union(near, around[joined]), around[~joined]
    return near
