"""Where a run goes beside the files: into memory, to the narrator, or to several at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ..frozen import frozen
from ..model.saved import Arrays, Numbers
from ..output.frame import Frame
from ..run.sink import Progress, Sink
from .narrator import Narrator


@dataclass
class Memory:
    """Keeps frames, events and the last checkpoint."""

    frames: list[Frame] = field(default_factory=list)
    events: list[tuple[str, float, Mapping[str, object]]] = field(default_factory=list)
    arrays: Arrays = field(default_factory=dict)
    numbers: Numbers = field(default_factory=dict)

    def frame(self, frame: Frame) -> None:
        """Keep it."""
        self.frames.append(frame)

    def event(self, kind: str, t: float, **details: object) -> None:
        """Keep it."""
        self.events.append((kind, t, details))

    def checkpoint(self, arrays: Arrays, numbers: Numbers) -> None:
        """Keep the latest."""
        self.arrays, self.numbers = arrays, numbers

    def progress(self, progress: Progress) -> None:
        """Say nothing."""


@dataclass(slots=True)
class Latest:
    """Keeps the scalars of the last frame."""

    scalars: Mapping[str, float] = field(default_factory=dict)

    def frame(self, frame: Frame) -> None:
        """Keep its scalars."""
        self.scalars = dict(frame.scalars)

    def event(self, kind: str, t: float, **details: object) -> None:
        """Do nothing."""

    def checkpoint(self, arrays: Arrays, numbers: Numbers) -> None:
        """Do nothing."""

    def progress(self, progress: Progress) -> None:
        """Do nothing."""


@frozen
class Telling:
    """Tells a narrator."""

    narrator: Narrator

    def frame(self, frame: Frame) -> None:
        """Say nothing: progress is told already."""

    def event(self, kind: str, t: float, **details: object) -> None:
        """One line; the message of a failure is told at the end."""
        shown = ", ".join(f"{key} {value}" for key, value in details.items() if key != "message")
        self.narrator.detail(f"{kind.replace('_', ' ')} at t = {t:.6g} s{': ' if shown else ''}{shown}")

    def checkpoint(self, arrays: Arrays, numbers: Numbers) -> None:
        """One line."""
        self.narrator.detail(f"checkpoint at t = {numbers['state.t']:.6g} s")

    def progress(self, progress: Progress) -> None:
        """Pass it on."""
        self.narrator.progress(progress)


@frozen
class Several:
    """Gives everything to several sinks, in order."""

    sinks: tuple[Sink, ...]

    def frame(self, frame: Frame) -> None:
        """Give it to all."""
        for sink in self.sinks:
            sink.frame(frame)

    def event(self, kind: str, t: float, **details: object) -> None:
        """Give it to all."""
        for sink in self.sinks:
            sink.event(kind, t, **details)

    def checkpoint(self, arrays: Arrays, numbers: Numbers) -> None:
        """Give it to all."""
        for sink in self.sinks:
            sink.checkpoint(arrays, numbers)

    def progress(self, progress: Progress) -> None:
        """Give it to all."""
        for sink in self.sinks:
            sink.progress(progress)
