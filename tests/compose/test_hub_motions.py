"""Joints of three rods and more that are moved by what holds them, or start from another shape."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import Deck, given_section, rod_deck, scalar, solve
from numpy.testing import assert_allclose

from dismech_cli import load, simulate
from dismech_cli.arrays import FloatArray

ARMS = np.array([[0.6, 0.8, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
LIFTED = np.column_stack((ARMS[:, :2], [0.3, -0.2, 0.4]))
PLANES = {2: {"dimension": 2, "plane": "xy"}, 3: {"dimension": 3}}


def star(dimension: int, arms: FloatArray | None = None, **keys: Any) -> Deck:
    if arms is None:
        arms = ARMS if dimension == 2 else LIFTED
    bodies = [
        {"type": "rod", "name": f"arm{k}", "material": "m", "section": given_section(axial=1e4, torsion=0.8)}
        | {"generate": {"shape": "line", "from": [0.0, 0.0, 0.0], "to": arm.tolist(), "nodes": 6}}
        for k, arm in enumerate(arms)
    ]
    deck = rod_deck({}, geometry=bodies, joints="auto", **PLANES[dimension])
    deck["numerics"] = {"integrator": {"type": "static", "load_steps": 4}, "newton": {"tolerance": 1e-11}}
    return deck | {"output": {"probes": {"stored": {"energy": "elastic"}}}} | keys


def turned(x: FloatArray, angle: float) -> FloatArray:
    c, s = np.cos(angle), np.sin(angle)
    return x @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


MOVING = {"dt": 0.01, "t_end": 0.05, "newton": {"tolerance": 1e-11}}
LAW = {"ramp": {"from": 0, "to": 0.8, "end": 1}}


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("where", ["arm0.start", {"nodes": {"of": "arm1", "range": [0, 1]}}])
def test_a_hub_that_is_turned_carries_its_arms(tmp_path: Path, dimension: int, where: Any) -> None:
    clamp = {"type": "clamp", "where": where, "displacement": [0.1, "0", 0]} | {
        "rotations": [{"axis": [0, 0, 1], "angle": LAW, "center": [0, 0, 0]}]
    }
    clamp["displacement"] = [{"ramp": {"from": 0, "to": 0.1, "end": 1}}, 0, 0]
    result = solve(tmp_path, star(dimension, motions=[clamp]))
    rest, moved = result.frames[0].positions, result.frames[-1].positions
    assert_allclose(moved, turned(rest, 0.8) + np.array([0.1, 0.0, 0.0]), atol=1e-9)
    assert scalar(result, "stored")[-1] < 1e-15


def test_a_hub_is_moved_by_its_rest_position(tmp_path: Path) -> None:
    clamp = {"type": "clamp", "where": "arm0.start", "displacement": [{"expression": "0.1*t + x"}, 0, 0]}
    result = solve(tmp_path, star(3, motions=[clamp]))
    moved = result.frames[-1].positions - result.frames[0].positions
    assert_allclose(moved, np.tile([0.1, 0.0, 0.0], (len(moved), 1)), atol=1e-9)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_star_displaced_as_one_is_not_stressed(tmp_path: Path, dimension: int) -> None:
    rest = (
        solve(tmp_path, star(dimension, ARMS, motions=[{"type": "clamp", "where": "arm0.end"}]))
        .frames[0]
        .positions
    )
    # a quarter turn and more: every frame goes along
    shift = turned(rest, 2.0) - rest
    initial, at = [], 0
    for k in range(3):
        own = shift[:6] if k == 0 else np.vstack((shift[:1], shift[at : at + 5]))
        at += 6 if k == 0 else 5
        np.savetxt(tmp_path / f"u{k}.csv", own, delimiter=",", header="x,y,z", comments="")
        initial.append({"where": f"arm{k}", "displacement": {"file": f"u{k}.csv"}})
    deck = star(dimension, ARMS, motions=[], numerics=MOVING | {"integrator": {"type": "implicit_midpoint"}})
    result = solve(tmp_path, deck | {"initial": {"displacements": initial}})
    assert_allclose(result.frames[0].positions, turned(rest, 2.0), atol=1e-12)
    assert scalar(result, "stored").max() < 1e-12


def test_a_star_that_hangs_at_rest_stays_so(tmp_path: Path) -> None:
    """Statics, then dynamics with its frames from there."""
    weight = [{"type": "gravity", "acceleration": [0.0, 0.0, -0.8]}]
    clamp = [{"type": "clamp", "where": "arm0.end"}]
    file = tmp_path / "scene.yaml"
    file.write_text(json.dumps(star(3, motions=clamp, forces=weight)), encoding="utf-8")
    still = simulate(load(file), out=tmp_path / "still").frames[-1]
    deck = star(3, motions=clamp, forces=weight, initial={"run": "still"})
    deck["numerics"] = MOVING | {"integrator": {"type": "tr_bdf2"}}
    result = solve(tmp_path, deck)
    assert np.abs(still.positions[-1] - LIFTED[-1]).max() > 0.05
    for frame in result.frames:
        assert_allclose(frame.positions, still.positions, rtol=0.0, atol=1e-8)
    assert scalar(result, "kinetic").max() < 1e-12
