"""Large planar bending: tip force, self weight, end moment, and both ends of the Princeton beam.

Sources: Bisshopp & Drucker 1945 and Mattiasson 1981 (tip force), Romero et al. 2021 (self weight),
Sze, Liu & Lo 2004 (roll-up), Dowell & Traybar 1975 (Princeton beam).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from decks import line, rod_deck, solve, tip
from elastica import tip_loaded_elastica
from numpy.testing import assert_allclose
from order import observed_order

from dismech_cli.arrays import FloatArray

# alpha: deflection, shortening, rotation of the tip
TIP_FORCE = {
    0.5: (0.16214358, 0.01591896, 0.24453365),
    1.0: (0.30172077, 0.05643324, 0.46135195),
    2.0: (0.49345748, 0.16064172, 0.78174983),
    5.0: (0.71379152, 0.38762836, 1.21536812),
    10.0: (0.81060902, 0.55499560, 1.43028554),
}
# Gamma: drop and reach of the tip
SELF_WEIGHT = {
    1.0: (0.1234714, 0.9912464),
    5.0: (0.4959050, 0.8466572),
    10.0: (0.7001997, 0.6563538),
    20.0: (0.8298814, 0.4452321),
    50.0: (0.9079171, 0.2450148),
    100.0: (0.9375239, 0.1592234),
    1000.0: (0.9811413, 0.0459865),
}


def tip_force_error(folder: Path, nodes: int, alpha: float, at: str = "node") -> FloatArray:
    """Errors of deflection, shortening and rotation of the tip."""
    deck = rod_deck(
        line(nodes),
        motions=[{"type": "clamp", "where": "rod.start", "at": at}],
        forces=[{"type": "point", "where": "rod.end", "force": [0.0, 0.0, alpha]}],
        numerics={"integrator": {"type": "static", "load_steps": 10}},
    )
    positions = solve(folder, deck).frames[-1].positions
    # the last edges have their directions at their middles, half and three halves of an edge inside,
    # and the curvature of a free end vanishes: the angle is even about it
    last, before = (
        np.arctan2(e[2], e[0]) for e in (positions[-1] - positions[-2], positions[-2] - positions[-3])
    )
    rotation = last + (last - before) / 8.0
    x, _, z = positions[-1]
    return np.array([z, 1.0 - x, rotation]) - np.array(TIP_FORCE[alpha])


@pytest.mark.parametrize("alpha", TIP_FORCE)
def test_reference_of_the_elastica_is_the_tabulated_one(alpha: float) -> None:
    exact = tip_loaded_elastica(alpha)
    assert_allclose([exact.deflection, exact.shortening, exact.rotation], TIP_FORCE[alpha], atol=6e-9)


@pytest.mark.parametrize("alpha", TIP_FORCE)
@pytest.mark.parametrize("nodes", [51, 201])
def test_tip_force(tmp_path: Path, alpha: float, nodes: int) -> None:
    # of second order: 2.4e-4 and 1.5e-5 of the length
    assert np.abs(tip_force_error(tmp_path, nodes, alpha)).max() < 0.6 / (nodes - 1) ** 2


@pytest.mark.parametrize(
    "alpha", [pytest.param(a, marks=() if a in (1.0, 10.0) else pytest.mark.slow) for a in TIP_FORCE]
)
def test_tip_force_converges_at_second_order(tmp_path: Path, alpha: float) -> None:
    nodes = np.array([13, 25, 49, 97])
    errors = [np.linalg.norm(tip_force_error(tmp_path, n, alpha)[:2]) for n in nodes]
    assert observed_order(1.0 / (nodes - 1.0), np.array(errors)) > 1.8


def test_clamp_of_an_edge_acts_half_an_edge_inside(tmp_path: Path) -> None:
    """Documented: two held nodes shorten the free length by half an edge, an error of first order."""
    nodes, alpha = np.array([26, 51, 101]), 1.0
    errors = np.array([tip_force_error(tmp_path, n, alpha, at="edge")[0] for n in nodes])
    assert_allclose(observed_order(1.0 / (nodes - 1.0), np.abs(errors)), 1.0, atol=0.05)
    for n, error in zip(nodes, errors, strict=True):
        # a rod shorter by half an edge feels a smaller alpha, and its deflection scales with it
        free = 1.0 - 0.5 / (n - 1)
        expected = free * tip_loaded_elastica(alpha * free**2).deflection - TIP_FORCE[alpha][0]
        assert_allclose(error, expected, rtol=0.03)


def self_weight_error(folder: Path, nodes: int, gamma: float) -> FloatArray:
    """Errors of drop and reach of the tip."""
    deck = rod_deck(
        line(nodes),
        forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -gamma]}],
        numerics={"integrator": {"type": "static", "load_steps": 20}},
    )
    x, _, z = tip(solve(folder, deck))
    return np.array([-z, x]) - np.array(SELF_WEIGHT[gamma])


@pytest.mark.parametrize("gamma", SELF_WEIGHT)
def test_self_weight(tmp_path: Path, gamma: float) -> None:
    # of second order, and larger where the bend is tighter: 5e-5 to 5e-4 of the length
    assert np.abs(self_weight_error(tmp_path, 101, gamma)).max() < 0.5 / 100**2 * gamma ** (1.0 / 3.0)


@pytest.mark.parametrize("gamma", [10.0, *(pytest.param(g, marks=pytest.mark.slow) for g in (1.0, 100.0))])
def test_self_weight_converges_at_second_order(tmp_path: Path, gamma: float) -> None:
    # the bend of a heavy rod sits in a layer of length Gamma^(-1/3), which coarser meshes do not resolve
    nodes = np.array([51, 101, 201])
    errors = [np.linalg.norm(self_weight_error(tmp_path, n, gamma)) for n in nodes]
    assert observed_order(1.0 / (nodes - 1.0), np.array(errors)) > 1.8


def roll_up_error(folder: Path, nodes: int, turns: float) -> float:
    """Distance of the tip from its exact place, over the length."""
    length, stiffness = 12.0, 100.0
    moment = 2.0 * np.pi * turns * stiffness / length
    deck = rod_deck(
        line(nodes, [length, 0.0, 0.0]),
        {"type": "rectangular", "thickness": 0.1, "width": 1.0},
        rod={"director": [0.0, 0.0, 1.0]},
        materials={"m": {"youngs_modulus": 1.2e6, "poisson_ratio": 0.0, "density": 1000.0}},
        # about -y: upwards
        forces=[{"type": "moment", "where": "rod.end", "moment": [0.0, -float(moment), 0.0]}],
        numerics={"integrator": {"type": "static", "load_steps": 20}},
    )
    angle = 2.0 * np.pi * turns
    exact = length * np.array([np.sin(angle), 0.0, 1.0 - np.cos(angle)]) / angle
    return float(np.linalg.norm(tip(solve(folder, deck)) - exact)) / length


@pytest.mark.parametrize("turns", [0.125, 0.25, 0.5, 0.75, 1.0])
def test_roll_up(tmp_path: Path, turns: float) -> None:
    # the discrete curvature 2 tan(phi/2) turns each joint by (2 pi turns/n)^2/12 less than the moment asks,
    # which puts the tip of a full circle 1.3e-3 L off at 101 nodes
    assert roll_up_error(tmp_path, 201, turns) < 4e-4


def test_roll_up_converges_at_second_order(tmp_path: Path) -> None:
    nodes = np.array([26, 51, 101])
    errors = np.array([roll_up_error(tmp_path, n, 0.5) for n in nodes])
    assert observed_order(1.0 / (nodes - 1.0), errors) > 1.8


@pytest.mark.parametrize("force", [4.448, 8.896, 13.345])
@pytest.mark.parametrize("edgewise", [False, True])
def test_ends_of_the_princeton_beam(tmp_path: Path, force: float, edgewise: bool) -> None:
    """At 0 and 90 degrees of load angle the beam is a plane elastica about either axis."""
    length, width, thickness, modulus = 0.508, 12.3777e-3, 3.2024e-3, 71.7e9
    inertia = (thickness * width**3 if edgewise else width * thickness**3) / 12.0
    alpha = force * length**2 / (modulus * inertia)
    deck = rod_deck(
        line(101, [length, 0.0, 0.0]),
        {"type": "rectangular", "thickness": thickness, "width": width},
        rod={"director": [0.0, 1.0, 0.0] if edgewise else [0.0, 0.0, 1.0]},
        dimension=3,
        materials={"m": {"youngs_modulus": modulus, "poisson_ratio": 0.31, "density": 2810.0}},
        forces=[{"type": "point", "where": "rod.end", "force": [0.0, 0.0, -force]}],
    )
    exact = tip_loaded_elastica(alpha)
    x, y, z = tip(solve(tmp_path, deck)) / length
    assert_allclose([-z, 1.0 - x], [exact.deflection, exact.shortening], atol=1e-4 * exact.deflection)
    assert abs(y) < 1e-9
