"""A draft of every scene of the gallery that moves: it comes to its end, no more doubtful than the scene."""

from __future__ import annotations

from pathlib import Path

import pytest

from dismech_cli import load, simulate
from dismech_cli.run.loop import End

SCENARIOS = Path(__file__).parents[2] / "scenarios"


def moving() -> list[Path]:
    files = sorted([*SCENARIOS.glob("*.yaml"), *(SCENARIOS / "verification").glob("*.yaml")])
    return [path for path in files if load(path).scenario.numerics.dt is not None]


@pytest.mark.slow
@pytest.mark.parametrize("path", moving(), ids=lambda path: path.stem)
def test_a_draft_comes_to_its_end(path: Path) -> None:
    shipped, draft = simulate(path), simulate(path, profile="draft")
    assert draft.outcome.end is End.DONE, draft.message
    assert len(draft.outcome.doubts) <= len(shipped.outcome.doubts), draft.outcome.doubts
    # a scene that no cheaper setting keeps within 10 % is its own draft
    same = load(path).scenario.numerics == load(path, profile="draft").scenario.numerics
    assert same or draft.outcome.counters["steps"] != shipped.outcome.counters["steps"]
