"""Anchors between bodies: on a body that slopes nothing creeps below the threshold; resumed bit by bit."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import dismech_cli
from dismech_cli import load_mapping, simulate
from dismech_cli.contact.law.anchors import Anchors, Moved, cut, turned
from dismech_cli.errors import ScenarioError
from dismech_cli.run.loop import Limits
from dismech_cli.session.narrator import Silent
from dismech_cli.session.pause import Pause
from dismech_cli.session.resume import proceed

MU, G, RADIUS, HALF = 0.4, 9.8, 5e-3, 1e-3
LENGTH = 1e-5


def pulled(share: float, on: str = "sheet", **changes: Any) -> dict[str, Any]:
    """A rod that lies on a held sheet or on two held rails, then a pull comes to a share of the threshold."""

    def rod(name: str, start: list[float], end: list[float], nodes: int) -> dict[str, Any]:
        line = {"shape": "line", "from": start, "to": end, "nodes": nodes}
        return {"type": "rod", "name": name, "material": "stiff", "radius": RADIUS, "generate": line}

    if on == "sheet":
        shape = {"shape": "sheet", "origin": [-0.1, -0.1, 0], "length": 0.4, "width": 0.2, "divisions": 6}
        thick = 2.0 * HALF
        held = [
            {"type": "shell", "name": "sheet", "material": "stiff", "thickness": thick, "generate": shape}
        ]
        z = RADIUS + HALF
    else:
        held = [
            rod("left", [-0.1, -0.05, 0], [0.3, -0.05, 0], 14),
            rod("right", [-0.1, 0.05, 0], [0.3, 0.05, 0], 14),
        ]
        z = 2.0 * RADIUS
    slope = {"expression": f"{share * MU * G!r}*clip((t - 0.3)/0.2, 0, 1)"}
    names = [one["name"] for one in held]
    return {
        "schema_version": 1,
        "name": "pulled",
        "materials": {"stiff": {"youngs_modulus": 1e9, "poisson_ratio": 0.3, "density": 1200}},
        # askew and with a node above a rail: nothing of the meshes meets by chance
        "geometry": [*held, rod("load", [0.011, -0.08, z], [0.013, 0.08, z], 17)],
        "contact": {
            "pairs": [{"between": [name, "load"]} for name in names],
            "friction": {"coefficient": MU, "stick": "anchored", "slip_length": LENGTH},
        },
        "motions": [{"type": "pin", "where": name} for name in names],
        "forces": [{"type": "gravity", "acceleration": [slope, 0, -G]}],
        "numerics": {"integrator": {"type": "implicit_euler"}, "dt": 5e-3, "t_end": 1.0},
        "output": {"every": 0.05, "probes": {"way": {"displacement": "load", "component": "x"}}},
    } | changes


@pytest.mark.parametrize(
    ("on", "share"),
    [pytest.param("sheet", 0.5, marks=pytest.mark.slow), ("sheet", 0.99), ("rails", 0.9)],
)
def test_nothing_creeps_below_the_threshold(on: str, share: float) -> None:
    """On a sheet it goes by atanh(share) / 7.5 of the length; on rails it bends a little, and stands too."""
    report = simulate(load_mapping(pulled(share, on)))
    way = report.scalars["way"] - report.scalars["way"][6]
    if on == "sheet":
        assert_allclose(way[-1], LENGTH * np.arctanh(share) / 7.5, rtol=1e-3)
    assert 0.0 < way[-1] < LENGTH
    # the rest is that of Newton's method
    assert abs(way[-1] - way[-5]) < 1e-6 * LENGTH
    assert report.warnings == ()


@pytest.mark.parametrize("on", ["sheet", "rails"])
def test_above_it_friction_is_that_of_coulomb(on: str) -> None:
    """From 1.5 times the threshold on, through all edges on the way."""
    report = simulate(load_mapping(pulled(1.5, on)))
    # what is too much comes in the last third of the ramp
    speed = MU * G * 0.5 * (0.5 * 0.2 / 3.0 + 0.5)
    mass = 1200 * np.pi * RADIUS**2 * np.hypot(0.16, 0.002)
    assert_allclose(report.scalars["kinetic"][-1], 0.5 * mass * speed**2, rtol=0.02)


def test_a_couple_is_held_too() -> None:
    """Pulled to opposite sides at its ends, a rod of one edge turns on a sheet by next to nothing."""
    deck = pulled(0.0)
    deck["geometry"][1]["generate"]["nodes"] = 2
    push = {"expression": "0.008*clip((t - 0.3)/0.2, 0, 1)"}
    back = {"expression": "-0.008*clip((t - 0.3)/0.2, 0, 1)"}
    deck["forces"] += [
        {"type": "point", "where": "load.start", "force": [push, 0, 0]},
        {"type": "point", "where": "load.end", "force": [back, 0, 0]},
    ]
    deck["output"]["probes"] = {"way": {"displacement": "load.start", "component": "x"}}
    way = simulate(load_mapping(deck)).scalars["way"]
    way = way - way[6]
    assert 0.0 < way[-1] < LENGTH
    assert abs(way[-1] - way[-5]) < 1e-6 * LENGTH


def test_rails_that_move_take_the_rod_along() -> None:
    deck = pulled(0.0, "rails")
    for motion in deck["motions"]:
        law = {"expression": "0.02*(1 - cos(pi*clip((t - 0.3)/0.5, 0, 1)))"}
        motion["displacement"] = [law, 0, 0]
    report = simulate(load_mapping(deck))
    assert_allclose(report.scalars["way"][-1], 0.04, atol=3.0 * LENGTH)


@pytest.mark.parametrize("on", [pytest.param("sheet", marks=pytest.mark.slow), "rails"])
def test_a_resumed_run_is_the_straight_run(tmp_path: Path, on: str) -> None:
    deck = pulled(1.2, on)
    deck["numerics"]["t_end"] = 0.6
    # a name that anchors between bodies might have taken in the state
    deck["obstacles"] = [{"name": "rods", "type": "plane", "point": [0, 0, -1], "normal": [0, 0, 1]}]
    deck["contact"]["pairs"].append({"between": ["load", "rods"]})
    file = tmp_path / "deck.yaml"
    file.write_text(json.dumps(deck))
    straight = simulate(file, out=tmp_path / "straight")
    simulate(file, limits=Limits(until=0.4), out=tmp_path / "run")
    assert proceed(tmp_path / "run", Pause(None, None, 60.0), Silent(), ()).record.ending.code == 0
    with dismech_cli.read(tmp_path / "run") as run:
        assert_array_equal(run.positions[-1], straight.frames[-1].positions)
        assert_array_equal(run.state("v")[-1], straight.state.v)


def test_what_turns_round_cuts_no_step() -> None:
    """A rod that falls on a sheet and slides to and fro: full steps of Newton's method would swing."""
    scene = Path(__file__).parents[2] / "scenarios" / "rod_on_sheet.yaml"
    report = simulate(scene, overrides=["contact.friction.stick=anchored"])
    counters = report.outcome.counters
    assert report.exit == 0
    assert counters["cuts"] == 0
    assert counters["iterations"] <= 3 * counters["steps"]


