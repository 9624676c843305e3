"""Many steps in one are the steps that they are made of, bit by bit."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from dismech_cli.compose.compose import compose
from dismech_cli.run.course import Course
from dismech_cli.run.loop import End, Limits, Outcome, run
from dismech_cli.scenario.load import load
from dismech_cli.session.sinks import Memory

pytest.importorskip("numba")
SCENARIOS = Path(__file__).parents[2] / "scenarios"
CONTORTION = ("numerics.dt=10 ms", "numerics.t_end=0.5 s", "output.every=70 ms", "expect={}")


def _ran(name: str, *overrides: str, **options: Any) -> tuple[Outcome, Memory]:
    memory = Memory()
    simulation = compose(load(SCENARIOS / f"{name}.yaml", overrides=overrides), "numba").simulation
    return run(simulation, memory, **options), memory


def _told(outcome: Outcome, memory: Memory) -> Mapping[str, Any]:
    """All numbers of a run but its wall time."""
    frames = [(frame.t, frame.positions.tobytes(), {**frame.scalars, "wall": 0.0}) for frame in memory.frames]
    watched = {probe: values.tobytes() for probe, values in outcome.watched.items()}
    return {
        "frames": frames,
        "watched": watched,
        "counters": outcome.counters,
        "end": outcome.state.q.tobytes() + outcome.state.v.tobytes() + outcome.state.a.tobytes(),
    }


# watched at each step; ends that are moved; driven strains and drag; frames at every third step
@pytest.mark.parametrize(
    ("name", "overrides"),
    [
        ("cantilever_dynamic_1e6", ("numerics.t_end=0.1 s",)),
        ("contortion", CONTORTION),
        ("snake_21", ("numerics.t_end=0.5 s", "numerics.dt=10 ms", "output.every=30 ms", "expect={}")),
    ],
)
def test_leaps_are_steps(name: str, overrides: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    leaps = []
    original = Course.leap

    def noted(self: Course, until: float) -> Any:
        leaps.append(original(self, until))
        return leaps[-1]

    with monkeypatch.context() as patch:
        patch.setattr(Course, "leap", noted)
        leapt = _told(*_ran(name, *overrides))
    assert sum(len(leap.attempts) for leap in leaps if leap is not None) > 0.5 * leapt["counters"]["steps"]
    monkeypatch.setattr(Course, "leap", lambda self, until: None)
    assert _told(*_ran(name, *overrides)) == leapt


def test_a_run_that_goes_on_within_a_leap_ends_as_one() -> None:
    """What is known of the last state is kept: summed up otherwise, work would be rounded otherwise."""
    whole = _told(*_ran("contortion", *CONTORTION))
    first, memory = _ran("contortion", *CONTORTION, limits=Limits(until=0.2371))
    assert first.end is End.INTERRUPTED
    assert first.state.t < 0.25
    second, rest = _ran("contortion", *CONTORTION, resume_from=(memory.arrays, memory.numbers))
    told = _told(second, rest)
    assert told["end"] == whole["end"]
    assert told["frames"][-1] == whole["frames"][-1]


def test_a_law_without_a_value_ahead_ends_no_run_before_its_time() -> None:
    """Steps up to there are taken, and the last of them is told of."""
    # none in the middle of the step from 100 ms on
    law = "{expression: 1e-6 * log(abs(t - 0.1005) - 0.0002)}"
    push = f"[{{type: point, where: beam.end, force: [0, 0, {law}]}}]"
    steps = ("numerics.dt=1 ms", "numerics.t_end=0.2 s", "expect={}")
    ends = []
    for leaps in (True, False):
        with pytest.MonkeyPatch.context() as patch:
            if not leaps:
                patch.setattr(Course, "leap", lambda self, until: None)
            outcome, _ = _ran("cantilever_dynamic_1e6", *steps, f"forces={push}")
            ends.append((outcome.end, outcome.message, outcome.state.t))
    assert ends[0] == ends[1]
    assert ends[0][0] is End.FAILED
    assert ends[0][2] == pytest.approx(0.1, abs=1e-9)
