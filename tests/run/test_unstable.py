"""Statics that end in an unstable balance say so."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from decks import Deck, line, rod_deck, solve
from shell_decks import shell_deck


def column(load: float, projection: str) -> Deck:
    """Clamped at its foot, pressed by a multiple of Euler's load, perfectly straight."""
    euler = np.pi**2 / 4.0
    return rod_deck(
        line(41),
        forces=[{"type": "point", "where": "rod.end", "force": [-load * euler, 0.0, 0.0]}],
        numerics={
            "integrator": {"type": "static", "load_steps": 2},
            "newton": {"projection": projection},
        },
    )


@pytest.mark.parametrize("projection", ["none", "indefinite"])
@pytest.mark.parametrize("load", [0.9, 1.3, 50.0])
def test_a_straight_column_beyond_eulers_load(tmp_path: Path, load: float, projection: str) -> None:
    doubts = solve(tmp_path, column(load, projection)).outcome.doubts
    assert len(doubts) == (load > 1.0)
    assert all("the last equilibrium is unstable" in doubt for doubt in doubts)
    # what is set already is not advised
    assert all(("projection=indefinite" in doubt) == (projection == "none") for doubt in doubts)
    assert all(("--set 'imperfection={amplitude: 0.001 m}'" in d) == (projection != "none") for d in doubts)


def test_a_stable_sheet_is_not_doubted(tmp_path: Path) -> None:
    deck = shell_deck(
        motions=[{"type": "clamp", "where": "sheet.left"}],
        forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -0.1]}],
        numerics={"integrator": {"type": "static", "load_steps": 2}},
    )
    assert solve(tmp_path, deck).outcome.doubts == ()


def test_motion_to_rest_needs_a_deviation_too(tmp_path: Path) -> None:
    deck = column(1.3, "none")
    deck["numerics"]["integrator"]["method"] = "relax"
    (doubt,) = solve(tmp_path, deck).outcome.doubts
    assert "projection" not in doubt
    assert "imperfection={" in doubt
