"""Sides of triangles. Pure functions of index arrays."""

from __future__ import annotations

import numpy as np

from ...arrays import BoolArray, IntArray


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
    """Pair up the half-edges that lie on each other, two by two; more at an edge are left out.

    Args:
        triangles: Shape (T, 3).

    Returns:
        Rows of :func:`half_edges`, the earlier and the later one of each pair, shape (pairs,) each.
    """
    order, same = _sorted_sides(triangles)
    before, after = (np.concatenate(([False], same))[:-1], np.concatenate((same, [False]))[1:])
    pair = same & ~before & ~after
    return order[:-1][pair], order[1:][pair]


def neighbours(triangles: IntArray) -> tuple[IntArray, IntArray]:
    """Half-edges that lie on each other, each with the next: m at an edge make a chain of m - 1 pairs."""
    order, same = _sorted_sides(triangles)
    return order[:-1][same], order[1:][same]


def _sorted_sides(triangles: IntArray) -> tuple[IntArray, BoolArray]:
    """An order of the half-edges that puts together those of an edge, and which are as the one before."""
    keys = row_keys(half_edges(triangles))
    order = np.argsort(keys, kind="stable")
    return order, keys[order[1:]] == keys[order[:-1]]


def rim_sides(triangles: IntArray) -> IntArray:
    """Half-edges that belong to one triangle only, the triangle on their left, shape (rim, 2)."""
    sides = half_edges(triangles)
    rim: IntArray = sides[side_counts(triangles) == 1]
    return rim


def side_counts(triangles: IntArray) -> IntArray:
    """Number of triangles at the edge of each half-edge, shape (3 T,)."""
    _, inverse, counts = np.unique(row_keys(half_edges(triangles)), return_inverse=True, return_counts=True)
    found: IntArray = counts[inverse.reshape(-1)]
    return found


def row_keys(rows: IntArray) -> IntArray:
    """One number for the nodes of each row, whatever their order, shape (k,).

    They sort as the sorted rows do, and ten times as fast. Meshes have two million nodes at most, so that
    three fit.

    Args:
        rows: Two or three node numbers in each, shape (k, 2 or 3).
    """
    ordered = np.sort(rows, axis=1)
    base = int(ordered.max(initial=0)) + 1
    keys: IntArray = ordered[:, 0]
    for column in ordered.T[1:]:
        keys = keys * base + column
    return keys
