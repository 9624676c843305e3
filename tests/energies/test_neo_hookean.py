"""Rubber: derivatives up to extreme states, closed forms of membranes and rods, small strains."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cases import UNEQUAL, chain, energy_of, framed_rod, planar_rod
from derivatives import complex_gradient, complex_hessian, unpacked
from numpy.testing import assert_allclose

from dismech_cli.arrays import FloatArray
from dismech_cli.energies.membrane import MEMBRANE
from dismech_cli.energies.membrane_neo_hookean import MEMBRANE_NEO_HOOKEAN
from dismech_cli.energies.stretch import STRETCH, STRETCH_PLANAR
from dismech_cli.energies.stretch_neo_hookean import STRETCH_NEO_HOOKEAN, STRETCH_NEO_HOOKEAN_PLANAR
from dismech_cli.kernels.shape import Kernel
from dismech_cli.kinematics.strains import rest_metric
from dismech_cli.sections.shells import plane_stress_stiffness

FACE = np.array([[0, 1, 2]])
MU, THICKNESS = 1.3, 0.1
TRIANGLES = {
    "equilateral": np.array([[0.0, 0, 0], [1, 0, 0], [0.5, 0.866, 0]]),
    "right": np.array([[0.3, 0, 1], [0.3, 2, 1], [-1.2, 0, 1]]),
    "needle": np.array([[0.0, 0, 0], [1, 0, 0], [0.3, 1e-2, 0]]),
}
STATES = {
    "rest": np.eye(2),
    "uniaxial 3": np.diag([3.0, 3.0**-0.5]),
    "equibiaxial 3": 3.0 * np.eye(2),
    "crushed": 0.3 * np.eye(2),
    "flattened": np.diag([1.0, 0.02]),
    "sheared": np.array([[1.0, 2.0], [0.0, 1.0]]),
}


def sides(x: FloatArray) -> FloatArray:
    return np.concatenate((x[1] - x[0], x[2] - x[0]))


def area(x: FloatArray) -> float:
    return 0.5 * float(np.linalg.norm(np.cross(x[1] - x[0], x[2] - x[0])))


def constants(x: FloatArray, growth: float = 0.0) -> FloatArray:
    return np.concatenate(([growth], rest_metric(x, FACE)[:, 0], [MU * THICKNESS * area(x)]))


def deformed(x: FloatArray, plane: FloatArray) -> FloatArray:
    """The triangle with its plane mapped by a 2x2 matrix, then turned in space."""
    u, v = x[1] - x[0], x[2] - x[0]
    first = u / np.linalg.norm(u)
    second = v - (v @ first) * first
    axes = np.stack((first, second / np.linalg.norm(second)))
    turn, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))
    return np.asarray((x @ axes.T) @ plane.T @ turn[:2])


def assert_kernel(kernel: Kernel, y: FloatArray, p: FloatArray, tolerance: float) -> None:
    """Gradient and Hessian by complex steps, relative to the largest term they are made of."""
    _, gradient, hessian = kernel.function(tuple(y), (), tuple(p))
    exact = complex_hessian(kernel, y, np.empty(0), p)
    size = np.abs(exact).max()
    assert_allclose(
        gradient, complex_gradient(kernel, y, np.empty(0), p), rtol=0, atol=tolerance * size * np.abs(y).max()
    )
    assert_allclose(unpacked(hessian, len(y)), exact, rtol=0, atol=tolerance * size)


@pytest.mark.parametrize("growth", [0.0, 0.2])
@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("shape", TRIANGLES)
def test_membrane_derivatives(shape: str, state: str, growth: float) -> None:
    x = TRIANGLES[shape]
    # the metric of the needle loses the square of its aspect ratio, J of the flattened face 1/J^2
    tolerance = 1e-13 * (1e4 if shape == "needle" else 1.0) * (2500.0 if state == "flattened" else 1.0)
    assert_kernel(MEMBRANE_NEO_HOOKEAN, sides(deformed(x, STATES[state])), constants(x, growth), tolerance)


@pytest.mark.parametrize("seed", range(4))
def test_membrane_derivatives_at_random(seed: int) -> None:
    x = TRIANGLES["right"]
    y = sides(x) + 0.5 * np.random.default_rng(seed).normal(size=6)
    assert_kernel(MEMBRANE_NEO_HOOKEAN, y, constants(x), 1e-12)


@pytest.mark.parametrize("shape", TRIANGLES)
@pytest.mark.parametrize("stretches", [(1.5, 1.5**-0.5), (3.0, 3.0), (3.0, 1.0), (0.3, 0.5)])
def test_membrane_energy(shape: str, stretches: tuple[float, float]) -> None:
    """W = mu/2 (a^2 + b^2 + 1/(a b)^2 - 3) of principal stretches."""
    x, (a, b) = TRIANGLES[shape], stretches
    y = sides(deformed(x, np.diag(stretches)))
    energy = MEMBRANE_NEO_HOOKEAN.function(tuple(y), (), tuple(constants(x)))[0]
    exact = 0.5 * MU * THICKNESS * area(x) * (a * a + b * b + 1.0 / (a * b) ** 2 - 3.0)
    assert_allclose(energy, exact, rtol=1e-9)


def test_the_membrane_rests_where_it_has_grown() -> None:
    x = TRIANGLES["right"]
    energy, gradient, _ = MEMBRANE_NEO_HOOKEAN.function(tuple(1.2 * sides(x)), (), tuple(constants(x, 0.2)))
    assert energy < 1e-30
    assert np.abs(gradient).max() < 1e-14


def test_small_strains_of_rubber_are_linear() -> None:
    """At rest both membranes have one Hessian, with nu = 1/2 and E = 3 mu."""
    x = TRIANGLES["right"]
    metric = rest_metric(x, FACE)
    linear = np.concatenate(
        ([0.0], metric[:, 0], plane_stress_stiffness(metric, 3.0 * MU, 0.5, THICKNESS)[:, 0])
    )
    y = tuple(sides(x))
    expected = np.array(MEMBRANE.function(y, (), tuple(linear))[2])
    hessian = np.array(MEMBRANE_NEO_HOOKEAN.function(y, (), tuple(constants(x)))[2])
    assert_allclose(hessian, expected, rtol=0, atol=1e-14 * np.abs(expected).max())


# Rods


@pytest.mark.parametrize("natural", [0.0, 0.2, -0.3])
@pytest.mark.parametrize("stretch", [1.0, 0.3, 3.0, 1e-2])
@pytest.mark.parametrize("kernel", [STRETCH_NEO_HOOKEAN, STRETCH_NEO_HOOKEAN_PLANAR])
def test_rod_derivatives(kernel: Kernel, stretch: float, natural: float) -> None:
    y = stretch * np.array([0.6, 0.64, -0.48])[: kernel.dimension]
    assert_kernel(kernel, y, np.array([natural, 0.7, 1.1, 0.9]), 1e-13)


@pytest.mark.parametrize("natural", [0.0, 0.2])
@pytest.mark.parametrize("stretch", [0.3, 1.0, 2.0, 3.0])
def test_rod_tension(stretch: float, natural: float) -> None:
    """mu A (a - 1/a^2), counted from the natural length; none at rest there."""
    length = 0.8 * (1.0 + natural) * stretch
    energy, gradient, _ = STRETCH_NEO_HOOKEAN.function((length, 0.0, 0.0), (), (natural, 0.0, MU, 0.8))
    assert_allclose(gradient[0], MU * (stretch - stretch**-2), rtol=1e-14, atol=1e-15)
    exact = 0.5 * MU * 0.8 * (1.0 + natural) * (stretch**2 + 2.0 / stretch - 3.0)
    assert_allclose(energy, exact, rtol=1e-13, atol=1e-16)


@pytest.mark.parametrize("planar", [False, True])
def test_linear_edges_among_rubber_are_as_alone(planar: bool) -> None:
    kernel, alone = (STRETCH_NEO_HOOKEAN_PLANAR, STRETCH_PLANAR) if planar else (STRETCH_NEO_HOOKEAN, STRETCH)
    y = (0.7, 0.5) if planar else (0.7, 0.5, -0.2)
    mixed = kernel.function(y, (), (0.1, 2.0, 0.0, 0.9))
    for one, other in zip(mixed, alone.function(y, (), (0.1, 2.0, 0.9)), strict=True):
        assert_allclose(one, other, rtol=1e-15)


def test_small_strains_of_rods_of_rubber_are_linear() -> None:
    x = np.array([[0.0, 0, 0], [0.3, 0.1, 0], [0.5, 0, 0]])
    for model in (framed_rod(x, chain(3), UNEQUAL), planar_rod(x, chain(3), UNEQUAL)):
        term = energy_of(model, "stretch")
        rubber = STRETCH_NEO_HOOKEAN_PLANAR if term.kernel.dimension == 2 else STRETCH_NEO_HOOKEAN
        assert (
            replace(term.kernel, function=rubber.function, constants=rubber.constants, scales=rubber.scales)
            == rubber
        )
        p = np.array([0.0, *term.parameters[1:, 0]])
        y = tuple((term.parameter("length")[0] * np.array([0.6, 0.8, 0.0]))[: rubber.dimension])
        expected = np.array(term.kernel.function(y, (), tuple(p))[2])
        hessian = np.array(rubber.function(y, (), (0.0, 0.0, p[1] / 3.0, p[2]))[2])
        assert_allclose(hessian, expected, rtol=0, atol=1e-14 * np.abs(expected).max())
