"""A robot that stays perfectly straight in time, where a real one buckles, is told of once."""

from __future__ import annotations

from pathlib import Path

import pytest
from decks import Deck, attempt, given_section, line, rod_deck


def pressed(shortening: float, **keys: object) -> Deck:
    """A line between clamps that come nearer; clamped, it buckles at a strain of 4 pi^2 EI / EA = 0.0039."""
    return rod_deck(
        line(31),
        given_section(axial=1e4, bending_1=1.0, mass_per_length=1.0),
        motions=[
            {"type": "clamp", "where": "rod.start", "at": "edge"},
            {
                "type": "clamp",
                "where": "rod.end",
                "at": "edge",
                "displacement": [{"ramp": {"from": 0, "to": -shortening, "end": 0.5}}, 0, 0],
            },
        ],
        numerics={"dt": 0.01, "t_end": 2.0},
        **keys,
    )


def test_a_straight_column(tmp_path: Path) -> None:
    (doubt,) = attempt(tmp_path, pressed(0.02)).outcome.doubts
    assert "in an unstable balance" in doubt
    assert "imperfection={amplitude: 0.001 m}" in doubt


@pytest.mark.parametrize(
    "deck",
    [
        pressed(0.002),
        pressed(0.02, imperfection={"amplitude": 1e-3}),
        pressed(0.02, forces=[{"type": "gravity", "acceleration": [0, 0, -1]}]),
    ],
    ids=["too little", "crooked", "hanging"],
)
def test_no_false_alarm(tmp_path: Path, deck: Deck) -> None:
    assert not any("unstable balance" in doubt for doubt in attempt(tmp_path, deck).outcome.doubts)


@pytest.mark.parametrize(("push", "stays"), [(0.0, True), (1e-3, False)])
def test_looks_that_are_put_by_find_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, push: float, stays: bool
) -> None:
    """It stands straight from when it is pressed enough until a push disturbs it, or to the end."""
    told = []
    for put_by in (0, 4):
        monkeypatch.setattr("dismech_cli.run.symmetry._PUT_BY", put_by)
        told.append(attempt(tmp_path, disturbed(push)).outcome.doubts)
    assert told[0] == told[1]
    assert any("unstable balance" in doubt for doubt in told[0]) == stays


def disturbed(push: float) -> Deck:
    late = {"ramp": {"from": 0.0, "to": push, "start": 1.0, "end": 1.1}}
    return pressed(0.02, forces=[{"type": "point", "where": "rod", "force": [0.0, 0.0, late]}])


def test_a_free_rod_may_turn_as_it_likes(tmp_path: Path) -> None:
    """Rigid motions cost no energy: rounding makes some of them negative."""
    deck = rod_deck(line(11), motions=[], dimension=3, numerics={"dt": 0.01, "t_end": 1.0})
    deck["forces"] = [{"type": "gravity", "acceleration": [0, 0, -9.81]}]
    assert attempt(tmp_path, deck).outcome.doubts == ()


def test_modes_too_slow_to_matter_are_not_looked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A long rod may have thousands of them, which take longer to find than the run."""
    asked = []
    monkeypatch.setattr("dismech_cli.run.symmetry.softest_modes", lambda *given: asked.append(given))
    short = pressed(0.02) | {"numerics": {"dt": 1e-4, "t_end": 2e-3}}
    short["motions"][1]["displacement"] = [{"ramp": {"from": 0, "to": -0.02, "end": 1e-3}}, 0, 0]
    assert not any("unstable balance" in doubt for doubt in attempt(tmp_path, short).outcome.doubts)
    assert not asked
