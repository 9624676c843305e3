"""Accounts of force, momentum and energy: what no model of a rod may violate."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import Deck, given_section, line, rod_deck, scalar, solve, tip
from numpy.testing import assert_allclose
from order import observed_order

from dismech_cli.arrays import FloatArray
from dismech_cli.session.report import Report

INTEGRATORS: dict[str, int] = {
    "implicit_euler": 1,
    "implicit_midpoint": 2,
    "newmark": 2,
    "generalized_alpha": 2,
    "tr_bdf2": 2,
}

# the others hold the same laws in the slow set
QUICK = [
    pytest.param(name, marks=() if name in ("implicit_euler", "generalized_alpha") else pytest.mark.slow)
    for name in INTEGRATORS
]


def timed(integrator: str, dt: float, t_end: float, **keys: Any) -> Deck:
    return {"integrator": {"type": integrator}, "dt": dt, "t_end": t_end, **keys}


TWISTED: Deck = {"natural": {"curvature_1": 0.8, "curvature_2": -0.5, "twist": 1.5}}


def free_rod(folder: Path, integrator: str, dt: float, t_end: float, rod: Deck) -> Report:
    """A rod that nobody holds, flung so that it tumbles, bends and stretches."""
    nodes = 15
    along = np.vander(np.linspace(-1.0, 1.0, nodes), 4)
    velocities = along @ np.random.default_rng(7).normal(scale=0.3, size=(4, 3))
    np.savetxt(folder / "velocities.csv", velocities, delimiter=",", header="x,y,z", comments="")
    deck = rod_deck(
        line(nodes),
        given_section(axial=1e2, bending_1=0.1, torsion=0.1),
        rod=rod,
        dimension=3,
        motions=None,
        initial_velocity=[{"where": "rod", "velocity": {"file": "velocities.csv"}}],
        numerics=timed(integrator, dt, t_end, newton={"tolerance": 1e-12}),
        output={"every": dt},
    )
    return solve(folder, deck)


def nodal_masses(nodes: int) -> FloatArray:
    """Of a unit rod of unit mass."""
    mass = np.full(nodes, 1.0 / (nodes - 1))
    mass[[0, -1]] *= 0.5
    return mass


def momenta(result: Report) -> tuple[FloatArray, FloatArray]:
    """Linear and angular momentum of the nodes over the frames, shapes (frames, 3)."""
    x = np.array([frame.positions for frame in result.frames])
    p = np.array([frame.fields["velocity"] for frame in result.frames])
    p *= nodal_masses(x.shape[1])[:, None]
    return p.sum(axis=1), np.cross(x, p).sum(axis=1)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_linear_momentum(tmp_path: Path, integrator: str) -> None:
    linear, _ = momenta(free_rod(tmp_path, integrator, 2e-3, 0.1, TWISTED))
    per_step = np.abs(np.diff(linear, axis=0)).max() / np.linalg.norm(linear[0])
    assert per_step < 1e-10


@pytest.mark.parametrize("integrator", QUICK)
def test_drift_of_angular_momentum_vanishes_with_the_step(tmp_path: Path, integrator: str) -> None:
    """Without twist all angular momentum is that of the nodes; only the integrator can lose it."""
    drift, steps = [], np.array([1e-3, 5e-4, 2.5e-4])
    for dt in steps:
        _, angular = momenta(free_rod(tmp_path, integrator, float(dt), 0.03, {}))
        drift.append(np.abs(angular - angular[0]).max() / np.linalg.norm(angular[0]))
    # the midpoint rule keeps it exactly
    exact = integrator == "implicit_midpoint"
    assert (
        max(drift) < 1e-12
        if exact
        else observed_order(steps, np.array(drift)) > INTEGRATORS[integrator] - 0.2
    )


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_free_fall(tmp_path: Path, integrator: str) -> None:
    """The centre of mass falls by the integrator's own quadrature of a constant acceleration."""
    dt, t = 0.05, 2.0
    deck = rod_deck(
        line(21),
        motions=None,
        forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -9.81]}],
        numerics=timed(integrator, dt, t),
        output={"every": t, "probes": {"z": {"mean_position": "rod", "component": "z"}}},
    )
    # implicit Euler advances with the velocity at the end of the step
    late = dt if integrator == "implicit_euler" else 0.0
    assert_allclose(scalar(solve(tmp_path, deck), "z")[-1], -0.5 * 9.81 * t * (t + late), rtol=1e-9)


@pytest.mark.parametrize("integrator", QUICK)
def test_energy_account_closes_at_the_order_of_the_integrator(tmp_path: Path, integrator: str) -> None:
    """A cantilever let go from the horizontal: kinetic + elastic + gravitational stays zero."""
    worst, steps = [], np.array([8e-3, 4e-3, 2e-3])
    for dt in steps:
        deck = rod_deck(
            line(11),
            given_section(axial=1e2, bending_1=0.1),
            forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -1.0]}],
            numerics=timed(integrator, float(dt), 0.8),
            output={"every": float(dt)},
        )
        result = solve(tmp_path, deck)
        stored = scalar(result, "kinetic") + scalar(result, "elastic") + scalar(result, "gravitational")
        assert_allclose(scalar(result, "error"), stored, atol=1e-14)
        worst.append(np.abs(scalar(result, "error")).max() / scalar(result, "kinetic").max())
    assert observed_order(steps, np.array(worst)) > INTEGRATORS[integrator] - 0.2
    assert worst[-1] < (1e-2 if INTEGRATORS[integrator] == 1 else 1e-5)


