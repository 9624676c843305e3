"""Unstructured triangulation of a rectangle: Delaunay triangles of a relaxed random point set."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray

_SEED = 20_250_101
_SWEEPS = 12


def unstructured_sheet(length: float, width: float, divisions: int) -> tuple[FloatArray, IntArray]:
    """Triangulate 0 <= x <= length, 0 <= y <= width with edges of about length / divisions.

    The boundary points are evenly spaced and stay put. Inner points start from a jittered triangular
    lattice and move, a few times over, to the mean of their Delaunay neighbours.

    Args:
        length: Size along x [m].
        width: Size along y [m].
        divisions: Number of edges along the length.

    Returns:
        Nodes [m], shape (N, 3), and counter-clockwise triangles, shape (T, 3).
    """
    from scipy.spatial import Delaunay

    # Lengths in edge lengths, so that the numbers below are pure.
    rows = max(1, round(width / length * divisions))
    size = np.array([float(divisions), float(width / length * divisions)])
    border = _border(divisions, rows, size)
    points = np.concatenate([border, _lattice(size)])
    fixed = len(border)
    for _ in range(_SWEEPS):
        triangles = Delaunay(points).simplices.astype(np.int64)
        pairs = triangles[:, [0, 1, 1, 2, 2, 0, 1, 0, 2, 1, 0, 2]].reshape(-1, 2)
        total = np.zeros_like(points)
        np.add.at(total, pairs[:, 0], points[pairs[:, 1]])
        mean = total / np.bincount(pairs[:, 0], minlength=len(points))[:, None]
        points = np.concatenate([border, mean[fixed:]])
    triangles = _counter_clockwise(points, Delaunay(points).simplices.astype(np.int64))
    nodes = np.column_stack([points * (length / divisions), np.zeros(len(points))])
    # Scaling may miss the sides by a rounding error; the sides are exact by contract.
    nodes[:fixed, 0][border[:, 0] == size[0]] = length
    nodes[:fixed, 1][border[:, 1] == size[1]] = width
    return nodes, triangles


def _border(columns: int, rows: int, size: FloatArray) -> FloatArray:
    """Evenly spaced points along the four sides, counter-clockwise from the origin."""
    x, y = np.linspace(0.0, size[0], columns + 1), np.linspace(0.0, size[1], rows + 1)
    return np.concatenate(
        [
            np.column_stack([x[:-1], np.zeros(columns)]),
            np.column_stack([np.full(rows, size[0]), y[:-1]]),
            np.column_stack([x[:0:-1], np.full(columns, size[1])]),
            np.column_stack([np.zeros(rows), y[:0:-1]]),
        ]
    )


def _lattice(size: FloatArray) -> FloatArray:
    """Jittered triangular lattice of unit edge, kept half an edge away from the border."""
    height = np.sqrt(3.0) / 2.0
    x, y = np.meshgrid(np.arange(-1.0, size[0] + 1.0), np.arange(-1.0, size[1] / height + 1.0))
    x += 0.5 * (np.round(y) % 2)
    points = np.column_stack([x.ravel(), y.ravel() * height])
    points += np.random.default_rng(_SEED).uniform(-0.25, 0.25, points.shape)
    inside = ((points > 0.6) & (points < size - 0.6)).all(axis=1)
    kept: FloatArray = points[inside]
    return kept


def _counter_clockwise(points: FloatArray, triangles: IntArray) -> IntArray:
    """Wind triangles counter-clockwise and drop the flat ones that Delaunay makes along straight sides."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    wound = np.where((area < 0.0)[:, None], triangles[:, [0, 2, 1]], triangles)
    return wound[np.abs(area) > 1e-9]
