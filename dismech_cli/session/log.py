"""What is told is also written down."""

from __future__ import annotations

import contextlib
from datetime import UTC, datetime
from pathlib import Path

from ..frozen import frozen
from ..run.sink import Progress
from .narrator import Narrator


@frozen
class Logged:
    """Appends every line, with the time, to a file and passes it on; progress is passed on alone.

    Attributes:
        narrator: Told everything.
        file: The log.
    """

    narrator: Narrator
    file: Path

    def say(self, text: str) -> None:
        """Write and pass on."""
        self._write(text)
        self.narrator.say(text)

    def warn(self, text: str) -> None:
        """Write and pass on."""
        self._write(f"warning: {text}")
        self.narrator.warn(text)

    def error(self, text: str) -> None:
        """Write and pass on."""
        self._write(f"error: {text}")
        self.narrator.error(text)

    def detail(self, text: str) -> None:
        """Write and pass on."""
        self._write(text)
        self.narrator.detail(text)

    def progress(self, progress: Progress) -> None:
        """Pass on."""
        self.narrator.progress(progress)

    def drawn(self, done: int, total: int) -> None:
        """Pass on."""
        self.narrator.drawn(done, total)

    def _write(self, text: str) -> None:
        # The run goes on without a log; what stops it is told by the result files.
        with contextlib.suppress(OSError), self.file.open("a", encoding="utf-8") as file:
            file.write(f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ} {text}\n")
