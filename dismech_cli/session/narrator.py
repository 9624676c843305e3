"""Who is told what happens: the terminal on the command line, nobody or anybody in Python."""

from __future__ import annotations

from typing import Protocol

from ..frozen import frozen
from ..run.sink import Progress


class Narrator(Protocol):
    """Told what a session does, as it does it; results are returned, not told."""

    def say(self, text: str) -> None:
        """For everybody but those who asked for less."""

    def warn(self, text: str) -> None:
        """Something the user should look at."""

    def error(self, text: str) -> None:
        """Why the session does not reach its end."""

    def detail(self, text: str) -> None:
        """For those who asked for more."""

    def progress(self, progress: Progress) -> None:
        """Where the run stands, after every step."""

    def drawn(self, done: int, total: int) -> None:
        """How many frames of the pictures are drawn."""


@frozen
class Silent:
    """Tells nobody."""

    def say(self, text: str) -> None:
        """Do nothing."""

    def warn(self, text: str) -> None:
        """Do nothing."""

    def error(self, text: str) -> None:
        """Do nothing."""

    def detail(self, text: str) -> None:
        """Do nothing."""

    def progress(self, progress: Progress) -> None:
        """Do nothing."""

    def drawn(self, done: int, total: int) -> None:
        """Do nothing."""
