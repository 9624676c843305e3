"""Friction with anchors: nothing creeps below the threshold, above it is Coulomb's; resumed bit by bit."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from contact_decks import MASS, on_floor
from numpy.testing import assert_allclose, assert_array_equal

import dismech_cli
from dismech_cli import simulate
from dismech_cli.errors import ScenarioError
from dismech_cli.run.loop import Limits
from dismech_cli.session.narrator import Silent
from dismech_cli.session.pause import Pause
from dismech_cli.session.resume import proceed


def anchored(force: float, **changes: Any) -> dict[str, Any]:
    deck = on_floor(force, **changes)
    deck["contact"]["friction"] = {"coefficient": 0.4, "stick": "anchored"}
    deck["numerics"]["integrator"] = {"type": "implicit_euler"}
    deck["output"] = {"every": 0.1, "probes": {"way": {"displacement": "rod.start", "component": "x"}}}
    return deck


@pytest.mark.parametrize("share", [0.5, 0.9, 0.99])
def test_nothing_creeps_below_the_threshold(share: float) -> None:
    """It goes by atanh(share) / 7.5 of the length, and stands; friction that follows speeds creeps all along.

    Close to the threshold the pull sets in as a step, and the ends of a soft rod go farther.
    """
    report = simulate(anchored(share * 0.4 * MASS * 9.8))
    way, length = report.scalars["way"], 1e-3 * 0.05
    assert_allclose(way[-1], length * np.arctanh(share) / 7.5, rtol=0.05 if share < 0.95 else 0.6)
    # the rest is that of Newton's method
    assert abs(way[-1] - way[-3]) < 1e-5 * length
    assert report.warnings == ()


@pytest.mark.parametrize("force", [5.0, -10.5])
def test_above_it_friction_is_that_of_coulomb(force: float) -> None:
    report = simulate(anchored(force))
    expected = (abs(force) - 0.4 * MASS * 9.8) ** 2 / (2.0 * MASS)
    assert_allclose(report.scalars["kinetic"][-1], expected, rtol=0.02)
    heat = 0.4 * MASS * 9.8 * abs(report.scalars["way"][-1])
    assert_allclose(report.scalars["friction"][-1], heat, rtol=0.02)


def test_a_moving_floor_takes_the_rod_along() -> None:
    deck = anchored(0.0)
    deck["obstacles"][0]["motion"] = {
        "displacement": [{"expression": "0.05*(1 - cos(pi*clip(t/0.6, 0, 1)))"}, 0, 0]
    }
    report = simulate(deck)
    assert_allclose(report.scalars["way"][-1], 0.1, atol=1e-3 * 0.05)


def test_a_resumed_run_is_the_straight_run(tmp_path: Path) -> None:
    deck = anchored(5.0)
    deck["forces"][1]["force_per_length"] = [{"expression": "6*cos(7*t)"}, 0, 0]
    deck["numerics"]["t_end"] = 0.5
    file = tmp_path / "deck.yaml"
    file.write_text(json.dumps(deck))
    straight = simulate(file, out=tmp_path / "straight")
    simulate(file, limits=Limits(until=0.2), out=tmp_path / "run")
    assert proceed(tmp_path / "run", Pause(None, None, 60.0), Silent(), ()).record.ending.code == 0
    with dismech_cli.read(tmp_path / "run") as run:
        assert_array_equal(run.positions[-1], straight.frames[-1].positions)
        assert_array_equal(run.state("v")[-1], straight.state.v)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"law": {"type": "barrier"}}, "stick: anchors know soft contact alone"),
        ({"friction": {"coefficient": 0.4, "slip_length": 1e-4}}, "with stick: anchored only"),
    ],
)
def test_refused(change: dict[str, Any], message: str) -> None:
    deck = anchored(1.0)
    deck["contact"] |= change
    with pytest.raises(ScenarioError, match=message):
        dismech_cli.load_mapping(deck)
