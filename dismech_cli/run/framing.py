"""When a state is looked at, and when it becomes a frame."""

from __future__ import annotations

import time

import numpy as np

from ..arrays import FloatArray
from ..model.saved import Arrays, Numbers
from ..model.state import State
from ..solve.step_result import StepResult
from .looks import Looks, at_ends, due_from
from .observables.snapshot import Snapshot
from .observe import Observer
from .sink import Sink
from .tally import Stopwatch
from .validity import Validity
from .watched import Watched


class Framing:
    """Reads the watched probes at every look, and writes a frame when one is due.

    Implements :class:`~dismech_cli.model.saved.Saved`.

    Attributes:
        frames: Frames written.
    """

    def __init__(
        self,
        every: float,
        looks: Looks,
        observer: Observer,
        watched: Watched,
        validity: Validity,
        sink: Sink,
        stopwatch: Stopwatch,
    ) -> None:
        """Start before the first frame.

        Args:
            every: Time between frames [s].
            looks: When to look.
            observer: Makes snapshots and frames.
            watched: Probes to read.
            validity: Looks at what frames show.
            sink: Where frames go.
            stopwatch: Counts the time this takes.
        """
        self._every = every
        self._looks = looks
        self._observer = observer
        self._watched = watched
        self._validity = validity
        self._sink = sink
        self._stopwatch = stopwatch
        self.frames = 0
        self._skipped = 0
        self._iterations = 0
        self._residual = np.empty(0)

    @property
    def at_ends(self) -> bool:
        """Whether states within steps are never looked at."""
        return self._looks is at_ends

    @property
    def watches(self) -> bool:
        """Whether the ends of all steps are looked at."""
        return bool(self._watched)

    def read(self, result: StepResult) -> None:
        """Read the watched probes at the end of a step at which no frame is due."""
        if self._watched:
            self._watched.read(self._observer.snapshot(result.state, result.residual))

    @property
    def due(self) -> float:
        """When the next frame is due [s], less rounding."""
        return due_from((self.frames + self._skipped) * self._every)

    def see(
        self, before: State, result: StepResult, dt: float, iterations: int, *, last: bool
    ) -> Snapshot | None:
        """Look at a step that was accepted.

        Args:
            before: The state it began with; that of the result before the first step.
            result: The step.
            dt: Its length [s].
            iterations: Newton iterations of the run so far.
            last: Whether the run ends here, where a frame is always due.

        Returns:
            The end of the step if a frame was due on the way, or what has an energy that is no number,
            of which no frame is written.
        """
        after, shown, tick = result.state, False, time.perf_counter()
        due = (self.frames + self._skipped) * self._every
        for t, framed in self._looks(before.t, after.t, due, self._every):
            at_end = t == after.t
            framed = framed or (at_end and last)
            shown = shown or framed
            if not (framed or self._watched or (at_end and shown)):
                continue
            snapshot = self._snapshot(before, result, t)
            self._watched.read(snapshot)
            if framed and not snapshot.finite:
                self._stopwatch.book("observe", tick)
                return snapshot
            if framed:
                tick = self._write(snapshot, dt, iterations, result.residual_norm, tick)
        self._residual = result.residual
        self._stopwatch.book("observe", tick)
        return snapshot if shown else None

    def _snapshot(self, before: State, result: StepResult, t: float) -> Snapshot:
        """What a look at a time [s] of a step shows."""
        after = result.state
        if t == after.t:
            return self._observer.snapshot(after, result.residual)
        ahead = (after.t - t) / (after.t - before.t)
        residual: FloatArray = result.residual - ahead * (result.residual - self._residual)
        return self._observer.snapshot(self._observer.between(before, after, t), residual)

    def _write(
        self, snapshot: Snapshot, dt: float, iterations: int, residual_norm: float, tick: float
    ) -> float:
        """Write a frame; the tick after it."""
        self._validity.look(snapshot)
        watch, since = self._stopwatch, iterations - self._iterations
        frame = self._observer.frame(self.frames, snapshot, dt, since, residual_norm, watch.wall)
        tick = watch.book("observe", tick)
        self._sink.frame(frame)
        self.frames += 1
        self._iterations = iterations
        return watch.book("write", tick)

    def arrays(self) -> Arrays:
        """Forces that were out of balance at the last state: reactions."""
        return {"residual": self._residual}

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
        self._residual = np.array(arrays["residual"])
        self._skipped, every = int(numbers["skipped"]), float(numbers["every"])
        if every != self._every and self._every > 0.0:
            shown = (self.frames - 1 + self._skipped) * every
            self._skipped = int(shown / self._every * (1.0 + 1e-12)) + 1 - self.frames
        return self
