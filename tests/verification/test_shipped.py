"""The verification scenarios that ship: each keeps what it promises."""

from __future__ import annotations

from pathlib import Path

import pytest

from dismech_cli import load, simulate
from dismech_cli.run.loop import End
from dismech_cli.run.observables.reduce import reduce_series

FILES = sorted((Path(__file__).parents[2] / "scenarios" / "verification").glob("*.yaml"))


def test_there_are_some() -> None:
    assert len(FILES) >= 4


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_keeps_its_promises(file: Path) -> None:
    loaded = load(file)
    outcome = simulate(loaded).outcome
    assert outcome.end is End.DONE, outcome.message
    assert loaded.scenario.expect
    for name, e in loaded.scenario.expect.items():
        measured = reduce_series(outcome.times, outcome.watched[name], e.reduce, at=e.at, after=e.after)
        assert e.tolerance.allows(measured, e.value), f"{name}: {measured:.8g} instead of {e.value:.8g}"
