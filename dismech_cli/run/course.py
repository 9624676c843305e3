"""The course of one run: where it stands, and what is booked as it goes on."""

from __future__ import annotations

import time
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite
from typing import NamedTuple

import numpy as np

from ..errors import LawError
from ..model.saved import Arrays, Numbers, Saved, restore_all, save_all, within
from ..model.state import State
from ..solve.status import Status
from ..solve.step import Stepper
from ..solve.step_result import StepResult
from .books import Books
from .events import Events
from .observables.snapshot import Snapshot
from .observe import Singular
from .simulation import Simulation
from .sink import Progress, Sink
from .step_control import StepControl
from .tally import Stopwatch

# Steps taken in one at most, and how many numbers they may be: within a blink.
_MOST, _NUMBERS = 64, 2**16


class Leap(NamedTuple):
    """Many steps in one.

    Attributes:
        shown: What the frame at the end shows, if one was due.
        dt: Length of the last step [s].
        attempts: Start and end [s], linear solves, and largest free residual [N] of each.
    """

    shown: Snapshot | None
    dt: float
    attempts: Sequence[tuple[float, float, int, float]]


@dataclass(slots=True)
class Course:
    """One run under way.

    Attributes:
        simulation: What is run.
        stepper: Takes its steps.
        sink: Where results go.
        events: Tells it of steps.
        state: Where it stands.
        control: How far the next step goes.
        books: What it remembers beside.
        singular: Where eigenvalues could not be counted: the first state, if any.
    """

    simulation: Simulation
    stepper: Stepper
    sink: Sink
    events: Events
    state: State
    control: StepControl
    books: Books
    singular: list[Singular]

    @classmethod
    def of(cls, simulation: Simulation, sink: Sink) -> Course:
        """Stand before the start of a run."""
        stopwatch, tick = Stopwatch(), time.perf_counter()
        stepper = Stepper(
            simulation.model,
            simulation.integrator,
            simulation.newton,
            simulation.linear_solver,
            simulation.advance,
        )
        singular: list[Singular] = []
        books = Books.of(simulation, stepper, sink, singular, stopwatch)
        stopwatch.book("bind", tick)
        events = Events(sink, simulation)
        return cls(simulation, stepper, sink, events, simulation.start, simulation.control, books, singular)

    def parts(self) -> dict[str, Saved]:
        """All that the run remembers from step to step: each saves itself."""
        return {"state": self.state, "control": self.control, **self.books.parts()}

    @property
    def counts(self) -> dict[str, int]:
        """Steps, iterations, cuts, frames, analyses; with contact rebuilds of its places."""
        rebuilds = {} if self.simulation.touched is None else {"rebuilds": self.books.counters.rebuilds}
        return {**self.books.counts, "analyses": self.stepper.analyses, **rebuilds}

    @property
    def seconds(self) -> dict[str, float]:
        """Wall time of this process by phase [s]; what contact takes in steps is a phase of its own."""
        return self.books.stopwatch.seconds

    def begin(self) -> Snapshot | None:
        """Start: the energy at rest is the zero of the account.

        Returns:
            What the first frame shows.
        """
        tick = time.perf_counter()
        self._prepare()
        self.books.account.start(self.state)
        self.books.stopwatch.book("bind", tick)
        nothing = np.zeros_like(self.state.q)
        result = StepResult(self.state, Status.CONVERGED, 0, 0.0, nothing, -1)
        return self._show(self.state, result, 0.0)

    def resume(self, arrays: Arrays, numbers: Numbers) -> None:
        """Start from a checkpoint."""
        self.state = self.state.restore(within("state", arrays), within("state", numbers))
        self.control = self.control.restore(within("control", arrays), within("control", numbers))
        self.books.take(restore_all(self.books.parts(), arrays, numbers))
        tick = time.perf_counter()
        self._prepare()
        self.books.stopwatch.book("bind", tick)

    def checkpoint(self) -> None:
        """Save all parts."""
        tick = time.perf_counter()
        arrays, numbers = save_all(self.parts())
        structure = {f"structure.{name}": array for name, array in self.simulation.structure.items()}
        self.sink.checkpoint(arrays | structure, numbers)
        self.books.stopwatch.book("write", tick)

    def step(self) -> StepResult:
        """Try to reach the control's target; a step that fails leaves the run where it is.

        Raises:
            LawError: Something that the step follows has no value there.
            ControlError: A controller fails.
        """
        target, tick = self.control.target, time.perf_counter()
        touching = self.stepper.changing_seconds
        self._act(target)
        self._prepare()
        step = self.stepper.step if self.control.exhausted else self.stepper.attempt
        result = step(self.state, target - self.state.t)
        self.books.stopwatch.book("solve", tick)
        if self.simulation.touched is not None:
            self.books.stopwatch.move(self.stepper.changing_seconds - touching, "solve", "contact")
        self.books.counters.iterations += result.iterations
        return _landed(result, self.state, target)

    def leap(self, until: float) -> Leap | None:
        """Take and book many steps up to a time [s] in one, which end where a frame is due.

        None where something acts between them, or where they are not plain.
        """
        ahead = self._ahead(until)
        if len(ahead) < 2:
            return None
        tick, before = time.perf_counter(), self.state
        self._prepare()
        try:
            steps = self.stepper.leap(self.state, ahead)
        except LawError:
            # not before its time: a step up to there may do without
            return None
        self.books.stopwatch.book("solve", tick)
        if steps is None:
            return None
        result = steps.result(steps.count - 1)
        if _lost(result.state) >= 0:
            return None
        self.books.leap(self.state, steps, result, self.control.t_end, balanced=self.stepper.balanced_ends)
        self.control, self.state = self.control.passed(steps.count), result.state
        dt = steps.times[-1] - steps.times[-2]
        return Leap(self._show(before, result, dt), dt, steps.attempts)

    def _ahead(self, until: float) -> Sequence[float]:
        """Ends [s] of the steps up to the next frame, where nothing acts on the states between them."""
        books, simulation = self.books, self.simulation
        if not books.framing.at_ends or simulation.controls.loops or simulation.touched is not None:
            return ()
        ahead = self.control.ahead(max(min(_MOST, _NUMBERS // len(self.state.q)), 1))
        return ahead[: bisect_left(ahead, min(books.framing.due, until)) + 1]

    def cut(self, result: StepResult) -> None:
        """Shorten the step that failed."""
        self.events.cut(self.state.t, self.control.target, result.status)
        self.control = self.control.failed()
        self.books.counters.cuts += 1

    def refuse(self, result: StepResult, shorter: StepControl) -> None:
        """Take a step again that was not accurate, shortened."""
        self.events.refused(self.state.t, result.state.t)
        self.control = shorter
        self.books.counters.refused += 1

    def accept(self, result: StepResult) -> Snapshot | None:
        """Book a step that reached its target, and go on from there.

        Returns:
            What the frame shows, if one was due.
        """
        before, after = self.state, result.state
        self.books.step(before, result, self.control.t_end)
        self.books.counters.rebuilds += self.events.contact(before, after)
        if result.ambiguous:
            self.events.ambiguous(before.t, after.t)
        self.state = after
        self.control = self.control.accepted(result)
        return self._show(before, result, after.t - before.t)

    def report(self, dt: float) -> None:
        """Tell where the run stands after a step of ``dt`` [s]."""
        count = self.books.counters
        self.sink.progress(Progress(self.state.t, self.control.t_end, dt, count.steps, count.iterations))

    def _show(self, before: State, result: StepResult, dt: float) -> Snapshot | None:
        return self.books.framing.see(
            before, result, dt, self.books.counters.iterations, last=self.control.done
        )

    def _act(self, target: float) -> None:
        """Let controllers put in what they do for a step to a time [s]."""
        acted = self.simulation.controls.act(self.state, target)
        if acted is not self.state:
            self.books.account.put_in(self.state, acted)
            self.state = acted

    def _prepare(self) -> None:
        """Make ready for a step: the account follows the stepper to other free DOFs."""
        system = self.stepper.system
        self.state = self.stepper.prepare(self.state)
        if self.stepper.system is not system:
            self.books.account.bind(self.stepper.system, self.state.t)


def _landed(result: StepResult, before: State, target: float) -> StepResult:
    """A step that converged, at the time [s] it was to reach; one that is no motion has failed."""
    if result.status is not Status.CONVERGED:
        return result
    if (lost := _lost(result.state)) >= 0:
        return replace(result, state=before, status=Status.NOT_FINITE, worst=lost)
    if result.state.t == target or result.arrived:
        return result
    # the integrator adds dt, which may round
    return replace(result, state=replace(result.state, t=target))


def _lost(state: State) -> int:
    """A DOF that is at no finite place or has no finite speed; -1 if there is none."""
    if isfinite(state.q.dot(state.v)):
        return -1
    nowhere = ~np.isfinite(state.q + state.v)
    return int(np.argmax(nowhere)) if nowhere.any() else -1
