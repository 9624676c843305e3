"""Progress for people: a line that rewrites itself on a terminal, lines now and then elsewhere."""

from __future__ import annotations

import contextlib
import shutil
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol, TextIO

from ..frozen import frozen

if TYPE_CHECKING:  # the run loop loads NumPy
    from ..run.sink import Progress

_REDRAW = 0.1  # [s]
_LINE_EVERY = 30.0  # [s]
_CLEAR = "\r\x1b[K"
_SHARES = 10  # lines per run, if it is a short one


class Display(Protocol):
    """Shows where a run stands."""

    def update(self, progress: Progress) -> None:
        """After every step."""

    def clear(self) -> None:
        """Make room for a line of text; safe to call twice."""


@frozen
class Nothing:
    """Shows nothing."""

    def update(self, progress: Progress) -> None:
        """Do nothing."""

    def clear(self) -> None:
        """Do nothing."""


@dataclass(slots=True)
class Lines:
    """A line for each tenth of the run, or every half minute."""

    stream: TextIO
    meter: Meter = field(default_factory=lambda: Meter())
    _shares: int = 0
    _shown: float = field(default_factory=time.monotonic)

    def update(self, progress: Progress) -> None:
        """Print a line if one is due."""
        now = time.monotonic()
        self.meter.start(progress, now)
        shares = int(_SHARES * progress.t / progress.t_end)
        if shares > self._shares or now - self._shown >= _LINE_EVERY:
            self._shares, self._shown = shares, now
            _write(self.stream, self.meter.text(progress, now) + "\n")

    def clear(self) -> None:
        """Do nothing: every line is complete."""


@dataclass(slots=True)
class Bar:
    """One line that is rewritten, and removed before anything else is written."""

    stream: TextIO
    meter: Meter = field(default_factory=lambda: Meter())
    _shown: float = 0.0
    _drawn: bool = False

    def update(self, progress: Progress) -> None:
        """Redraw, at most ten times a second."""
        now = time.monotonic()
        self.meter.start(progress, now)
        if now - self._shown >= _REDRAW:
            self._shown = now
            width = shutil.get_terminal_size().columns - 1
            done = int(20 * progress.t / progress.t_end)
            bar = "#" * done + "-" * (20 - done)
            self._drawn = True
            _write(self.stream, f"{_CLEAR}{f'[{bar}] {self.meter.text(progress, now)}'[:width]}")

    def clear(self) -> None:
        """Clear the line, if it is there."""
        if self._drawn:
            self._drawn = False
            _write(self.stream, _CLEAR)


def count_frames(done: int, total: int, stream: TextIO, terminal: str | None) -> None:
    """Rewrite a line that counts the frames drawn, on a terminal; remove it at the end."""
    if animated(stream, terminal):
        _write(stream, f"{_CLEAR}frame {done} of {total}{_CLEAR if done == total else ''}")


@dataclass(slots=True)
class Meter:
    """Speed and remaining time, measured from the first step that this process took."""

    _t: float = 0.0
    _steps: int = 0
    _iterations: int = 0
    _began: float | None = None

    def start(self, progress: Progress, now: float) -> None:
        """Take the first report as the zero."""
        if self._began is None:
            self._t, self._steps, self._iterations = progress.t, progress.steps, progress.iterations
            self._began = now

    def text(self, p: Progress, now: float) -> str:
        """Time, step, Newton iterations, speed and what is left."""
        parts = [f"t {p.t:.4g} of {p.t_end:.4g} s", f"{100 * p.t / p.t_end:3.0f} %", f"dt {p.dt:.3g} s"]
        steps, elapsed = p.steps - self._steps, now - (self._began or now)
        if steps > 0 and elapsed > 0.0:
            parts.append(f"{(p.iterations - self._iterations) / steps:.1f} Newton/step")
            parts.append(f"{steps / elapsed:.3g} steps/s")
            if p.t > self._t:
                parts.append(f"ETA {clock_time(elapsed * (p.t_end - p.t) / (p.t - self._t))}")
        return "  ".join(parts)


def clock_time(seconds: float) -> str:
    """``3:05`` or ``1:02:03``."""
    minutes, second = divmod(round(seconds), 60)
    hours, minute = divmod(minutes, 60)
    return f"{hours}:{minute:02d}:{second:02d}" if hours else f"{minute}:{second:02d}"


def make_display(shown: str, stream: TextIO, terminal: str | None) -> Display:
    """Choose by what the user asked for and what ``stream`` is.

    Args:
        shown: ``auto``, ``bar``, ``lines`` or ``none``.
        stream: Where progress goes.
        terminal: The environment's ``TERM``.
    """
    if shown == "none":
        return Nothing()
    return Bar(stream) if shown != "lines" and animated(stream, terminal) else Lines(stream)


def animated(stream: TextIO, terminal: str | None) -> bool:
    """Whether a line may rewrite itself: that is noise in a file, whatever was asked for."""
    return stream.isatty() and terminal != "dumb"


def _write(stream: TextIO, text: str) -> None:
    # Nobody reading the progress is no reason to stop a simulation.
    with contextlib.suppress(OSError):
        stream.write(text)
        stream.flush()
