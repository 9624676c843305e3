from __future__ import annotations

import io

import pytest

from dismech_cli.cli import console, progress
from dismech_cli.cli.progress import Bar, Lines, Nothing, clock_time, make_display
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
        ("none", True, "xterm", Nothing),
    ],
)
def test_no_animation_without_a_terminal(shown, terminal, term, kind):
    assert type(make_display(shown, Stream(terminal), term)) is kind


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
    display = make_display("auto", stream, None)
    for p in steps():
        display.update(p)
    display.clear()
    lines = stream.getvalue().splitlines()
    assert len(lines) == 10
    assert "\r" not in stream.getvalue()
    # Half a second per step: 2 steps/s, so 50 steps are left for 25 s.
    for text in ("t 1 of 2 s", "50 %", "dt 0.02 s", "3.0 Newton/step", "2 steps/s", "ETA 0:25"):
        assert text in lines[4]


def test_a_resumed_run_measures_its_own_speed(clock):
    stream = Stream(False)
    display = make_display("lines", stream, None)
    for p in steps()[80:]:
        display.update(p)
    assert "2 steps/s  ETA 0:05" in stream.getvalue().splitlines()[1]


def test_a_bar_cleans_up(clock):
    stream = Stream(True)
    display = make_display("bar", stream, "xterm")
    for p in steps():
        display.update(p)
    assert stream.getvalue().count("\n") == 0
    assert "[##########----------]" in stream.getvalue()
    display.clear()
    assert stream.getvalue().endswith("\r\x1b[K")


def test_a_line_of_text_does_not_end_in_the_bar(clock, monkeypatch):
    stream = Stream(True)
    monkeypatch.setattr(console.sys, "stderr", stream)
    monkeypatch.setenv("NO_COLOR", "1")
    with console.Console(display=Bar(stream)) as narrator:
        narrator.progress(steps()[0])
        narrator.warn("look")
        assert stream.getvalue().endswith("\r\x1b[Kwarning: look\n")
        narrator.progress(steps()[1])
    assert stream.getvalue().endswith("\r\x1b[K")


def test_quiet_shows_no_progress(clock):
    stream = Stream(False)
    narrator = console.Console(console.QUIET, Lines(stream))
    for p in steps():
        narrator.progress(p)
    assert stream.getvalue() == ""


@pytest.mark.parametrize(("terminal", "level"), [(True, 1), (True, 0), (False, 1)])
def test_frames_are_counted_on_a_terminal_alone(monkeypatch, terminal, level):
    stream = Stream(terminal)
    monkeypatch.setattr(console.sys, "stderr", stream)
    monkeypatch.setenv("TERM", "xterm")
    narrator = console.Console(level)
    narrator.drawn(1, 2)
    shown = "\r\x1b[Kframe 1 of 2" if terminal and level else ""
    assert stream.getvalue() == shown
    narrator.drawn(2, 2)
    assert stream.getvalue().endswith("\r\x1b[K" if shown else "")


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
