"""Distances, gradients and second derivatives against brute force and against ipctk.

ipctk is the toolkit of Incremental Potential Contact; it comes with the extra ``oracle``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from benchmarks.oracle.distances import between_segments, to_triangle
from dismech_cli.arrays import FloatArray, IntArray
from dismech_cli.contact.drivers.batches import Batches
from dismech_cli.contact.drivers.loops import Loops, loops_of
from dismech_cli.contact.nearby.faces import face_pieces
from dismech_cli.contact.pieces.cores import beside
from dismech_cli.contact.pieces.pieces import Pieces
from dismech_cli.contact.points.barrier import radial_points
from dismech_cli.contact.points.closest import closest_of_points, closest_of_segments
from dismech_cli.contact.points.points import Points, round_points
from dismech_cli.kernels.numba_driver import NumbaDriver

# Derivatives are compared where things are not nearer than that; squared distances lose digits below.
NEAR = 1e-3
KINDS = ("random", "close", "sliver", "flat", "parallel")


def drawn(kind: str, n: int, count: int) -> FloatArray:
    """Places of a line of two nodes and of what it faces, shape (n, 3, count)."""
    rng = np.random.default_rng([5, n, KINDS.index(kind)])
    x = rng.normal(size=(n, 3, count))
    if kind == "close":
        x[:2, 2] = x[2, 2] + 1e-3 * rng.normal(size=(2, count))
        x[3:, 2] = x[2, 2]
    if kind == "sliver":
        x[3] = x[2] + 1e-3 * (x[3] - x[2])
    if kind == "flat":
        x[:, 2] = 0.0
        x[:2, 2] = 0.3
    if kind == "parallel":
        x[1] = x[0] + rng.uniform(0.2, 2.0, count) * (x[3] - x[2])
    return x


def laid_out(x: FloatArray) -> tuple[FloatArray, IntArray]:
    """Nodes (N, 3) and those of each pair (count, n)."""
    n, _, count = x.shape
    return np.ascontiguousarray(x.transpose(2, 0, 1).reshape(-1, 3)), np.arange(n * count).reshape(count, n)


@pytest.fixture(params=["numpy", "numba"])
def loops(request: pytest.FixtureRequest) -> Loops:
    """Both kinds."""
    if request.param == "numpy":
        return Batches()
    pytest.importorskip("numba")
    return loops_of(NumbaDriver())


@pytest.mark.parametrize("kind", KINDS)
def test_distances_by_brute_force(loops: Loops, kind: str) -> None:
    """20 000 pairs of segments of each kind, never below the least nor above it; then of triangles."""
    x = drawn(kind, 4, 20_000)
    expected = between_segments(x)
    found = loops.segment_distances(*laid_out(x))
    # lines all but parallel that pass each other have their foot known to the square root of rounding
    assert_allclose(found, expected, rtol=0, atol=1e-7 if kind == "parallel" else 1e-9)
    assert np.median(np.abs(found - expected)) < 1e-15
    x = drawn(kind, 5, 20_000)
    found = loops.face_distances(*laid_out(x))
    assert_allclose(found, to_triangle(x), rtol=0, atol=1e-9)


def sampled(pieces: Pieces) -> Points:
    """Points on all pieces."""
    count = int(pieces.item.max()) + 1
    return round_points(pieces, np.full(count, 1e3), np.ones(count))


def squares(points: Points) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Half the squared gap, its gradient (n, 3, K) and its second derivative (n, n, 3, 3, K)."""
    one = np.ones(len(points.item))
    value = 0.5 * (points.gap * points.gap).sum(axis=0)
    return value, points.directions(), replace(points, along=0.0 * one, bend=one).hessians()


