"""Sides of triangles. Pure functions of index arrays."""

from __future__ import annotations

import numpy as np

from ...arrays import IntArray


def half_edges(triangles: IntArray) -> IntArray:
    """Return the directed local edges of all triangles.

    Edge j of triangle (v1, v2, v3) is opposite vertex j: v2 -> v3, v3 -> v1, v1 -> v2.

    Args:
        triangles: Shape (T, 3).

    Returns:
        Shape (3 T, 2); row 3 f + j is edge j of triangle f.
    """
    return triangles[:, [1, 2, 2, 0, 0, 1]].reshape(-1, 2)


def shared_sides(triangles: IntArray) -> tuple[IntArray, IntArray]:
    """Pair up the half-edges that lie on each other.

    Args:
        triangles: Manifold triangles, shape (T, 3).

    Returns:
        Rows of :func:`half_edges`, the earlier and the later one of each pair, shape (pairs,) each.
    """
    ordered = np.sort(half_edges(triangles), axis=1)
    order = np.lexsort((ordered[:, 1], ordered[:, 0]))
    shared = (ordered[order[1:]] == ordered[order[:-1]]).all(axis=1)
    return order[:-1][shared], order[1:][shared]


def rim_sides(triangles: IntArray) -> IntArray:
    """Half-edges that belong to one triangle only, the triangle on their left, shape (rim, 2)."""
    sides = half_edges(triangles)
    low, high = sides.min(axis=1), sides.max(axis=1)
    keys = low * (high.max(initial=0) + 1) + high
    _, inverse, counts = np.unique(keys, return_inverse=True, return_counts=True)
    rim: IntArray = sides[counts[inverse.reshape(-1)] == 1]
    return rim
