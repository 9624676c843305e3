"""Edges that pass through triangles, by signs of volumes alone.

A look at frames that shares nothing with what finds contact.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray

# So many pairs of boxes are looked at together.
_TOGETHER = 1_000_000
# Heights above a plane that differences of coordinates leave unknown, over the largest coordinate.
_ROUNDING = 32.0 * np.finfo(np.float64).eps


def crossings(x: FloatArray, edges: IntArray, triangles: IntArray) -> IntArray:
    """Pairs of an edge and a triangle that it passes through, shape (P, 2); those that share nodes never do.

    Args:
        x: Nodes [m], shape (N, 3).
        edges: Ends, shape (E, 2).
        triangles: Corners, shape (T, 3).
    """
    pairs = _overlapping(_boxes(x, edges), _boxes(x, triangles))
    edge, face = edges[pairs[:, 0]], triangles[pairs[:, 1]]
    apart = (edge[:, :, None] != face[:, None]).all(axis=(1, 2))
    pairs, edge, face = pairs[apart], edge[apart], face[apart]
    p, q = x[edge].transpose(1, 0, 2)
    a, b, c = x[face].transpose(1, 0, 2)
    # an end that lies in the plane, to rounding, is on neither side: neighbours on a flat sheet do not cross
    largest = np.abs(x[np.column_stack((edge, face))]).max(axis=(1, 2), initial=0.0)
    flat = _ROUNDING * largest * np.linalg.norm(b - a, axis=1) * np.linalg.norm(c - a, axis=1)
    ends = _volume(p, a, b, c), _volume(q, a, b, c)
    through = (np.minimum(*ends) < -flat) & (np.maximum(*ends) > flat)
    turn = _volume(p, q, a, b) > 0.0
    through &= (turn == (_volume(p, q, b, c) > 0.0)) & (turn == (_volume(p, q, c, a) > 0.0))
    return np.asarray(pairs[through])


def _volume(p: FloatArray, a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """Six times the signed volume of four points each (K, 3)."""
    return np.asarray((np.cross(b - a, c - a) * (p - a)).sum(axis=1))


def _boxes(x: FloatArray, nodes: IntArray) -> tuple[FloatArray, FloatArray]:
    places = x[nodes]
    return places.min(axis=1), places.max(axis=1)


def _overlapping(first: tuple[FloatArray, FloatArray], second: tuple[FloatArray, FloatArray]) -> IntArray:
    """Pairs of boxes that overlap: sorted along the longest axis and swept."""
    axis = int(np.argmax(np.ptp(np.concatenate(second), axis=0))) if len(second[0]) else 0
    order = np.argsort(second[0][:, axis], kind="stable")
    low, high = second[0][order], second[1][order]
    longest = float((high - low)[:, axis].max(initial=0.0))
    begin = np.searchsorted(low[:, axis], first[0][:, axis] - longest)
    end = np.searchsorted(low[:, axis], first[1][:, axis], side="right")
    counts = end - begin
    found = [np.empty((0, 2), dtype=np.int64)]
    for some in np.split(np.arange(len(counts)), np.flatnonzero(np.diff(np.cumsum(counts) // _TOGETHER)) + 1):
        one = np.repeat(some, counts[some])
        other = np.arange(len(one)) + np.repeat(
            begin[some] - np.cumsum(counts[some]) + counts[some], counts[some]
        )
        near = ((first[0][one] <= high[other]) & (low[other] <= first[1][one])).all(axis=1)
        found.append(np.column_stack((one[near], order[other[near]])))
    return np.concatenate(found)
