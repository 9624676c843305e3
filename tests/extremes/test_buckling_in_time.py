"""A rod pushed together buckles at any step: an indefinite tangent tells a step that is too long."""

from __future__ import annotations

from pathlib import Path

import pytest

from dismech_cli import simulate

CONTORTION = Path(__file__).parents[2] / "scenarios" / "contortion.yaml"


@pytest.mark.parametrize("dt", ["10 ms", "20 ms", "40 ms"])
def test_the_ribbon_sags_whatever_the_step(dt: str) -> None:
    report = simulate(CONTORTION, overrides=[f"numerics.dt={dt}"])
    # steps of 20 and 40 ms stride over the growth of the arch unless they are cut: it then stays straight
    assert report.outcome.counters["cuts"] > 0
    report.raise_for_status()


def test_statics_takes_an_unstable_balance_without_cuts() -> None:
    report = simulate(CONTORTION.parent / "verification" / "euler_column.yaml")
    assert report.scalars["t"][-1] == 1.0
    assert report.outcome.counters["cuts"] == 0
