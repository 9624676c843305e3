"""What the user sees: results on stdout, everything else on stderr."""

from __future__ import annotations

import contextlib
import os
import sys
from dataclasses import dataclass, field
from types import TracebackType
from typing import TYPE_CHECKING, Self

from ..errors import OutputError
from .progress import Display, Nothing, count_frames

if TYPE_CHECKING:  # the run loop loads NumPy
    from ..run.sink import Progress

QUIET, NORMAL, VERBOSE = 0, 1, 2

_RED, _YELLOW, _END = "\x1b[31m", "\x1b[33m", "\x1b[0m"


class ClosedPipeError(Exception):
    """The reader of stdout went away; nothing to tell anybody."""


def emit(text: str) -> None:
    """Write a result to stdout.

    Raises:
        ClosedPipeError: If nobody reads it.
        OutputError: If it cannot be written, as to a file on a full disk.
    """
    if sys.stdout is None:
        raise OutputError("cannot write to standard output: it is closed")
    try:
        print(text, flush=True)
    except BrokenPipeError:
        raise ClosedPipeError from None
    except OSError as error:
        raise OutputError(f"cannot write to standard output: {error.strerror}") from error


def colored() -> bool:
    """Whether stderr shows colours and wants them (NO_COLOR, TERM=dumb)."""
    return sys.stderr.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


@dataclass(slots=True)
class Console:
    """The narrator of the terminal: writes to stderr. As a context manager it leaves the terminal tidy.

    Attributes:
        level: ``QUIET`` shows warnings and errors, ``NORMAL`` progress too, ``VERBOSE`` all.
        display: Shows where a run stands.
    """

    level: int = NORMAL
    display: Display = field(default_factory=Nothing)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.display.clear()

    def detail(self, text: str) -> None:
        """For those who asked for more."""
        self._write(text, self.level >= VERBOSE)

    def say(self, text: str) -> None:
        """For everybody but those who asked for less."""
        self._write(text, self.level >= NORMAL)

    def warn(self, text: str) -> None:
        """Something the user should look at."""
        self._write(text, True, "warning", _YELLOW)

    def error(self, text: str) -> None:
        """Why the program stops."""
        self._write(text, True, "error", _RED)

    def progress(self, progress: Progress) -> None:
        """Where a run stands."""
        if self.level >= NORMAL:
            self.display.update(progress)

    def drawn(self, done: int, total: int) -> None:
        """How many frames of the pictures are drawn."""
        if self.level >= NORMAL:
            count_frames(done, total, sys.stderr, os.environ.get("TERM"))

    def _write(self, text: str, shown: bool, label: str = "", color: str = "") -> None:
        if not shown:
            return
        self.display.clear()
        start = f"{label}: " if label else ""
        start = f"{color}{start.rstrip()}{_END} " if label and colored() else start
        # Nobody reading the progress is no reason to stop a simulation.
        with contextlib.suppress(OSError):
            print(f"{start}{text}", file=sys.stderr, flush=True)
