"""A run may pause after every attempt, those that fail among them, and goes on as if it never had."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest
from numpy.testing import assert_array_equal

from dismech_cli import load
from dismech_cli.compose.compose import compose
from dismech_cli.model.saved import Arrays, Numbers
from dismech_cli.output.frame import Frame
from dismech_cli.run.loop import End, Limits, Outcome, run
from dismech_cli.run.simulation import Simulation
from dismech_cli.run.sink import Progress

CONTORTION = Path(__file__).parents[2] / "scenarios" / "contortion.yaml"


@dataclass
class _Kept:
    last: tuple[Arrays, Numbers] | None = None

    def frame(self, frame: Frame) -> None:
        pass

    def event(self, kind: str, t: float, **details: object) -> None:
        pass

    def checkpoint(self, arrays: Arrays, numbers: Numbers) -> None:
        self.last = arrays, numbers

    def progress(self, progress: Progress) -> None:
        pass


def _buckling(*numerics: str) -> Simulation:
    """A run of which some steps are cut or refused."""
    own = [f"numerics.{one}" for one in numerics]
    loaded = load(CONTORTION, overrides=["expect={}", "numerics.t_end=400 ms", *own])
    return compose(loaded, kernels="numpy").simulation


@pytest.mark.parametrize(
    "steps", [["dt=40 ms"], ["dt=100 ms", "step={adaptive: true, rtol: 1e-2}"]], ids=["fixed", "adaptive"]
)
def test_a_pause_after_every_attempt_changes_nothing(steps: list[str]) -> None:
    simulation = _buckling(*steps)
    straight = _finished(simulation, _Kept())
    failed = straight.counters["cuts"] + straight.counters["refused"]
    assert failed > 0
    kept, pauses = _Kept(), 0
    ended = run(simulation, kept, limits=Limits(wall=0.0))
    while ended.end is End.INTERRUPTED:
        pauses += 1
        ended = run(simulation, kept, limits=Limits(wall=0.0), resume_from=kept.last)
    assert ended.end is End.DONE
    assert pauses == straight.counters["steps"] + failed - 1
    assert_array_equal(ended.state.q, straight.state.q)
    assert_array_equal(ended.state.v, straight.state.v)
    assert ended.counters | {"analyses": 0} == straight.counters | {"analyses": 0}


def _finished(simulation: Simulation, kept: _Kept) -> Outcome:
    ended = run(simulation, kept)
    assert ended.end is End.DONE
    return ended