def assert_as_ipctk(points: Points, x: FloatArray, of: str) -> None:
    """Every point against the functions of ipctk with this beginning."""
    n = len(x)
    worst = np.zeros(3)
    for k, (half, gradient, hessian) in enumerate(_each(points, n)):
        s, item = points.s[k], points.item[k]
        places = [(1.0 - s) * x[0, :, item] + s * x[1, :, item], *x[2:, :, item]]
        distance, slope, curve = of_ipctk(of, places)
        # the point on the line follows its two nodes
        chain = np.zeros((3 * (n - 1), 3 * n))
        chain[:3, :3], chain[:3, 3:6] = (1.0 - s) * np.eye(3), s * np.eye(3)
        chain[3:, 6:] = np.eye(3 * (n - 2))
        slope, curve = chain.T @ slope, chain.T @ curve @ chain
        if distance > NEAR**2:
            worst[0] = max(worst[0], abs(2.0 * half - distance) / distance)
            worst[1] = max(worst[1], np.abs(2.0 * gradient - slope).max() / np.abs(slope).max())
            worst[2] = max(worst[2], np.abs(2.0 * hessian - curve).max() / np.abs(curve).max())
    assert (worst < 1e-11).all(), worst


def _each(points: Points, n: int) -> Iterator[tuple[float, FloatArray, FloatArray]]:
    """Half the squared gap of every point, its gradient (3 n,) and its second derivative (3 n, 3 n)."""
    value, gradient, hessian = squares(points)
    for k in range(len(points.item)):
        matrix = hessian[..., k].transpose(0, 2, 1, 3).reshape(3 * n, 3 * n)
        yield value[k], gradient[..., k].reshape(-1), matrix


def of_ipctk(of: str, places: Sequence[FloatArray]) -> tuple[float, FloatArray, FloatArray]:
    """Squared distance with its derivatives."""
    ipctk: Any = pytest.importorskip("ipctk", reason="no wheel of ipctk here: pip install 'dismech[oracle]'")
    names = (f"{of}_distance", f"{of}_distance_gradient", f"{of}_distance_hessian")
    distance, gradient, hessian = (getattr(ipctk, name)(*places) for name in names)
    return distance, gradient, hessian


@pytest.mark.parametrize("count", [60, pytest.param(7000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("kind", ["random", "close", "flat", "parallel"])
def test_segments_as_ipctk(kind: str, count: int) -> None:
    """Distance, gradient and second derivative at points that face an end or the inside."""
    x = drawn(kind, 4, count)
    start, end, first, second = x
    assert_as_ipctk(sampled(beside(start, end - start, first, second)), x, "point_edge")


@pytest.mark.parametrize("count", [60, pytest.param(7000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("kind", ["random", "close", "flat"])
def test_triangles_as_ipctk(kind: str, count: int) -> None:
    """The same with triangles."""
    x = drawn(kind, 5, count)
    pieces, _ = face_pieces(*laid_out(x))
    assert_as_ipctk(sampled(pieces), x, "point_triangle")


@pytest.mark.parametrize("count", [60, pytest.param(10_000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("of", ["edge_edge", "point_triangle"])
def test_closest_points_as_ipctk(of: str, kind: str, count: int) -> None:
    """What a barrier asks for: edges with edges and nodes with triangles, whatever features are nearest."""
    x = drawn(kind, 5, count)
    if of == "edge_edge":
        x = x[:4]
        at = closest_of_segments(x)
    else:
        x = x[[0, 2, 3, 4]]
        at = closest_of_points(x[0], x[1:])
    gap = at.distance
    points = radial_points(at, gap, 0.5 * gap * gap, gap, np.ones(count))
    # where lines are parallel many points are closest, and each has a gradient of its own
    unique = (of, kind) != ("edge_edge", "parallel")
    worst = np.zeros(3)
    for k, (half, gradient, hessian) in enumerate(_each(points, 4)):
        distance, slope, curve = of_ipctk(of, list(x[..., k]))
        worst[0] = max(worst[0], abs(np.sqrt(2.0 * half) - np.sqrt(distance)))
        if distance > NEAR**2 and unique:
            worst[1] = max(worst[1], np.abs(2.0 * gradient - slope).max() / np.abs(slope).max())
            worst[2] = max(worst[2], np.abs(2.0 * hessian - curve).max() / np.abs(curve).max())
    assert worst[0] < 1e-14 * np.ptp(x), worst
    # the thinner a triangle is, the fewer digits its normal has
    assert (worst[1:] < (1e-10 if kind == "sliver" else 1e-11)).all(), worst
