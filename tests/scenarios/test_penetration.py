"""Every scene of contact that ships keeps to the penetration that it asks for."""

from __future__ import annotations

from pathlib import Path

import pytest

from dismech_cli import simulate
from dismech_cli.run.loop import End

FOLDER = Path(__file__).parents[2] / "scenarios"
QUICK = {"incline", "incline_anchored", "rod_on_floor", "sliding_stop"}
"""They take a second each."""


def with_contact() -> list[Path]:
    """The scenes that say what touches what."""
    files = sorted(FOLDER.glob("*.yaml"))
    return [file for file in files if "\ncontact:" in file.read_text(encoding="utf-8")]


SCENES = [
    pytest.param(file, id=file.stem, marks=() if file.stem in QUICK else pytest.mark.slow)
    for file in with_contact()
]


def test_there_are_some() -> None:
    assert len(SCENES) > len(QUICK)


@pytest.mark.parametrize("file", SCENES)
def test_stays_within_the_tolerance(file: Path) -> None:
    """At the end of every step, whether a frame shows it or not."""
    report = simulate(file)
    assert report.outcome.end is End.DONE
    (contact,) = report.composition.simulation.model.changing
    assert report.outcome.state.memory["contact.worst"][0] <= contact.rule.tolerance * (1.0 + 1e-9)
    assert not [line for line in report.warnings if "press into" in line or "pass through" in line]
