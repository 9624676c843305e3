"""The barrier and the closest points that it acts at: against sampling and differences."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rigid_boxes import box

from dismech_cli.arrays import FloatArray
from dismech_cli.contact.obstacles.obstacle import HalfSpace, Rounded, Shape
from dismech_cli.contact.obstacles.rigid_surface import RigidSurface
from dismech_cli.contact.pieces.cores import BoxCore, LineCore, PointCore, SegmentCore
from dismech_cli.contact.points.barrier import Closest, barrier, barrier_points, convex
from dismech_cli.contact.points.closest import closest_of_points, closest_of_segments

Find = Callable[[FloatArray], Closest]


def of_segments(x: FloatArray) -> Closest:
    return closest_of_segments(x)


def of_points(x: FloatArray) -> Closest:
    return closest_of_points(x[0], x[1:])


FINDERS: dict[str, Find] = {"segments": of_segments, "points": of_points}


def states(seed: int, count: int) -> FloatArray:
    """Four nodes of each pair, shape (4, 3, K): nearly parallel, flat, touching, tiny, then random ones."""
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(4, 3, count))
    few = count // 5
    x[3, :, :few] = x[2, :, :few] + (x[1] - x[0])[:, :few] + 1e-4 * rng.normal(size=(3, few))
    x[:, 2, few : 2 * few] *= 1e-3
    x[0, :, 2 * few : 3 * few] = x[2, :, 2 * few : 3 * few] + 1e-3 * rng.normal(size=(3, few))
    x[:, :, 3 * few : 4 * few] *= 1e-4
    return x


def sampled(name: str, x: FloatArray) -> FloatArray:
    """Least distance of many points."""
    a = np.linspace(0.0, 1.0, 101)
    if name == "segments":
        p = x[0][..., None] * (1.0 - a) + x[1][..., None] * a
        q = x[2][..., None] * (1.0 - a) + x[3][..., None] * a
    else:
        u, v = np.meshgrid(a, a)
        u, v = u[u + v <= 1.0 + 1e-9], v[u + v <= 1.0 + 1e-9]
        p, q = x[0][..., None], x[1][..., None] * (1.0 - u - v) + x[2][..., None] * u + x[3][..., None] * v
    apart = p[..., :, None] - q[..., None, :]
    return np.sqrt((apart * apart).sum(axis=0).min(axis=(1, 2)))


@pytest.mark.parametrize("name", FINDERS)
def test_distances(name: str) -> None:
    x = states(1, 60)
    at = FINDERS[name](x)
    assert_allclose((at.weights[:, None] * x).sum(axis=0), at.gap, atol=1e-11)
    assert_allclose(at.weights.sum(axis=0), 0.0, atol=1e-12)
    size = np.linalg.norm(x - x.mean(axis=0), axis=1).max(axis=0)
    close = sampled(name, x)
    assert (at.distance <= close + 1e-12).all()
    assert (close - at.distance <= 0.05 * size).all()


@pytest.mark.parametrize("share", [0.1, 0.6, 0.999])
@pytest.mark.parametrize("name", FINDERS)
def test_derivatives(name: str, share: float) -> None:
    """Energy, gradient and Hessian against differences: soft, hard and almost at the stop."""
    x = states(2, 200)
    reach = FINDERS[name](x).distance * np.linspace(0.2, 0.8, 200)
    stop = FINDERS[name](x).distance - (1.0 - share) * reach
    size = np.linalg.norm(x - x.mean(axis=0), axis=1).max(axis=0)
    direction = np.random.default_rng(3).normal(size=x.shape)

    def at(x: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        points = barrier_points(FINDERS[name](x), stop, reach, np.ones(200))
        hessian = np.einsum("ijabk,jbk->iak", points.hessians(), direction)
        return points.energy, points.gradients(), hessian

    energy, gradient, hessian = at(x)
    gap = (1.0 - share) * reach
    # where a pair is near for its size, rounding of places is much of a gap: no smaller steps
    step = 3e-4 * np.minimum(gap, 0.05 * size)
    (ahead, g_ahead, _), (back, g_back, _) = at(x + step * direction), at(x - step * direction)
    first = np.abs((ahead - back) / (2.0 * step) - (gradient * direction).sum(axis=(0, 1)))
    second = np.abs((g_ahead - g_back) / (2.0 * step) - hessian).max(axis=(0, 1)) * gap
    scale = np.abs(gradient).max(axis=(0, 1))
    # the others change the features that are closest within the step, parallel ones by the least motion
    assert (first < 1e-5 * scale)[40:].mean() > 0.98
    assert (second < 1e-5 * scale)[40:].mean() > 0.98
    assert (first < 1e-5 * scale)[:40].mean() > 0.7
    assert (energy > 0.0).all()


@pytest.mark.parametrize("name", FINDERS)
def test_net_force_and_moment(name: str) -> None:
    x = states(4, 100)
    at = FINDERS[name](x)
    points = barrier_points(at, 0.5 * at.distance, at.distance, np.ones(100))
    force = points.gradients()
    size = np.abs(force).max(axis=(0, 1))
    assert_allclose(force.sum(axis=0) / size, 0.0, atol=1e-13)
    moment = np.cross(x, force, axis=1).sum(axis=0)
    assert_allclose(moment / size, 0.0, atol=1e-9)


def test_what_newton_is_given_is_convex() -> None:
    at = closest_of_segments(states(5, 100))
    points = convex(barrier_points(at, 0.5 * at.distance, at.distance, np.ones(100)))
    matrices = points.hessians().transpose(4, 0, 2, 1, 3).reshape(100, 12, 12)
    values = np.linalg.eigvalsh(matrices)
    assert (values[:, 0] > -1e-9 * values[:, -1]).all()


def test_the_law_is_smooth_and_has_no_end() -> None:
    reach, k = 0.4, 3.0
    for gap in (0.2, 0.4):
        low, high = barrier(gap - 1e-9, reach, k), barrier(gap + 1e-9, reach, k)
        assert_allclose(low[:2], high[:2], atol=1e-7)
    assert_allclose(barrier(0.2 - 1e-12, reach, k)[2], barrier(0.2 + 1e-12, reach, k)[2], rtol=1e-9)
    assert barrier(1e-100, reach, k)[0] > 100.0 * barrier(0.2, reach, k)[0]
    assert barrier(0.5, reach, k) == (0.0, 0.0, 0.0)
    assert np.isinf(barrier(0.0, reach, k)).all()


AXIS = np.array([0.6, 0.0, 0.8])
SHAPES: dict[str, Shape] = {
    "plane": HalfSpace(np.array([0.0, 0.0, -0.1]), AXIS),
    "ball": Rounded(PointCore(np.array([0.1, -0.2, 0.3])), 0.1),
    "cylinder": Rounded(LineCore(np.array([0.1, 0.2, -0.1]), AXIS), 0.1),
    "capsule": Rounded(SegmentCore(np.array([-0.3, 0.0, 0.1]), np.array([0.4, 0.2, -0.1])), 0.1),
    "box": Rounded(BoxCore(np.array([0.4, 0.25, 0.15])), 0.1),
    "mesh": RigidSurface.of(*box(1), 0.05),
}


@pytest.mark.parametrize("name", SHAPES)
def test_rigid_things(name: str) -> None:
    """Distances are those of the surface, and derivatives those of differences."""
    rng = np.random.default_rng(6)
    count = 300
    start, slope = rng.normal(size=(3, count)) * 0.8, rng.normal(size=(3, count)) * 0.5
    shape = SHAPES[name]
    gaps = shape.gaps(start, slope)
    far = gaps > 0.02
    start, slope, gaps = start[:, far], slope[:, far], gaps[far]
    count = len(gaps)
    more = shape.rounding + 1.5 * gaps
    found = shape.closest(start, slope, more)
    nearest = np.full(count, np.inf)
    np.minimum.at(nearest, found.item, found.distance - shape.rounding)
    assert_allclose(nearest, gaps, atol=1e-12)
    direction = rng.normal(size=(2, 3, count))

    def at(x: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        found = shape.closest(x[0], x[1] - x[0], more)
        stop = shape.rounding + 0.9 * gaps[found.item]
        points = barrier_points(found, stop, 0.3 * gaps[found.item], np.ones(len(stop)))
        energy, gradient, turned = np.zeros(count), np.zeros((2, 3, count)), np.zeros((2, 3, count))
        product = np.einsum("ijabk,jbk->iak", points.hessians(), direction[:, :, points.item])
        np.add.at(energy, points.item, points.energy)
        np.add.at(gradient, (slice(None), slice(None), points.item), points.gradients())
        np.add.at(turned, (slice(None), slice(None), points.item), product)
        return energy, gradient, turned

    x = np.stack((start, start + slope))
    _, gradient, hessian = at(x)
    step = 1e-5 * gaps
    (ahead, g_ahead, _), (back, g_back, _) = at(x + step * direction), at(x - step * direction)
    first = np.abs((ahead - back) / (2.0 * step) - (gradient * direction).sum(axis=(0, 1)))
    second = np.abs((g_ahead - g_back) / (2.0 * step) - hessian).max(axis=(0, 1)) * gaps
    scale = np.abs(gradient).max(axis=(0, 1))
    assert (scale > 0.0).all()
    assert (first < 1e-5 * scale).mean() > 0.97
    assert (second < 1e-4 * scale).mean() > 0.95
