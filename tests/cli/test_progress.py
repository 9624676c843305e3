from __future__ import annotations

import io

import pytest

from dismech_cli.cli import console
from dismech_cli.run import progress
from dismech_cli.run.progress import Bar, Lines, Silent, clock_time, make_reporter
from dismech_cli.run.sink import Progress


class Stream(io.StringIO):
    def __init__(self, terminal: bool) -> None:
        super().__init__()
        self.terminal = terminal

    def isatty(self) -> bool:
        return self.terminal


@pytest.mark.parametrize(
    ("shown", "terminal", "term", "kind"),
    [
        ("auto", True, "xterm", Bar),
        ("auto", False, "xterm", Lines),
        ("auto", True, "dumb", Lines),
        ("bar", False, "xterm", Lines),
        ("bar", True, "dumb", Lines),
        ("bar", True, None, Bar),
        ("lines", True, "xterm", Lines),
        ("none", True, "xterm", Silent),
    ],
)
def test_no_animation_without_a_terminal(shown, terminal, term, kind):
    assert type(make_reporter(shown, Stream(terminal), term)) is kind


def steps(count: int = 100):
    return [Progress(t=0.02 * k, t_end=2.0, dt=0.02, steps=k, iterations=3 * k) for k in range(1, count + 1)]


@pytest.fixture
def clock(monkeypatch):
    """A clock that the test moves: half a second per look."""
    now = [0.0]

    def look() -> float:
        now[0] += 0.5
        return now[0]

    monkeypatch.setattr(progress.time, "monotonic", look)


def test_lines_are_few_and_complete(clock):
    stream = Stream(False)
    reporter = make_reporter("auto", stream, None)
    for p in steps():
        reporter.update(p)
    reporter.close()
    lines = stream.getvalue().splitlines()
    assert len(lines) == 10
    assert "\r" not in stream.getvalue()
    # Half a second per step: 2 steps/s, so 50 steps are left for 25 s.
    for text in ("t 1 of 2 s", "50 %", "dt 0.02 s", "3.0 Newton/step", "2 steps/s", "ETA 0:25"):
        assert text in lines[4]


def test_a_resumed_run_measures_its_own_speed(clock):
    stream = Stream(False)
    reporter = make_reporter("lines", stream, None)
    for p in steps()[80:]:
        reporter.update(p)
    assert "2 steps/s  ETA 0:05" in stream.getvalue().splitlines()[1]


def test_a_bar_cleans_up(clock):
    stream = Stream(True)
    reporter = make_reporter("bar", stream, "xterm")
    for p in steps():
        reporter.update(p)
    assert stream.getvalue().count("\n") == 0
    assert "[##########----------]" in stream.getvalue()
    reporter.close()
    assert stream.getvalue().endswith("\r\x1b[K")


def test_clock_time():
    assert [clock_time(s) for s in (0.2, 65.0, 3725.4)] == ["0:00", "1:05", "1:02:05"]


@pytest.mark.parametrize(
    ("terminal", "variables", "expected"),
    [
        (True, {}, True),
        (False, {}, False),
        (True, {"NO_COLOR": "1"}, False),
        (True, {"TERM": "dumb"}, False),
    ],
)
def test_colour_only_where_it_is_wanted(monkeypatch, terminal, variables, expected):
    for name in ("NO_COLOR", "TERM"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    stream = Stream(terminal)
    monkeypatch.setattr(console.sys, "stderr", stream)
    console.Console().error("no")
    assert ("\x1b[" in stream.getvalue()) == expected
    assert stream.getvalue().replace("\x1b[31m", "").replace("\x1b[0m", "") == "error: no\n"
