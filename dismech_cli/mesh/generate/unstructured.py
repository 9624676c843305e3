"""Unstructured triangulation of a rectangle: Delaunay triangles of random points kept apart."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray
from ...errors import MeshError
from ..measure import corner_angles
from ..topology.sides import half_edges

MAX_NODES = 100_000
"""Largest unstructured sheet made here; larger ones are work for a mesher."""

_APART = 0.75  # Least distance of the random points, in edge lengths: gives edges of about 1.
_CANDIDATES = 30  # Per unit area; about ten times as many as fit.
_SWEEPS = 8
_SEEDS = 8
_ALL_SEEDS = 40_000  # Nodes of all of them: large sheets always have a bad angle somewhere, and take long.
_GOOD_ANGLE = 25.0


def unstructured_sheet(length: float, width: float, divisions: int) -> tuple[FloatArray, IntArray]:
    """Triangulate 0 <= x <= length, 0 <= y <= width with edges of about length / divisions.

    The boundary points are evenly spaced and stay put. Inner points are random, a fixed distance
    apart, and move a few times to the mean of their Delaunay neighbours. Of a few fixed seeds, the
    fewer the larger the sheet, the first whose smallest angle exceeds 25 degrees is taken, else the
    best. The same input always gives the same mesh.

    Args:
        length: Size along x [m].
        width: Size along y [m].
        divisions: Number of edges along the length.

    Returns:
        Nodes [m], shape (N, 3), and counter-clockwise triangles, shape (T, 3).

    Raises:
        MeshError: If there would be more than :data:`MAX_NODES` nodes.
    """
    # Lengths in edge lengths, so that the numbers below are pure.
    size = np.array([float(divisions), width / length * divisions])
    rows = max(1, round(size[1]))
    count = size.prod() + 2 * (divisions + rows)
    if count > MAX_NODES:
        raise MeshError(f"sheet: over {MAX_NODES} unstructured nodes; make such a mesh with gmsh")
    border = _border(divisions, rows, size)
    best = -1.0
    for seed in range(max(1, min(_SEEDS, int(_ALL_SEEDS / count)))):
        inner = _scatter(size, border, np.random.default_rng(seed))
        candidate, faces = _relax(border, inner)
        angle = smallest_angle(np.column_stack([candidate, np.zeros(len(candidate))]), faces)
        if angle > best:
            best, points, triangles = angle, candidate, faces
        if angle > _GOOD_ANGLE:
            break
    nodes = np.column_stack([points * (length / divisions), np.zeros(len(points))])
    # Scaling may miss the sides by a rounding error; the sides are exact by contract.
    nodes[: len(border), 0][border[:, 0] == size[0]] = length
    nodes[: len(border), 1][border[:, 1] == size[1]] = width
    return nodes, triangles


def smallest_angle(nodes: FloatArray, triangles: IntArray) -> float:
    """Return the smallest corner angle of all triangles [degrees].

    Args:
        nodes: Shape (N, 3).
        triangles: Shape (T, 3).
    """
    return float(np.degrees(corner_angles(nodes, triangles).min()))


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


def _scatter(size: FloatArray, border: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Throw points at random and keep those that lie apart from all kept before them."""
    from scipy.spatial import cKDTree

    thrown = rng.uniform(0.0, size, (int(_CANDIDATES * size.prod()) + 1, 2))
    inside = ((thrown > 0.6) & (thrown < size - 0.6)).all(axis=1)
    thrown = thrown[inside]
    free = np.asarray(cKDTree(border).query(thrown)[0]) > 0.9 * _APART
    tree = cKDTree(thrown)
    kept = []
    for index, point in enumerate(thrown):
        if free[index]:
            kept.append(index)
            free[tree.query_ball_point(point, _APART)] = False
    scattered: FloatArray = thrown[kept]
    return scattered


def _relax(border: FloatArray, inner: FloatArray) -> tuple[FloatArray, IntArray]:
    """Move inner points to the mean of their neighbours, a few times; return points and triangles."""
    from scipy.spatial import Delaunay

    points = np.concatenate([border, inner])
    for _ in range(_SWEEPS):
        triangles = Delaunay(points).simplices.astype(np.int64)
        sides = half_edges(triangles).reshape(-1, 3, 2)
        pairs = np.concatenate([sides, sides[:, :, ::-1]], axis=1).reshape(-1, 2)
        total = np.zeros_like(points)
        np.add.at(total, pairs[:, 0], points[pairs[:, 1]])
        mean = total / np.bincount(pairs[:, 0], minlength=len(points))[:, None]
        points = np.concatenate([border, mean[len(border) :]])
    return points, _counter_clockwise(points, Delaunay(points).simplices.astype(np.int64))


def _counter_clockwise(points: FloatArray, triangles: IntArray) -> IntArray:
    """Wind triangles counter-clockwise and drop the flat ones that Delaunay makes along straight sides."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    wound = np.where((area < 0.0)[:, None], triangles[:, [0, 2, 1]], triangles)
    return wound[np.abs(area) > 1e-9]
