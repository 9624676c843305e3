"""Imperfections have the shape and the size that they are asked for."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import Deck, attempt, given_section, line, rod_deck
from shell_decks import shell_deck

from dismech_cli.arrays import FloatArray
from dismech_cli.errors import ScenarioError

PINS: list[Deck] = [
    {"type": "pin", "where": "rod.start"},
    {"type": "pin", "where": "rod.end", "components": ["z"]},
]


def start(folder: Path, imperfection: Deck, **keys: Any) -> FloatArray:
    """Rest positions of a pinned line of unit length, 41 nodes."""
    deck = rod_deck(line(41), given_section(axial=1e6), motions=PINS, imperfection=imperfection, **keys)
    return attempt(folder, deck).frames[0].positions


@pytest.mark.parametrize("mode", [1, 2, 5])
def test_a_mode_of_a_pinned_line_is_a_sine(tmp_path: Path, mode: int) -> None:
    x = start(tmp_path, {"amplitude": 0.01, "mode": mode})
    sine = np.sin(mode * np.pi * np.linspace(0.0, 1.0, 41))
    # ends weigh half and do not move: the discrete modes are sines exactly
    sine *= 0.01 / np.abs(sine).max()
    assert np.abs(np.abs(x[:, 2]) - np.abs(sine)).max() < 1e-7
    assert np.abs(x[:, 2]).max() == pytest.approx(0.01, rel=1e-7)


def test_random_is_smooth_held_and_repeats(tmp_path: Path) -> None:
    one, again, other = (
        start(tmp_path, {"amplitude": 0.01, "mode": "random", "seed": seed})[:, 2] for seed in (1, 1, 2)
    )
    assert (one == again).all()
    assert np.abs(one - other).max() > 1e-3
    assert one[0] == one[-1] == 0.0
    assert np.abs(one).max() == pytest.approx(0.01, rel=1e-7)
    # ten half waves at most
    assert np.abs(np.diff(one, 2)).max() < (10 * np.pi / 40) ** 2 * 0.01


def test_it_is_free_of_stress(tmp_path: Path) -> None:
    deck = rod_deck(line(21), motions=PINS, imperfection={"amplitude": 0.05})
    frames = attempt(tmp_path, deck).frames
    assert all(frame.scalars["elastic"] < 1e-20 for frame in frames)


def test_or_a_push_at_the_start(tmp_path: Path) -> None:
    """Let go from a sine of amplitude a, a pinned line has the energy (pi^4 / 4) EI a^2."""
    deck = rod_deck(
        line(81),
        given_section(axial=1e2),
        motions=PINS,
        imperfection={"amplitude": 1e-3, "stress_free": False},
        numerics={"dt": 1e-3, "t_end": 2e-3},
    )
    elastic = attempt(tmp_path, deck).frames[0].scalars["elastic"]
    assert elastic == pytest.approx(0.25 * np.pi**4 * 1e-6, rel=1e-3)


def test_the_first_of_two_planes_is_chosen(tmp_path: Path) -> None:
    pins = [
        {"type": "pin", "where": "rod.start"},
        {"type": "pin", "where": "rod.end", "components": ["y", "z"]},
    ]
    deck = rod_deck(line(21), motions=pins, dimension=3, imperfection={"amplitude": 0.01})
    deck["numerics"] = {"dt": 1e-3, "t_end": 1e-3}
    x = attempt(tmp_path, deck).frames[0].positions
    assert np.abs(x[:, 1]).max() == pytest.approx(0.01, rel=1e-6)
    assert np.abs(x[:, 2]).max() < 1e-7


def test_a_free_ring_deviates_without_moving(tmp_path: Path) -> None:
    """Rigid motions are no modes: the softest of a ring has two waves."""
    circle = {
        "shape": "arc", "center": [0, 0, 0], "radius": 1.0, "normal": [0, -1, 0], "start": [1, 0, 0],
        "angle": "360 deg", "nodes": 48, "closed": True,
    }  # fmt: skip
    deck = rod_deck(circle, motions=[], imperfection={"amplitude": 0.01})
    deck["numerics"] = {"dt": 1e-3, "t_end": 1e-3}
    x = attempt(tmp_path, deck).frames[0].positions
    radii = np.hypot(x[:, 0], x[:, 2]) - 1.0
    waves = np.abs(np.fft.rfft(radii))
    assert np.argmax(waves) == 2
    assert np.abs(x.mean(axis=0)).max() < 1e-6


def test_a_sheet(tmp_path: Path) -> None:
    deck = shell_deck(
        motions=[{"type": "clamp", "where": "sheet.left"}],
        imperfection={"amplitude": 1e-3},
        numerics={"integrator": {"type": "static", "load_steps": 1}},
    )
    z = attempt(tmp_path, deck).frames[0].positions[:, 2]
    assert np.abs(z).max() == pytest.approx(1e-3, rel=1e-4)


@pytest.mark.parametrize(
    ("imperfection", "message"),
    [
        ({"amplitude": 0.0}, "greater than 0"),
        ({"amplitude": 0.01, "seed": 3}, "mode: random only"),
        ({"amplitude": 0.01, "stress_free": False}, "statics forget"),
        ({"amplitude": 0.01, "mode": 0}, "mode"),
    ],
)
def test_what_is_refused(tmp_path: Path, imperfection: Deck, message: str) -> None:
    with pytest.raises(ScenarioError, match=message):
        start(tmp_path, imperfection)
