"""Runs with compiled contact: those of NumPy to rounding, resumed bit by bit, with the time they took."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from contact_decks import crossing, on_floor
from numpy.testing import assert_allclose, assert_array_equal

import dismech_cli
from dismech_cli.run.loop import Limits
from dismech_cli.session.narrator import Silent
from dismech_cli.session.pause import Pause
from dismech_cli.session.resume import proceed

pytest.importorskip("numba")


def crossed_with_friction(tangent: str) -> dict[str, Any]:
    """Two rods that hit and rub."""
    deck = crossing(1e-3, 1.0)
    deck["contact"]["friction"] = {"coefficient": 0.3, "slip_speed": 1e-2, "tangent": tangent}
    deck["initial_velocity"][0]["velocity"] = [0.3, 0.2, -1.0]
    return deck


def sheets() -> dict[str, Any]:
    """A sheet that is thrown on another and rubs on it."""
    deck = crossed_with_friction("symmetric")
    sheet = {"type": "shell", "material": "m", "thickness": 2e-3}
    deck["geometry"] = [
        sheet
        | {"name": "low"}
        | {"generate": {"shape": "sheet", "origin": [0, 0, 0], "length": 0.1, "width": 0.1, "divisions": 4}},
        sheet
        | {"name": "high"}
        | {
            "generate": {
                "shape": "sheet",
                "origin": [0.013, 0.017, 0.0023],
                "length": 0.07,
                "width": 0.07,
                "divisions": 3,
            }
        },
    ]
    deck["motions"] = [{"type": "clamp", "where": "low"}]
    deck["initial_velocity"][0]["velocity"] = [0.1, 0.05, -0.05]
    deck["forces"] = [{"type": "gravity", "acceleration": [0, 0, -20.0]}]
    deck["numerics"] = {"dt": 2e-3, "t_end": 0.04, "integrator": {"type": "implicit_euler"}}
    deck["output"] = {"every": 2e-3}
    return deck


DECKS = {
    "full": lambda: crossed_with_friction("full"),
    "symmetric": lambda: crossed_with_friction("symmetric"),
    "floor": lambda: on_floor(8.0),
    "sheets": sheets,
}


@pytest.mark.parametrize("name", DECKS)
def test_the_same_motion(name: str) -> None:
    """Positions to 1e-10 of the size of the scene."""
    plain, fast = (dismech_cli.simulate(DECKS[name](), kernels=one) for one in ("numpy", "numba"))
    assert fast.outcome.counters["iterations"] == plain.outcome.counters["iterations"]
    q, expected = fast.outcome.state.q, plain.outcome.state.q
    assert_allclose(q, expected, rtol=0, atol=1e-10 * np.ptp(expected))
    assert np.abs(fast.scalars["contact"]).max() > 0.0


def test_a_resumed_run_is_the_straight_one(tmp_path: Path) -> None:
    """Though buffers and pairs were others before."""
    file = tmp_path / "deck.yaml"
    file.write_text(json.dumps(sheets()))

    def table(folder: Path) -> np.ndarray:
        rows = [line.split(",") for line in (folder / "scalars.csv").read_text().splitlines()]
        keep = [i for i, name in enumerate(rows[0]) if not name.startswith("wall")]
        return np.array([[float(row[i]) for i in keep] for row in rows[1:]])

    dismech_cli.simulate(file, out=tmp_path / "straight", kernels="numba")
    dismech_cli.simulate(file, limits=Limits(until=0.012), out=tmp_path / "run", kernels="numba")
    for until in ("0.022 s", None):
        assert proceed(tmp_path / "run", Pause(until, None, 60.0), Silent(), ()).record.ending.code == 0
    assert_array_equal(table(tmp_path / "run"), table(tmp_path / "straight"))


def test_contact_says_how_long_it_took() -> None:
    report = dismech_cli.simulate(crossed_with_friction("full"), limits=Limits(until=0.01))
    assert 0.0 < report.seconds["contact"] < report.seconds["total"]
    # what contact takes is not counted twice
    assert min(report.seconds.values()) >= 0.0
    assert "contact" not in dismech_cli.simulate("scenarios/cantilever_small.yaml").seconds
