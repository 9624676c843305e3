"""Runs with barriers: nothing comes nearer than the stop, by sampling of what frames show."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from contact_decks import MASS, crossing, on_floor
from numpy.testing import assert_allclose, assert_array_equal

import dismech_cli
from dismech_cli import Report, simulate
from dismech_cli.arrays import FloatArray, IntArray
from dismech_cli.errors import ScenarioError
from dismech_cli.run.loop import Limits
from dismech_cli.session.narrator import Silent
from dismech_cli.session.pause import Pause
from dismech_cli.session.resume import proceed

BARRIER = {"type": "barrier"}


def least(x: FloatArray, one: IntArray, other: IntArray) -> float:
    """Least distance of many points of cells: edges (K, 2) or triangles (K, 3)."""
    grid = np.linspace(0.0, 1.0, 25)
    clouds = []
    for cells in (one, other):
        corners = x[cells]
        if cells.shape[1] == 2:
            w = np.column_stack((1.0 - grid, grid))
        else:
            u, v = np.meshgrid(grid, grid)
            kept = u + v <= 1.0 + 1e-9
            u, v = u[kept], v[kept]
            w = np.column_stack((1.0 - u - v, u, v))
        clouds.append(np.einsum("wc,kcd->kwd", w, corners).reshape(-1, 3))
    from scipy.spatial import KDTree

    return float(KDTree(clouds[0]).query(clouds[1])[0].min())


def rods_apart(report: Report) -> float:
    edges = report.composition.geometry.edges
    low, high = edges[:5], edges[5:]
    return min(least(frame.positions, low, high) for frame in report.frames)


@pytest.mark.slow
@pytest.mark.parametrize("dt", [1e-1, 1e-2, 1e-3])
def test_nothing_comes_nearer_than_the_stop(dt: float) -> None:
    """Rods thrown at each other by fifty radii a step; samples lie above the distance itself."""
    deck = crossing(dt, 0.1 / dt)
    deck["contact"] = {"law": BARRIER}
    report = simulate(deck)
    assert report.exit == 0, report.message
    assert rods_apart(report) > 0.004
    assert (report.scalars["high"] > report.scalars["low"]).all()
    assert report.scalars["error"].max() < 1e-3 * report.scalars["kinetic"][0]
    assert not any("barrier" in line for line in report.warnings)


def test_the_stop_is_where_it_is_asked_for() -> None:
    deck = crossing(1e-3, 1.0)
    deck["contact"] = {"law": {"type": "barrier", "stop": 0.5, "gap": 0.2}}
    report = simulate(deck)
    assert 0.002 < rods_apart(report) < 0.0028


def test_friction_and_load_on_a_barrier() -> None:
    deck = on_floor(8.0)
    deck["contact"]["law"] = BARRIER
    deck["geometry"][0]["generate"] |= {"from": [0.0, 0.0, 0.0252], "to": [1.0, 0.0, 0.0252]}
    deck["output"]["probes"] = {
        "load": {"contact": ["rod", "floor"], "measure": "load"},
        "low": {"position": "rod", "component": "z"},
    }
    report = simulate(deck)
    assert_allclose(report.scalars["load"][-1], MASS * 9.8, rtol=1e-3)
    assert_allclose(report.scalars["kinetic"][-1], (8.0 - 0.4 * MASS * 9.8) ** 2 / (2.0 * MASS), rtol=0.02)
    assert (report.scalars["low"] > 0.025).all()


def sheets(law: dict[str, Any], speed: float = 1.0) -> dict[str, Any]:
    """A small sheet that falls on a larger one that is held."""

    def sheet(name: str, size: float, z: float, divisions: int) -> dict[str, Any]:
        plan = {"shape": "sheet", "origin": [-0.5 * size, -0.45 * size, z], "length": size, "width": size}
        body = {"type": "shell", "name": name, "material": "m", "thickness": 1e-3, "bending": "hinge"}
        return body | {"generate": plan | {"divisions": divisions}}

    return {
        "schema_version": 1,
        "name": "sheets",
        "materials": {"m": {"youngs_modulus": 1e7, "poisson_ratio": 0.3, "density": 1200.0}},
        "geometry": [sheet("lower", 0.1, 0.0, 3), sheet("upper", 0.06, 4e-3, 2)],
        "motions": [{"type": "clamp", "where": "lower"}],
        "initial_velocity": [{"where": "upper", "velocity": [0.0, 0.0, -speed]}],
        "contact": {"law": law, "pairs": [{"between": ["lower", "upper"]}]},
        "forces": [{"type": "gravity", "acceleration": [0, 0, -9.81]}],
        "numerics": {"integrator": {"type": "implicit_euler"}, "dt": 1e-3, "t_end": 0.06},
        "output": {
            "every": 2e-3,
            "probes": {"load": {"contact": ["lower", "upper"], "measure": "load"}},
        },
    }


def sheets_apart(report: Report) -> float:
    geometry = report.composition.geometry
    lower, upper = (geometry.triangles[geometry.triangles_of(name)] for name in ("lower", "upper"))
    return min(least(frame.positions, lower, upper) for frame in report.frames)


@pytest.mark.slow
def test_sheets_keep_their_distance() -> None:
    report = simulate(sheets(BARRIER))
    assert report.exit == 0, report.message
    assert sheets_apart(report) > 1e-3
    assert_allclose(report.scalars["load"][-1], 0.06**2 * 1e-3 * 1200.0 * 9.81, rtol=0.02)


def test_the_core_holds_what_the_stiffness_does_not() -> None:
    """Rods so soft that they pass into each other: with the core they stay at half the distance."""
    deck = crossing(1e-3, 1.0, stiffness=1e4)
    without = rods_apart(simulate(deck))
    deck["contact"]["law"]["core"] = "on"
    report = simulate(deck)
    assert report.exit == 0, report.message
    assert without < 0.0005
    assert rods_apart(report) > 0.002


def test_a_core_far_too_soft_fails_and_says_so() -> None:
    deck = crossing(1e-3, 1.0, stiffness=1e-3)
    deck["contact"]["law"]["core"] = "on"
    deck["numerics"]["t_end"] = 0.06
    report = simulate(deck)
    if report.exit == 0:
        assert rods_apart(report) > 0.002
    else:
        assert report.exit == 3
        assert report.message


def test_a_core_begins_where_bodies_start() -> None:
    """A sheet that starts at a third of the thickness from another is warned of, and pushed out."""
    deck = sheets({"tolerance": 0.05}, speed=0.0)
    deck["geometry"][1]["generate"]["origin"][2] = 0.3e-3
    report = simulate(deck, limits=Limits(until=0.01))
    assert report.exit == 0, report.message
    assert any("starts within" in line for line in report.warnings)
    assert sheets_apart(report) > 0.2e-3


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["plane", "sphere", "box", "mesh"])
def test_obstacles_keep_their_distance(shape: str) -> None:
    """A rod thrown at an obstacle by many radii a step."""
    made = {
        "plane": {"type": "plane", "point": [0, 0, -0.1], "normal": [0, 0, 1]},
        "sphere": {"type": "sphere", "center": [0, 0, -0.2], "radius": 0.1},
        "box": {"type": "box", "center": [0, 0, -0.2], "size": [0.2, 0.2, 0.2]},
        "mesh": {
            "type": "mesh",
            "generate": {
                "shape": "sheet",
                "origin": [-0.2, -0.2, -0.1],
                "length": 0.4,
                "width": 0.4,
                "divisions": 2,
            },
        },
    }
    deck = crossing(1e-2, 0.05 / 1e-2)
    deck["geometry"] = [deck["geometry"][1] | {"name": "rod"}]
    deck["geometry"][0]["generate"] |= {"from": [0.0, -0.15, 0.0], "to": [0.02, 0.15, 0.0]}
    deck["obstacles"] = [{"name": "thing", **made[shape]}]
    deck["contact"] = {"law": BARRIER}
    deck["initial_velocity"][0] |= {"where": "rod"}
    deck["output"]["probes"] = {}
    deck["numerics"]["t_end"] = 0.05
    report = simulate(deck)
    assert report.exit == 0, report.message
    assert report.outcome.penetration is not None
    edges = report.composition.geometry.edges
    s = np.linspace(0.0, 1.0, 101)[:, None, None]
    for frame in report.frames:
        a, b = frame.positions[edges].transpose(1, 0, 2)
        p = ((1.0 - s) * a + s * b).reshape(-1, 3)
        if shape == "sphere":
            gap = np.linalg.norm(p - [0, 0, -0.2], axis=1) - 0.1
        elif shape == "box":
            half = 0.1 - 0.01
            gap = np.linalg.norm((p - [0, 0, -0.2]) - np.clip(p - [0, 0, -0.2], -half, half), axis=1) - 0.01
        else:
            gap = p[:, 2] + 0.1
        assert gap.min() > 0.002


def test_a_start_in_penetration_is_refused() -> None:
    deck = crossing(1e-3, 1.0)
    deck["contact"] = {"law": BARRIER}
    deck["geometry"][1]["generate"] |= {"from": [0.0, -0.25, 0.0039], "to": [0.0, 0.25, 0.0039]}
    with pytest.raises(ScenarioError, match=r"'low' starts 0.0039 m from 'high'.*more than 0.004 m"):
        simulate(deck, limits=Limits(until=0.0))
    deck["geometry"][1]["generate"] |= {"from": [0.0, -0.25, 0.0], "to": [0.0, 0.25, 0.0]}
    with pytest.raises(ScenarioError, match=r"'low' starts 0 m from 'high'.*more than 0.004 m"):
        simulate(deck, limits=Limits(until=0.0))
    deck = on_floor()
    deck["contact"]["law"] = BARRIER
    with pytest.raises(ScenarioError, match=r"'rod' starts 0.02451 m from 'floor'"):
        simulate(deck, limits=Limits(until=0.0))


@pytest.mark.parametrize(
    "integrator",
    [{"type": "implicit_midpoint"}, {"type": "generalized_alpha", "spectral_radius": 0.5}],
)
def test_what_balances_within_the_step_is_refused(integrator: dict[str, Any]) -> None:
    deck = crossing(1e-3, 1.0)
    deck["contact"] = {"law": BARRIER}
    deck["numerics"]["integrator"] = integrator
    with pytest.raises(ScenarioError, match="integrator: balances within the step"):
        dismech_cli.load_mapping(deck)


def test_the_default_integrator_of_a_barrier() -> None:
    deck = crossing(1e-3, 1.0)
    deck["contact"] = {"law": BARRIER}
    assert dismech_cli.load_mapping(deck).scenario.numerics.integrator.type == "implicit_euler"


@pytest.mark.slow
def test_a_resumed_run_is_the_straight_run(tmp_path: Path) -> None:
    deck = crossing(1e-3, 1.0)
    deck["contact"] = {"law": BARRIER, "friction": {"coefficient": 0.3, "slip_speed": 1e-2}}
    deck["initial_velocity"][0]["velocity"] = [0.3, 0.2, -1.0]
    deck["numerics"]["t_end"] = 0.052
    file = tmp_path / "deck.yaml"
    file.write_text(json.dumps(deck))
    straight = simulate(file, out=tmp_path / "straight")
    simulate(file, limits=Limits(until=0.046), out=tmp_path / "run")
    for until in ("0.048 s", None):
        assert proceed(tmp_path / "run", Pause(until, None, 60.0), Silent(), ()).record.ending.code == 0
    with dismech_cli.read(tmp_path / "run") as run:
        assert_array_equal(run.positions[-1], straight.frames[-1].positions)
