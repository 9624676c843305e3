"""What damping takes in long steps: by the stages of the integrator, and alarms that are none in vain."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from decks import Deck, line, rod_deck, scalar, solve
from numpy.testing import assert_allclose

SPEED = 20.0  # [rad/s]


def fan(dt: float) -> Deck:
    """A rod that is turned as a whole in a thick fluid."""
    turned = {"rotations": [{"axis": [0, 0, 1], "center": [0, 0, 0], "angle": {"expression": f"{SPEED}*t"}}]}
    return rod_deck(
        line(5),
        dimension=3,
        motions=[{"type": "clamp", "where": "rod", "at": "edge"} | turned],
        forces=[{"type": "viscous", "coefficient": 1.0}],
        numerics={"integrator": {"type": "tr_bdf2"}, "dt": dt, "t_end": 0.2},
    )


def test_drag_is_booked_by_the_stages(tmp_path: Path) -> None:
    """Each goes straight: of the square of the speed a chord has sin(x)^2/x^2, x half its angle."""
    step = 0.05
    coarse, fine = (scalar(solve(tmp_path, fan(dt)), "dissipation")[-1] for dt in (step, step / 64))
    parts = np.array([2.0 - np.sqrt(2.0), np.sqrt(2.0) - 1.0])
    chords = (parts * np.sinc(0.5 * SPEED * step * parts / np.pi) ** 2).sum()
    # the fine one errs by (angle of a stage)^2 / 12
    assert_allclose(coarse / fine, chords, rtol=(SPEED * step / 64) ** 2 / 12)


@pytest.mark.parametrize(("dt", "doubted"), [(0.1, True), (0.005, False)])
def test_damping_along_chords_makes_energy_and_is_told(tmp_path: Path, dt: float, doubted: bool) -> None:
    """Of a rod that swings down, steps of a quarter turn make more elastic energy than gravity has given."""
    material = {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1e3, "relaxation_time": 0.5}
    deck = rod_deck(
        line(11),
        {"type": "round", "radius": 0.02},
        dimension=3,
        materials={"m": material},
        forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -9.81]}],
        numerics={"integrator": {"type": "implicit_euler"}, "dt": dt, "t_end": 2.0},
        output={"every": 0.1},
    )
    result = solve(tmp_path, deck)
    weight = 1e3 * np.pi * 0.02**2 * 9.81
    assert (scalar(result, "elastic").max() > 0.5 * weight) == doubted
    assert any("came from nowhere" in doubt for doubt in result.outcome.doubts) == doubted
