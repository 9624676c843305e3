"""Distances, gradients and second derivatives against brute force and against ipctk.

ipctk is the toolkit of Incremental Potential Contact; it comes with the extra ``oracle``.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dismech_cli.arrays import FloatArray, IntArray
from dismech_cli.contact.drivers.batches import Batches
from dismech_cli.contact.drivers.loops import Loops, loops_of
from dismech_cli.contact.nearby.faces import face_pieces
from dismech_cli.contact.pieces.cores import beside
from dismech_cli.contact.pieces.pieces import Pieces
from dismech_cli.contact.points.points import Points, round_points
from dismech_cli.kernels.numba_driver import NumbaDriver

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


def to_segment(p: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    """Distances of points from segments."""
    u = b - a
    t = np.clip(((p - a) * u).sum(axis=0) / (u * u).sum(axis=0), 0.0, 1.0)
    return np.asarray(np.linalg.norm(p - a - t * u, axis=0))


def between_segments(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> FloatArray:
    """Distances of segments: of ends, or of the points where the lines are nearest."""
    ends = [to_segment(a, c, d), to_segment(b, c, d), to_segment(c, a, b), to_segment(d, a, b)]
    u, v, w = b - a, d - c, a - c
    uu, uv, vv, uw, vw = ((p * q).sum(axis=0) for p, q in ((u, u), (u, v), (v, v), (u, w), (v, w)))
    square = (np.cross(u, v, axis=0) ** 2).sum(axis=0)
    with np.errstate(all="ignore"):
        s, t = (uv * vw - vv * uw) / square, (uu * vw - uv * uw) / square
        inner = np.linalg.norm(w + s * u - t * v, axis=0)
    inside = (square > 0.0) & (s > 0.0) & (s < 1.0) & (t > 0.0) & (t < 1.0)
    return np.min([*ends, np.where(inside, inner, np.inf)], axis=0)


def to_triangle(p: FloatArray, corners: FloatArray) -> FloatArray:
    """Distances of points from triangles."""
    a, b, c = corners
    n = np.cross(b - a, c - a, axis=0)
    sides = [(a, b), (b, c), (c, a)]
    inside = np.all([(np.cross(n, q - r, axis=0) * (p - r)).sum(axis=0) >= 0.0 for r, q in sides], axis=0)
    height = np.abs((n * (p - a)).sum(axis=0)) / np.linalg.norm(n, axis=0)
    return np.min([np.where(inside, height, np.inf), *(to_segment(p, *side) for side in sides)], axis=0)


def through_triangle(p: FloatArray, q: FloatArray, corners: FloatArray) -> FloatArray:
    """Distances of segments from triangles, 0 where they pass through."""
    a, b, c = corners
    n = np.cross(b - a, c - a, axis=0)
    with np.errstate(all="ignore"):
        s = (n * (a - p)).sum(axis=0) / (n * (q - p)).sum(axis=0)
        inner = to_triangle(p + s * (q - p), corners)
    sides = [between_segments(p, q, *side) for side in ((a, b), (b, c), (c, a))]
    through = (s >= 0.0) & (s <= 1.0)
    return np.min(
        [to_triangle(p, corners), to_triangle(q, corners), *sides, np.where(through, inner, np.inf)], axis=0
    )


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
    expected = between_segments(*x)
    found = loops.segment_distances(*laid_out(x))
    # lines all but parallel that pass each other have their foot known to the square root of rounding
    assert_allclose(found, expected, rtol=0, atol=1e-7 if kind == "parallel" else 1e-9)
    assert np.median(np.abs(found - expected)) < 1e-15
    x = drawn(kind, 5, 20_000)
    found = loops.face_distances(*laid_out(x))
    assert_allclose(found, through_triangle(x[0], x[1], x[2:]), rtol=0, atol=1e-9)


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
    ipctk: Any = pytest.importorskip("ipctk", reason="no wheel of ipctk here: pip install 'dismech[oracle]'")
    value, gradient, hessian = squares(points)
    n = len(x)
    worst = np.zeros(3)
    for k in range(len(points.item)):
        s, item = points.s[k], points.item[k]
        places = [(1.0 - s) * x[0, :, item] + s * x[1, :, item], *x[2:, :, item]]
        # the point on the line follows its two nodes
        chain = np.zeros((3 * (n - 1), 3 * n))
        chain[:3, :3], chain[:3, 3:6] = (1.0 - s) * np.eye(3), s * np.eye(3)
        chain[3:, 6:] = np.eye(3 * (n - 2))
        distance = getattr(ipctk, f"{of}_distance")(*places)
        slope = chain.T @ getattr(ipctk, f"{of}_distance_gradient")(*places)
        curve = chain.T @ getattr(ipctk, f"{of}_distance_hessian")(*places) @ chain
        ours = hessian[..., k].transpose(0, 2, 1, 3).reshape(3 * n, 3 * n)
        if distance > 1e-6:
            worst[0] = max(worst[0], abs(2.0 * value[k] - distance) / distance)
            worst[1] = max(worst[1], np.abs(2.0 * gradient[..., k].reshape(-1) - slope).max())
            worst[2] = max(worst[2], np.abs(2.0 * ours - curve).max() / np.abs(curve).max())
    assert worst[0] < 1e-9, worst
    assert worst[1] < 1e-9, worst
    assert worst[2] < 1e-9, worst


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
