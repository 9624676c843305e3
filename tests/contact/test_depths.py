"""The oracle that measures how deep bodies are in each other."""

from __future__ import annotations

from typing import Any

import pytest
from contact_decks import crossing

from benchmarks.oracle.depths import Depths
from dismech_cli import simulate

HEIGHT, RADIUS = 3.7e-3, 2e-3
PLATE = {"shape": "sheet", "origin": [-0.5, -0.5, -1.5e-3], "length": 1, "width": 1, "divisions": 3}


def held(**changes: Any) -> dict[str, Any]:
    """Two rods across each other, too near, for one step."""
    deck = crossing(1e-3, 1.0, stiffness=1e3)
    for end in ("from", "to"):
        deck["geometry"][1]["generate"][end][2] = HEIGHT
    del deck["initial_velocity"]
    deck["motions"] = [{"type": "pin", "where": "low"}, {"type": "pin", "where": "high"}]
    deck["numerics"] = {"integrator": {"type": "implicit_euler"}, "dt": 1e-3, "t_end": 1e-3}
    deck["output"] = {"every": 1e-3}
    return deck | changes


def test_rods_are_as_deep_as_they_are_held() -> None:
    report = simulate(held())
    share = 1.0 - HEIGHT / (2.0 * RADIUS)
    assert Depths(report, 1.0).deepest(0.0, report.frames[0].positions) == pytest.approx(share, rel=1e-12)
    assert Depths(report, 0.9).deepest(0.0, report.frames[0].positions) == pytest.approx(
        share - 0.1, rel=1e-12
    )


@pytest.mark.parametrize(
    "obstacle",
    [
        {"type": "plane", "point": [0, 0, -1.5e-3], "normal": [0, 0, 1]},
        {"type": "sphere", "center": [0, 0, -0.1], "radius": 0.0985},
        {"type": "cylinder", "point": [0, 0, -0.1], "axis": [0, 1, 0], "radius": 0.0985},
        {"type": "capsule", "start": [0, -1, -0.1], "end": [0, 1, -0.1], "radius": 0.0985},
        {"type": "box", "center": [0, 0, -0.1], "size": [0.4, 0.4, 0.197], "rounding": 0.01},
        {
            "type": "mesh",
            "generate": PLATE,
            "thickness": 0,
        },
    ],
)
def test_a_rod_in_an_obstacle(obstacle: dict[str, Any]) -> None:
    """The lower rod lies half a millimetre in each."""
    pairs = [{"between": ["low", "thing"]}]
    deck = held(obstacles=[{"name": "thing", **obstacle}])
    deck["contact"] = {"pairs": pairs, "law": {"stiffness": 1e3}}
    report = simulate(deck)
    deepest = Depths(report, 1.0).deepest(0.0, report.frames[0].positions)
    assert deepest == pytest.approx(0.5e-3 / (2.0 * RADIUS), rel=1e-9)
