"""Where the results of a run go."""

from __future__ import annotations

from typing import Protocol

from ..frozen import frozen
from ..model.saved import Arrays, Numbers
from ..output.frame import Frame


@frozen
class Progress:
    """Where a run stands, for the progress display."""

    t: float
    t_end: float
    dt: float
    steps: int
    iterations: int


class Sink(Protocol):
    """Receives what a run produces."""

    def frame(self, frame: Frame) -> None:
        """Store a frame."""

    def event(self, kind: str, t: float, **details: object) -> None:
        """Note something that happened."""

    def checkpoint(self, arrays: Arrays, numbers: Numbers) -> None:
        """Store what :func:`.loop.run` needs to go on; the time [s] is the number ``state.t``."""

    def progress(self, progress: Progress) -> None:
        """Tell the user."""
