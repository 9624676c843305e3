"""Follower forces at the tip of a cantilever: large bending by one across it, flutter under one along it.

Sources: Argyris & Symeonidis 1981 (bending), Beck 1952 (flutter). References: ``follower.py``.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from decks import Deck, line, rod_deck, solve, tip
from derivatives import dense
from follower import after_gust, bent_by_follower, flutter
from numpy.testing import assert_allclose
from order import observed_order
from scipy.special import beta

from dismech_cli import load
from dismech_cli.arrays import FloatArray
from dismech_cli.compose.compose import compose
from dismech_cli.kinematics.motion import held_dofs
from dismech_cli.model.model import Model
from dismech_cli.model.state import State
from dismech_cli.solve.integrators import Static
from dismech_cli.solve.system import System

HALF_TURN = 13.7503716
LOADS = (1.0, 5.0, HALF_TURN, 20.0)
SCENARIOS = Path(__file__).parents[2] / "scenarios"


def test_reference_of_the_bent_rod() -> None:
    """Small loads bend as dead ones; half a turn of the tip in closed form."""
    small = bent_by_follower(1e-3)
    assert_allclose([small.z, small.rotation], [1e-3 / 3.0, 0.5e-3], rtol=1e-6)
    half = bent_by_follower(0.5 * beta(0.25, 0.5) ** 2)
    assert_allclose(0.5 * beta(0.25, 0.5) ** 2, HALF_TURN, rtol=1e-8)
    assert_allclose([half.rotation, half.x], [np.pi, 0.0], atol=1e-9)
    assert_allclose(half.z, beta(0.75, 0.5) / beta(0.25, 0.5), rtol=1e-9)


def rod_error(folder: Path, dimension: int, nodes: int, alpha: float) -> float:
    """Distance of the tip from its exact place."""
    deck = rod_deck(
        line(nodes),
        dimension=dimension,
        forces=[{"type": "point", "where": "rod.end", "force": [0.0, 0.0, alpha], "follower": True}],
        numerics={"integrator": {"type": "static", "load_steps": 15}},
    )
    exact = bent_by_follower(alpha)
    return float(np.linalg.norm(tip(solve(folder, deck)) - [exact.x, 0.0, exact.z]))


@pytest.mark.parametrize("alpha", LOADS)
@pytest.mark.parametrize("dimension", [2, 3])
def test_bent_rod(tmp_path: Path, dimension: int, alpha: float) -> None:
    assert rod_error(tmp_path, dimension, 101, alpha) < 1e-3


@pytest.mark.parametrize("dimension", [2, 3])
def test_bent_rod_converges_at_second_order(tmp_path: Path, dimension: int) -> None:
    nodes = np.array([21, 41, 81])
    errors = np.array([rod_error(tmp_path, dimension, int(n), HALF_TURN) for n in nodes])
    assert observed_order(1.0 / (nodes - 1.0), errors) > 1.8


def strip_error(folder: Path, divisions: int, alpha: float, pattern: str) -> float:
    """Distance of the middle of a strip's loaded side from the rod's tip."""
    deck: Deck = {
        "schema_version": 1,
        "name": "strip",
        # E h^3 / 12 = 1 mN m
        "materials": {"m": {"youngs_modulus": 12e6, "poisson_ratio": 0.0, "density": 1000.0}},
        "geometry": [
            {
                "type": "shell",
                "name": "strip",
                "material": "m",
                "thickness": 1e-3,
                "generate": {
                    "shape": "sheet",
                    "origin": [0.0, 0.0, 0.0],
                    "length": 1.0,
                    "width": 0.1,
                    "divisions": divisions,
                    "pattern": pattern,
                },
            }
        ],
        "motions": [{"type": "clamp", "where": "strip.left"}],
        "forces": [
            {
                "type": "line",
                "where": "strip.right",
                "force_per_length": [0.0, 0.0, 1e-3 * alpha],
                "follower": True,
            }
        ],
        "numerics": {"integrator": {"type": "static", "load_steps": 15}},
    }
    frames = solve(folder, deck).frames
    end = frames[0].positions[:, 0] > 1.0 - 1e-9
    exact = bent_by_follower(alpha)
    middle = frames[-1].positions[end].mean(axis=0)
    return float(np.linalg.norm(middle - [exact.x, 0.05, exact.z]))


@pytest.mark.parametrize("alpha", LOADS[:3])
def test_bent_strip(tmp_path: Path, alpha: float) -> None:
    """To 1 % of its length; errors are of second order."""
    errors = np.array([strip_error(tmp_path, n, alpha, "alternating") for n in (10, 20)])
    assert errors[1] < 1e-2
    assert np.log2(errors[0] / errors[1]) > 1.8


@pytest.mark.parametrize("pattern", ["right", "unstructured", "equilateral"])
def test_bent_strip_on_other_meshes(tmp_path: Path, pattern: str) -> None:
    assert strip_error(tmp_path, 20, 5.0, pattern) < 1e-2


# ---------------------------------------------------------------- Beck's column

FLUTTER = 20.0509
AXIAL = 1e8


def column(folder: Path, dimension: int, nodes: int) -> Model:
    """A column along x; the force at its tip is the time."""
    push = {"table": [[0.0, 0.0], [1e3, -1e3]]}
    deck = rod_deck(
        line(nodes),
        dimension=dimension,
        forces=[{"type": "point", "where": "rod.end", "force": [push, 0.0, 0.0], "follower": True}],
        numerics={"integrator": {"type": "implicit_midpoint"}, "dt": 1e-2, "t_end": 1.0},
    )
    file = folder / "column.yaml"
    file.write_text(json.dumps(deck), encoding="utf-8")
    return compose(load(file)).simulation.model


def squares(model: Model, p: float) -> FloatArray:
    """Squared frequencies of small motions about the straight column, ascending in size."""
    dofs, nothing = model.dofs, np.zeros(model.dofs.n)
    q = model.rest.copy()
    dofs.positions(q)[: dofs.visible, 0] *= 1.0 - p / AXIAL
    state = State(p, q, nothing, nothing, model.frames.rest(q))
    system = System(model, ~held_dofs(model.motions, dofs.n, 0.0))
    found = system.linearize(Static().stage(0, state, state, 0.0), q, state.frames)
    free = system.pattern.free
    # balanced, up to the square of the strain
    assert_allclose(found.residual[free], 0.0, atol=1e-6 * p)
    stiffness = dense(system.pattern, found.values)
    values = np.linalg.eigvals(stiffness / model.mass[free, None])
    return np.asarray(values[np.argsort(np.abs(values))])


def critical(model: Model, pairs: int) -> float:
    """Load at which the smallest frequencies meet, by bisection; all motions below it are oscillations.

    Args:
        model: The column.
        pairs: Planes in which it bends.
    """
    low, high = 15.0, 25.0
    while high - low > 1e-4:
        p = 0.5 * (low + high)
        first = squares(model, p)[: 2 * pairs]
        # two that meet part like the root of the load, equal ones of two planes like that of round-off
        if np.abs(first.imag).max() > 1e-4 * np.abs(first).max():
            high = p
        else:
            assert first.real.min() > 0.0, "divergence"
            low = p
    return low


@pytest.mark.parametrize(("dimension", "pairs"), [(2, 1), (3, 2)])
def test_flutter_load_of_becks_column(tmp_path: Path, dimension: int, pairs: int) -> None:
    """The two lowest frequencies meet at 20.0509 EI/L^2, to second order; no load below it buckles."""
    assert_allclose(flutter()[0], FLUTTER, atol=1e-4)
    nodes = np.array([11, 21, 41])
    loads = [critical(column(tmp_path, dimension, int(n)), pairs) for n in nodes]
    errors = np.abs(np.array(loads) / flutter()[0] - 1.0)
    assert errors[-1] < 5e-3
    assert observed_order(1.0 / (nodes - 1.0), errors) > 1.8


def test_no_divergence_of_becks_column(tmp_path: Path) -> None:
    """All squared frequencies stay positive up to flutter: no equilibrium of another shape exists."""
    model = column(tmp_path, 2, 21)
    for p in np.linspace(0.0, 19.5, 14):
        found = squares(model, p)
        assert found.real.min() > 1.0
        assert_allclose(found.imag, 0.0, atol=1e-6 * np.abs(found).max())


def test_expectations_of_the_fluttering_scenario_are_those_of_theory() -> None:
    """`becks_column` is run and compared in tests/scenarios/test_rods.py."""
    expect = load(SCENARIOS / "becks_column.yaml").scenario.expect
    t = np.linspace(0.05, 2.35, 4601)
    for side, p in (("swings", 19.05), ("flutters", 21.05)):
        assert 0.9 * FLUTTER < p < 1.1 * FLUTTER
        x = after_gust(p, 0.01, 0.1)(t)
        assert_allclose(
            [expect[f"{side}_right"].value, expect[f"{side}_left"].value], [x.max(), x.min()], rtol=1e-4
        )


def test_expectations_of_the_bent_scenario_are_those_of_theory() -> None:
    expect = load(SCENARIOS / "verification" / "follower_cantilever.yaml").scenario.expect
    for share, x, z in ((0.5, "half_load_x", "half_load_z"), (1.0, "above_the_root", "height")):
        exact = bent_by_follower(share * HALF_TURN)
        assert_allclose([expect[x].value, expect[z].value], [exact.x, exact.z], atol=1e-7)
