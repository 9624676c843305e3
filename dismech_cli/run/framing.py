"""When a state is looked at, and when it becomes a frame."""

from __future__ import annotations

import time

from ..model.saved import Arrays, Numbers
from ..solve.step import StepResult
from .observables.snapshot import Snapshot
from .observe import Observer
from .sink import Sink
from .tally import Stopwatch
from .validity import Validity
from .watched import Watched


class Framing:
    """Reads the watched probes at every state, and writes a frame when one is due.

    Implements :class:`~dismech_cli.model.saved.Saved`.

    Attributes:
        frames: Frames written.
    """

    def __init__(
        self,
        every: float,
        observer: Observer,
        watched: Watched,
        validity: Validity,
        sink: Sink,
        stopwatch: Stopwatch,
    ) -> None:
        """Start before the first frame.

        Args:
            every: Time between frames [s].
            observer: Makes snapshots and frames.
            watched: Probes to read.
            validity: Looks at what frames show.
            sink: Where frames go.
            stopwatch: Counts the time this takes.
        """
        self._every = every
        self._observer = observer
        self._watched = watched
        self._validity = validity
        self._sink = sink
        self._stopwatch = stopwatch
        self.frames = 0
        self._skipped = 0
        self._iterations = 0

    def see(self, result: StepResult, dt: float, iterations: int, *, last: bool) -> Snapshot | None:
        """Look at an accepted state.

        Args:
            result: The step that led to it.
            dt: Length of that step [s].
            iterations: Newton iterations of the run so far.
            last: Whether the run ends here, where a frame is always due.

        Returns:
            What the frame shows, if one was due; it is not written where an energy is no number.
        """
        due = result.state.t >= (self.frames + self._skipped) * self._every * (1.0 - 1e-12) or last
        if not due and not self._watched:
            return None
        watch, tick = self._stopwatch, time.perf_counter()
        snapshot = self._observer.snapshot(result.state, result.residual)
        self._watched.read(snapshot)
        if not due:
            watch.book("observe", tick)
            return None
        if not snapshot.finite:
            watch.book("observe", tick)
            return snapshot
        self._validity.look(snapshot)
        since = iterations - self._iterations
        frame = self._observer.frame(self.frames, snapshot, dt, since, result.residual_norm, watch.wall)
        tick = watch.book("observe", tick)
        self._sink.frame(frame)
        watch.book("write", tick)
        self.frames += 1
        self._iterations = iterations
        return snapshot

    def arrays(self) -> Arrays:
        """None."""
        return {}

    def numbers(self) -> Numbers:
        """The number of frames and how they are spaced, and the iterations at the last one."""
        return {
            "frames": self.frames,
            "skipped": self._skipped,
            "every": self._every,
            "iterations": self._iterations,
        }

    def restore(self, arrays: Arrays, numbers: Numbers) -> Framing:
        """Go on after the last frame that was saved; where the spacing changed, at its next multiple."""
        self.frames, self._iterations = int(numbers["frames"]), int(numbers["iterations"])
        self._skipped, every = int(numbers["skipped"]), float(numbers["every"])
        if every != self._every and self._every > 0.0:
            shown = (self.frames - 1 + self._skipped) * every
            self._skipped = int(shown / self._every * (1.0 + 1e-12)) + 1 - self.frames
        return self
