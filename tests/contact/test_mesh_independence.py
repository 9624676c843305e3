"""The force between rods does not depend on how finely they are cut."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from touching_rods import energy, gradient, neighbours, stiffness

from dismech_cli.arrays import FloatArray

H = 1.0
"""Distance at which the rods touch."""


def straight(length: float, edge: float, direction: FloatArray, through: FloatArray) -> FloatArray:
    s = np.arange(-0.5 * length, 0.5 * length + 0.5 * edge, edge)
    return s[:, None] * direction + through


@pytest.mark.parametrize("degrees", [90, 45, 10])
@pytest.mark.parametrize("edge", [4.0, 1.0, 0.25])
def test_a_straight_crossing_has_no_ripple(degrees: float, edge: float) -> None:
    """The force while one rod slides over the edges of another, and over its own, is one number."""
    angle = np.radians(degrees)
    across = np.array([np.cos(angle), np.sin(angle), 0.0])
    forces = []
    for offset in np.linspace(0.0, edge, 5):
        lower = straight(40.0, edge, np.array([1.0, 0.0, 0.0]), np.array([0.37 * offset, 0.0, 0.0]))
        upper = straight(40.0, edge, across, np.array([offset, 0.0, 0.9]))
        found, x = neighbours([lower, upper], 0.5 * H)
        forces.append(-gradient(found, x)[len(lower) :, 2].sum())
    assert np.ptp(forces) < 1e-10 * np.mean(forces)
    # the law's own number, and the leading order in the depth of a foundation
    assert_allclose(np.mean(forces), 0.0993829 / np.sin(angle), rtol=2e-2)
    assert_allclose(np.mean(forces), 8.0 / 3.0 * np.sqrt(2.0 * H) * 0.1**1.5 / np.sin(angle), rtol=0.2)


@pytest.mark.parametrize("edge", [4.0, 1.0, 0.5])
def test_parallel_rods_carry_two_kappa_delta_per_length(edge: float) -> None:
    depth = 0.01
    lower = straight(12.0, edge, np.array([1.0, 0.0, 0.0]), np.zeros(3))
    upper = straight(12.0, edge, np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, H - depth]))
    found, x = neighbours([lower, upper], 0.5 * H)
    force = -gradient(found, x)[len(lower) :, 2].sum()
    assert_allclose(force / 12.0, 2.0 * depth, rtol=2.0 * depth)


def noisy(rng: np.random.Generator) -> list[FloatArray]:
    s = np.linspace(-5.0, 5.0, 11)
    along = np.stack((s, 0.0 * s, 0.0 * s), axis=1)
    across = np.stack((0.0 * s, s, 0.0 * s + 0.5), axis=1)
    return [chain + 0.15 * rng.normal(size=chain.shape) for chain in (along, across)]


def halved(chain: FloatArray) -> FloatArray:
    out = np.empty((2 * len(chain) - 1, 3))
    out[::2], out[1::2] = chain, 0.5 * (chain[1:] + chain[:-1])
    return out


def test_splitting_every_edge_keeps_the_energy() -> None:
    rng = np.random.default_rng(5)
    for _ in range(10):
        a, b = noisy(rng)
        whole = energy(*neighbours([a, b], 0.5 * H))
        for parts in ([halved(a), b], [a, halved(b)], [halved(a), halved(b)]):
            assert_allclose(energy(*neighbours(parts, 0.5 * H)), whole, rtol=1e-12)


def test_derivatives_on_crooked_rods() -> None:
    """Gradient and Hessian against differences of each other, which fall with the square of the step."""
    rng = np.random.default_rng(6)
    for _ in range(3):
        found, x = neighbours(noisy(rng), 0.5 * H)
        direction = rng.normal(size=x.shape)
        errors = []
        for h in (1e-4, 1e-5):
            ahead, back = x + h * direction, x - h * direction
            slope = (energy(found, ahead) - energy(found, back)) / (2.0 * h)
            errors.append(abs(slope - (gradient(found, x) * direction).sum()))
            assert errors[-1] < 1e2 * h**2 + 1e-9
            curve = (gradient(found, ahead) - gradient(found, back)) / (2.0 * h)
            product = (stiffness(found, x) @ direction.ravel()).reshape(x.shape)
            # across the kinks of the second derivative differences are of first order in places
            assert_allclose(curve, product, atol=1e3 * h)


def test_no_net_force_and_no_net_moment() -> None:
    rng = np.random.default_rng(7)
    found, x = neighbours(noisy(rng), 0.5 * H)
    forces = gradient(found, x)
    size = np.abs(forces).sum()
    assert size > 0.1
    assert np.abs(forces.sum(axis=0)).max() < 1e-14 * size
    assert np.abs(np.cross(x, forces).sum(axis=0)).max() < 1e-13 * size
    assert np.abs(stiffness(found, x) - stiffness(found, x).T).max() < 1e-13
