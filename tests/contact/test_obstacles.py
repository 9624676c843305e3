"""Shapes of obstacles: distances by brute force, derivatives, moving ones."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dismech_cli.arrays import FloatArray
from dismech_cli.contact.nearby.advance import longest_way
from dismech_cli.contact.obstacles.obstacle import HalfSpace, Obstacle, Rounded, Shape
from dismech_cli.contact.obstacles.pose import Frame, Pose, rotation
from dismech_cli.contact.pieces.cores import BoxCore, Core, LineCore, PointCore, SegmentCore
from dismech_cli.contact.points.points import Points
from dismech_cli.laws.laws import Constant, Ramp

ZERO = Constant(0.0)
AXIS = np.array([0.6, 0.0, 0.8])
CORES: dict[str, Core] = {
    "point": PointCore(np.array([0.1, -0.2, 0.3])),
    "line": LineCore(np.array([0.1, 0.2, -0.1]), AXIS),
    "segment": SegmentCore(np.array([-0.3, 0.0, 0.1]), np.array([0.4, 0.2, -0.1])),
    "box": BoxCore(np.array([0.4, 0.25, 0.15])),
}


def core_distance(name: str, p: FloatArray) -> FloatArray:
    """Distances of points (..., 3) by the textbook."""
    match CORES[name]:
        case PointCore(centre=c):
            gap = p - c
        case LineCore(point=o, axis=k):
            gap = (p - o) - ((p - o) @ k)[..., None] * k
        case SegmentCore(first=a, second=b):
            t = np.clip((p - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
            gap = p - a - t[..., None] * (b - a)
        case BoxCore(half=h):
            gap = p - np.clip(p, -h, h)
    return np.linalg.norm(gap, axis=-1)


def segments(seed: int, count: int) -> tuple[FloatArray, FloatArray]:
    rng = np.random.default_rng(seed)
    start = rng.normal(size=(3, count)) * 0.6
    slope = rng.normal(size=(3, count)) * 0.7
    slope[:, : count // 4] *= np.eye(3)[rng.integers(0, 3, count // 4)].T  # along an axis
    return start, slope


@pytest.mark.parametrize("name", CORES)
def test_distance_of_a_segment(name: str) -> None:
    """No sampled point of a line is nearer than the distance found, and some is about as near."""
    start, slope = segments(1, 400)
    found = CORES[name].pieces(start, slope).nearest(400)
    s = np.linspace(0.0, 1.0, 801)
    p = start.T[:, None] + s[None, :, None] * slope.T[:, None]
    sampled = core_distance(name, p).min(axis=1)
    assert (found <= sampled + 1e-12).all()
    assert (sampled - found < np.linalg.norm(slope, axis=0) / 800.0 + 1e-12).all()


def sums(points: Points, count: int) -> tuple[float, FloatArray, FloatArray]:
    gradient, hessian = np.zeros((2, 3, count)), np.zeros((2, 2, 3, 3, count))
    np.add.at(gradient, (slice(None), slice(None), points.item), points.gradients())
    np.add.at(hessian, (*[slice(None)] * 4, points.item), points.hessians())
    return float(points.energy.sum()), gradient, hessian


SHAPES: dict[str, Shape] = {name: Rounded(core, 0.1) for name, core in CORES.items()}
SHAPES["plane"] = HalfSpace(np.array([0.0, 0.0, -0.1]), AXIS)


@pytest.mark.parametrize("name", SHAPES)
def test_energy_and_derivatives_turned_and_moving(name: str) -> None:
    """Sums against a fine midpoint rule, and derivatives against differences."""
    count = 60
    start, slope = segments(2, count)
    pose = Pose(
        Frame(np.array([[0.1], [0.0], [0.2]]), rotation(AXIS, 0.4)),
        (Ramp(before=0.0, after=0.3, start=0.0, end=1.0), ZERO, ZERO),
        np.array([0.0, 1.0, 0.0]),
        np.array([0.1, 0.2, 0.3]),
        Ramp(before=0.0, after=1.0, start=0.0, end=1.0),
    )
    obstacle = Obstacle(name, SHAPES[name], pose)
    radii, factor = np.full(count, 0.2), np.linspace(1.0, 2.0, count)

    def at(x: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        return sums(obstacle.points(0.5, x[0], x[1] - x[0], radii, factor), count)

    x = np.stack((start, start + slope))
    value, gradient, hessian = at(x)
    frame = pose.at(0.5)
    s = (np.arange(4000) + 0.5) / 4000.0
    p = start[:, :, None] + s * slope[:, :, None]
    local = np.einsum("ji,jkl->kli", frame.turn, p - frame.origin[:, :, None])
    if name == "plane":
        depth = np.maximum(0.2 - (local - [0.0, 0.0, -0.1]) @ AXIS, 0.0)
        density = depth**2
    else:
        density = np.maximum(0.3**2 - core_distance(name, local) ** 2, 0.0) ** 2 / (4.0 * 0.3**2)
    assert_allclose(value, (factor[:, None] * density).mean(axis=1).sum(), rtol=1e-6)
    direction = np.random.default_rng(3).normal(size=x.shape)
    h = 1e-5
    (ahead, g_ahead, _), (back, g_back, _) = at(x + h * direction), at(x - h * direction)
    assert_allclose((ahead - back) / (2.0 * h), (gradient * direction).sum(), rtol=0.0, atol=1e3 * h**2)
    product = np.einsum("ijabs,jbs->ias", hessian, direction)
    assert_allclose((g_ahead - g_back) / (2.0 * h), product, atol=20.0 * h)  # kinks within a step


def test_velocity_of_a_turning_obstacle() -> None:
    pose = Pose(
        Frame(np.zeros((3, 1)), np.eye(3)),
        (Ramp(before=0.0, after=2.0, start=0.0, end=1.0), ZERO, ZERO),
        np.array([0.0, 0.0, 1.0]),
        np.zeros(3),
        Ramp(before=0.0, after=3.0, start=0.0, end=1.0),
    )
    x = np.random.default_rng(4).normal(size=(3, 5))
    arm = x - np.array([[1.0], [0.0], [0.0]])
    expected = np.stack((2.0 - 3.0 * arm[1], 3.0 * arm[0], 0.0 * arm[0]))
    assert_allclose(pose.velocities(0.5, x), expected, atol=1e-8)


def test_a_way_ends_before_what_is_in_it() -> None:
    """A point that flies at a wall a thousand times its gap away is stopped at the wall's least distance."""
    gap, way = 1000.0, 2000.0
    part = longest_way(lambda part, which: gap - part * way, np.array([way]), np.array([0.5]))
    assert 0.5 <= gap - part * way < 0.5 + 0.11 * gap
    free = longest_way(lambda part, which: np.full(1, gap), np.array([10.0]), np.array([0.5]))
    assert free == 1.0