def test_account_of_a_driven_damped_rod(tmp_path: Path) -> None:
    """Work of a hold, of a load and of drag, all at once: the account still closes, at second order."""
    errors, steps = [], np.array([8e-3, 4e-3, 2e-3])
    for dt in steps:
        deck = rod_deck(
            line(11),
            given_section(axial=1e2, bending_1=0.1),
            motions=[
                {
                    "type": "clamp",
                    "where": "rod.start",
                    "displacement": [0.0, 0.0, {"expression": "0.1*(1 - cos(4*t))"}],
                }
            ],
            forces=[
                {"type": "gravity", "acceleration": [0.0, 0.0, -1.0]},
                {"type": "point", "where": "rod.end", "force": [0.0, 0.0, {"expression": "0.2*sin(5*t)"}]},
                {"type": "viscous", "coefficient": 0.5},
            ],
            numerics=timed("generalized_alpha", float(dt), 0.8),
            output={"every": float(dt)},
        )
        result = solve(tmp_path, deck)
        assert scalar(result, "dissipation")[-1] > 1e-3
        assert abs(scalar(result, "external_work")[-1]) > 1e-3
        errors.append(np.abs(scalar(result, "error")).max() / scalar(result, "dissipation")[-1])
    assert observed_order(steps, np.array(errors)) > 1.8
    assert errors[-1] < 5e-3


def test_holds_that_stop_or_start_a_motion_work(tmp_path: Path) -> None:
    """The first step takes from what is clamped its speed, or gives it energy by a jump."""
    dt = 1e-3
    thrown = rod_deck(
        line(11),
        initial_velocity=[{"where": "rod.start", "velocity": [0.0, 0.0, 2.0]}],
        numerics=timed("implicit_euler", dt, dt),
        output={"every": dt},
    )
    result = solve(tmp_path, thrown)
    assert_allclose(scalar(result, "external_work")[-1], -scalar(result, "kinetic")[0], rtol=1e-12)
    lifted = thrown | {
        "initial_velocity": [],
        "motions": [{"type": "clamp", "where": "rod.start", "displacement": [0.0, 0.0, 1e-3]}],
    }
    assert scalar(solve(tmp_path, lifted), "external_work")[-1] > 0.0


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_reaction_moves_the_mass_that_is_held(tmp_path: Path, integrator: str) -> None:
    """A rod carried along bodily: its holds exert mass times acceleration, late by at most a step."""
    dt, size, rate = 5e-3, 0.1, 4.0
    lift = {"expression": f"{size}*(1 - cos({rate}*t))"}
    deck = rod_deck(
        line(3),
        motions=[{"type": "pin", "where": "rod", "displacement": [0.0, 0.0, lift]}],
        numerics=timed(integrator, dt, 1.0),
        output={"every": dt, "probes": {"up": {"reaction": "rod", "component": "z"}}},
    )
    result = solve(tmp_path, deck)
    t = np.array([frame.t for frame in result.frames])
    exact = size * rate**2 * np.cos(rate * t)
    # the first step starts the motion: its mean velocity is that of half a step
    assert_allclose(scalar(result, "up")[2:], exact[2:], atol=size * rate**3 * dt)


def test_work_of_a_static_load_is_stored(tmp_path: Path) -> None:
    """Static loading keeps everything; summed by midpoints, the work errs at second order in load steps."""
    counts, errors = np.array([8, 16, 32]), []
    for count in counts:
        deck = rod_deck(
            line(41),
            given_section(axial=1e6),
            forces=[{"type": "point", "where": "rod.end", "force": [0.0, 0.0, 5.0]}],
            numerics={"integrator": {"type": "static", "load_steps": count}},
        )
        result = solve(tmp_path, deck)
        errors.append(abs(scalar(result, "error")[-1]) / scalar(result, "elastic")[-1])
    assert observed_order(1.0 / counts, np.array(errors)) > 1.8
    assert errors[-1] < 1e-3


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("at", ["node", "edge"])
def test_reaction_carries_the_weight(tmp_path: Path, dimension: int, at: str) -> None:
    held = "rod.start" if at == "node" else {"nodes": {"of": "rod", "indices": [0, 1]}}
    deck = rod_deck(
        line(51),
        given_section(axial=1e6),
        dimension=dimension,
        motions=[{"type": "clamp", "where": "rod.start", "at": at}],
        forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -20.0]}],
        output={
            "probes": {
                "up": {"reaction": held, "component": "z"},
                "along": {"reaction": held, "component": "x"},
            }
        },
    )
    result = solve(tmp_path, deck)
    assert_allclose(scalar(result, "up")[-1], 20.0, rtol=1e-8)
    assert_allclose(scalar(result, "along")[-1], 0.0, atol=20.0 * 1e-8)


def test_long_steps_of_implicit_euler_reach_the_static_shape(tmp_path: Path) -> None:
    """Steps of 1 s, a hundred periods long: a heavy cantilever must settle, not jump about."""
    beam: dict[str, Any] = {
        "centreline": line(51, [0.1, 0.0, 0.0]),
        "section": {"type": "round", "radius": 1e-3},
        "materials": {"m": {"youngs_modulus": 2e6, "poisson_ratio": 0.5, "density": 1200.0}},
        "forces": [{"type": "gravity", "acceleration": [0.0, 0.0, -9.81]}],
    }
    static = solve(tmp_path, rod_deck(**beam))
    settled = solve(tmp_path, rod_deck(**beam, numerics=timed("implicit_euler", 1.0, 20.0)))
    assert_allclose(tip(settled), tip(static), rtol=0, atol=1e-9 * 0.1)
