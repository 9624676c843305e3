"""What the user sees: results on stdout, everything else on stderr and in the log of the run."""

from __future__ import annotations

import contextlib
import os
import sys
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from ..errors import OutputError

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
    """Writes to stderr, and to a log file once there is one.

    Attributes:
        level: ``QUIET`` shows warnings and errors, ``NORMAL`` progress too, ``VERBOSE`` all.
        log: The file that also gets every line, with the time.
    """

    level: int = NORMAL
    log: Path | None = None

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

    def _write(self, text: str, shown: bool, label: str = "", color: str = "") -> None:
        start = f"{label}: " if label else ""
        if self.log is not None:
            # The run goes on without a log; what stops it is told by the result files.
            with contextlib.suppress(OSError), self.log.open("a", encoding="utf-8") as file:
                file.write(f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ} {start}{text}\n")
        if shown:
            start = f"{color}{start.rstrip()}{_END} " if label and colored() else start
            # Nobody reading the progress is no reason to stop a simulation.
            with contextlib.suppress(OSError):
                print(f"{start}{text}", file=sys.stderr, flush=True)