def test_a_barrier_is_refused() -> None:
    deck = pulled(0.5)
    deck["contact"]["law"] = {"type": "barrier"}
    with pytest.raises(ScenarioError, match="stick: anchors know soft contact alone"):
        load_mapping(deck)


def test_ways_are_kept_where_nothing_moves() -> None:
    """And linear along a line: what turns is held, what points along the normal is not."""
    rng = np.random.default_rng(3)
    s = rng.uniform(0.0, 1.0, 40)
    group = np.repeat([0, 1], 20)
    normal = np.tile([0.0, 0.0, 1.0], (40, 1))
    before = np.repeat(rng.normal(size=(2, 2, 3)) * [1.0, 1.0, 0.0], 20, axis=0)
    still = Moved(group, s, rng.uniform(0.5, 1.0, 40), normal, np.zeros((40, 3)))
    assert_allclose(still.ends(before), before[::20], rtol=1e-13)
    s[:2], s[20:22] = [0.0, 1.0], [0.0, 1.0]
    step = rng.normal(size=(2, 3))
    way = (1.0 - s[:, None]) * step[0] + s[:, None] * step[1]
    # points spread as a whole line has them
    wide = Moved(group, s, np.where((s == 0.0) | (s == 1.0), 1e3, 1e-9), normal, way)
    expected = before[::20] + step * [1.0, 1.0, 0.0]
    assert_allclose(wide.ends(before), expected, rtol=1e-8)


def test_ways_turn_with_lines_and_are_cut() -> None:
    angle = 0.3
    before, after = np.array([[1.0, 0.0, 0.0]]), np.array([[np.cos(angle), np.sin(angle), 0.0]])
    ways = np.array([[[0.0, 2.0, 0.0], [1.0, 0.0, 5.0]]])
    expected = [[[-2.0 * np.sin(angle), 2.0 * np.cos(angle), 0.0], [np.cos(angle), np.sin(angle), 5.0]]]
    assert_allclose(turned(ways, before, after), expected, atol=1e-15)
    assert_allclose(np.linalg.norm(cut(ways, 1.0), axis=2), [[1.0, 1.0]])
    assert_array_equal(cut(ways, 10.0), ways)


def test_anchors_are_found_by_keys() -> None:
    anchors = Anchors(np.array([2, 7]), np.arange(12.0).reshape(2, 2, 3))
    ways, known = anchors.of(np.array([7, 1, 2, 9]))
    assert_array_equal(known, [0, 2])
    assert_array_equal(ways, [anchors.ways[1], np.zeros((2, 3)), anchors.ways[0], np.zeros((2, 3))])
    again = Anchors.unpacked(anchors.packed())
    assert_array_equal(again.keys, anchors.keys)
    assert_array_equal(again.ways, anchors.ways)
