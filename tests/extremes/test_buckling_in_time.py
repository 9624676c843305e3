"""A rod pushed together buckles at any step: an indefinite tangent tells a step that is too long."""

from __future__ import annotations

from pathlib import Path

import pytest

from dismech_cli import simulate
from dismech_cli.run.loop import Limits

CONTORTION = Path(__file__).parents[2] / "scenarios" / "contortion.yaml"


@pytest.mark.parametrize("dt", ["10 ms", "20 ms", "40 ms"])
def test_the_ribbon_sags_whatever_the_step(dt: str) -> None:
    report = simulate(CONTORTION, overrides=[f"numerics.dt={dt}"])
    # steps of 20 and 40 ms stride over the growth of the arch unless they are cut: it then stays straight
    assert report.outcome.counters["cuts"] > 0
    report.raise_for_status()


def test_a_step_that_cannot_be_cut_is_told() -> None:
    """The ribbon stays straight: every step is a balance, and another one is beside it."""
    uncut = ("numerics.dt=20 ms", "numerics.step.max_cuts=0")
    report = simulate(CONTORTION, overrides=uncut)
    assert report.exit == 4
    (doubt,) = (doubt for doubt in report.warnings if "more than one solution" in doubt)
    assert doubt.startswith("50 steps, the first to t = 0.02 s,")
    assert "raise numerics.step.max_cuts, or reduce numerics.dt" in doubt
    # a run that stops on the way says so too
    (doubt, *_) = simulate(CONTORTION, overrides=uncut, limits=Limits(until=0.01)).outcome.doubts
    assert doubt.startswith("the step to t = 0.02 s had more than one solution")


def test_statics_takes_an_unstable_balance_without_cuts() -> None:
    report = simulate(CONTORTION.parent / "verification" / "euler_column.yaml")
    assert report.scalars["t"][-1] == 1.0
    assert report.outcome.counters["cuts"] == 0
