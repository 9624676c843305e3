"""What `check` and a run say about the step."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt
from pathlib import Path

import pytest
from decks import Deck, given_section, line, rod_deck

from dismech_cli import simulate
from dismech_cli.compose.compose import compose
from dismech_cli.run.interrupt import StopRequest
from dismech_cli.run.loop import Limits, Outcome
from dismech_cli.run.sink import Progress
from dismech_cli.scenario.load import load, load_mapping
from dismech_cli.session.ending import conclude
from dismech_cli.session.modes import find_modes

DECK: Deck = rod_deck(
    line(41),
    given_section(axial=1e4),
    motions=[{"type": "clamp", "where": "rod.start", "at": "node"}],
    numerics={"dt": 0.02, "t_end": 0.5},
)


class Told:
    """Keeps what it is told, and shows nothing."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def say(self, text: str) -> None:
        self.lines.append(text)

    warn = error = detail = say

    def progress(self, progress: Progress) -> None:
        pass


def test_the_slowest_swing_is_that_of_a_cantilever_and_the_fastest_that_of_its_edges() -> None:
    """2 pi / 1.8751^2 sqrt(m l^4 / EI), and 2 sqrt(EA / m) / dl for the axial mode that zigzags."""
    modes = find_modes(compose(load_mapping(DECK)).simulation, 0.02)
    assert modes is not None
    assert modes.slowest == pytest.approx(2 * pi / 1.875104**2, rel=0.01)
    bending, axial = 4.0 / 0.025**2, 2.0 * sqrt(1e4) / 0.025
    assert modes.fastest == pytest.approx(2 * pi / max(bending, axial), rel=0.05)
    # TR-BDF2 damps the fast one by about 5 / (omega dt) a step, the slow one by less than (omega dt)^3
    assert modes.kept_fastest is not None
    assert modes.kept_fastest < 0.05
    assert modes.kept is not None
    assert 0.999 < modes.kept < 1.0
    assert "steps" in str(modes)


def test_what_has_no_swings_tells_none() -> None:
    deck = DECK | {"numerics": {"integrator": {"type": "static"}}}
    assert find_modes(compose(load_mapping(deck)).simulation, None) is None


def test_adaptive_steps_tell_periods_alone() -> None:
    deck = DECK | {"numerics": {"t_end": 0.5}}
    modes = find_modes(compose(load_mapping(deck)).simulation, None)
    assert modes is not None
    assert modes.step is None
    assert "steps" not in str(modes)


@pytest.mark.parametrize(("iterations", "told"), [(20 * 25, True), (3 * 25, False)])
def test_a_laborious_run_says_what_is_likely_cheaper(iterations: int, told: bool) -> None:
    loaded = load_mapping(DECK)
    report = simulate(loaded)
    counts = {**report.outcome.counters, "iterations": iterations}
    outcome: Outcome = replace(report.outcome, counters=counts)
    narrator = Told()
    conclude(loaded, outcome, Limits(), StopRequest(), narrator, advice="")
    assert any("--set numerics.dt='0.01 s'" in text for text in narrator.lines) == told


SNAKE = Path(__file__).resolve().parents[2] / "scenarios" / "snake_21.yaml"


@pytest.mark.parametrize(
    ("overrides", "told"),
    [
        (("numerics.dt=null",), "changed here: --set numerics.dt=null, --set"),
        (
            ("numerics.dt=40 ms", "output.every=0.1 s"),
            "changed here: --set 'numerics.dt=40 ms', --set 'numerics.t_end=0.1 s'.",
        ),
    ],
)
def test_an_expectation_that_a_changed_run_misses_names_the_change(
    overrides: tuple[str, ...], told: str
) -> None:
    """The snake promises where it comes with steps of 50 ms: without them the head is elsewhere."""
    missed = (
        "expect={head: {probe: {position: body.start, component: x}, value: -1, tolerance: 0, source: s}}"
    )
    narrator = Told()
    loaded = load(SNAKE, overrides=(*overrides, "numerics.t_end=0.1 s", missed))
    report = simulate(loaded, narrator=narrator)
    assert not report.verdicts[0].passed
    told_of_steps = [text for text in narrator.lines if "numerics.step.rtol=5e-05" in text]
    assert len(told_of_steps) == ("numerics.dt=null" in overrides)
    (hint,) = [text for text in narrator.lines if "expected values are those of the file" in text]
    assert told in hint


def test_a_file_as_it_is_has_no_change_to_name() -> None:
    deck = DECK | {
        "expect": {
            "x": {
                "probe": {"position": "rod.end", "component": "x"},
                "value": 9,
                "tolerance": 0,
                "source": "s",
            }
        }
    }
    narrator = Told()
    assert not simulate(load_mapping(deck), narrator=narrator).verdicts[0].passed
    assert not [text for text in narrator.lines if "changed here" in text]
