"""Statics that end in an unstable balance say so."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from decks import Deck, line, rod_deck, solve
from numpy.testing import assert_allclose
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


def test_what_may_turn_freely_is_not_unstable(tmp_path: Path) -> None:
    """A balloon held at its poles turns about them: that stiffness is none, whatever its rounding says.

    As a membrane it stores p 4 pi R^2 w / 2 as it grows by w = p R^2 (1 - nu) / (2 E h); its triangles hold
    0.6 % less than the sphere, and at the corners of the icosahedron it grows less.
    """
    surface = {"shape": "icosphere", "radius": 0.05, "center": [0.0, 0.0, 0.0], "divisions": 8}
    deck = shell_deck(
        materials={"m": {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1000.0}},
        geometry=[{"type": "shell", "name": "ball", "material": "m", "thickness": 1e-3, "generate": surface}],
        motions=[
            {"type": "pin", "where": "ball.bottom"},
            {"type": "pin", "where": "ball.top", "components": ["x", "y"]},
        ],
        forces=[{"type": "pressure", "shell": "ball", "pressure": 50.0}],
        numerics={"integrator": {"type": "static", "load_steps": 1}},
    )
    report = solve(tmp_path, deck)
    assert report.outcome.doubts == ()
    growth = 50.0 * 0.05**2 * 0.5 / (2.0 * 1e6 * 1e-3)
    assert_allclose(report.scalars["elastic"][-1], 50.0 * 2.0 * np.pi * 0.05**2 * growth, rtol=0.015)


def test_motion_to_rest_needs_a_deviation_too(tmp_path: Path) -> None:
    deck = column(1.3, "none")
    deck["numerics"]["integrator"]["method"] = "relax"
    (doubt,) = solve(tmp_path, deck).outcome.doubts
    assert "projection" not in doubt
    assert "imperfection={" in doubt
