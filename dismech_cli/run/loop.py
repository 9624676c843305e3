"""The run: step, account, frame; cut steps that fail, stop when asked, resume where it stopped."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Mapping
from enum import Enum

from ..arrays import FloatArray
from ..errors import ControlError, LawError
from ..frozen import frozen
from ..model.saved import Arrays, Numbers
from ..model.state import State
from ..solve.integrators import Static
from ..solve.status import Status
from .course import Course, Leap
from .failure import (
    Attempt,
    Failure,
    describe_ambiguity,
    describe_failure,
    describe_growth,
    describe_infinite,
    describe_rounded,
    describe_runaway,
    describe_singular,
    describe_symmetry,
    describe_unstable,
)
from .interrupt import StopRequest
from .observables.snapshot import Snapshot
from .rounded import rounded_away
from .simulation import Simulation
from .sink import Sink
from .touched import Penetration

# A run that ends with more energy from nowhere than this share of what it held or turned into heat has
# an unstable step.
_GROWTH = 0.05


class End(Enum):
    """How a run ended."""

    DONE = "done"
    FAILED = "failed"
    INTERRUPTED = "interrupted"


@frozen
class Limits:
    """When to pause a run.

    Attributes:
        checkpoint_every: Wall time between checkpoints [s].
        wall: Wall time of this process after which the run stops with a checkpoint [s].
        until: Simulated time at which it stops with a checkpoint [s].
    """

    checkpoint_every: float = 60.0
    wall: float = float("inf")
    until: float = float("inf")


@frozen
class Outcome:
    """Result of a run.

    Attributes:
        end: How it ended.
        message: One or more lines for the user; empty when done.
        state: Last accepted state.
        counters: Steps, iterations, cuts, frames.
        seconds: Wall time of this process by phase [s].
        times: Times of the watched values [s].
        watched: Values of the watched probes after every step.
        doubts: What makes a run doubtful, a line each.
        remedy: A change of the scenario that may help a failed run on, as ``KEY=VALUE``; empty if none is
            known.
        penetration: The deepest so far; None if nothing touched.
    """

    end: End
    message: str
    state: State
    counters: Mapping[str, int]
    seconds: Mapping[str, float]
    times: FloatArray
    watched: Mapping[str, FloatArray]
    doubts: tuple[str, ...] = ()
    remedy: str = ""
    penetration: Penetration | None = None


def run(
    simulation: Simulation,
    sink: Sink,
    *,
    limits: Limits = Limits(),
    stop: StopRequest | None = None,
    resume_from: tuple[Arrays, Numbers] | None = None,
    announce: Callable[[str], None] = lambda text: None,
) -> Outcome:
    """Run a simulation to its end, a failure or an interruption.

    Args:
        simulation: What to run.
        sink: Where results go.
        limits: When to pause.
        stop: Set by signals.
        resume_from: A checkpoint to go on from.
        announce: Told once which solver was chosen.
    """
    course = Course.of(simulation, sink)
    if resume_from is not None:
        course.resume(*resume_from)
    elif (shown := course.begin()) is not None and not shown.finite:
        return _blown_up(course, describe_infinite(simulation, shown, 0.0))
    system = course.stepper.system
    announce(f"linear solver: {system.solver.name}, {system.pattern.m} free DOFs")
    return _advance(course, limits, stop or StopRequest())


def _advance(course: Course, limits: Limits, stop: StopRequest) -> Outcome:
    last = deque[Attempt](maxlen=5)
    saved, closed = time.monotonic(), False
    while not course.control.done:
        if course.control.closing and not closed:
            # where a run with a later end would take another way
            course.checkpoint()
            closed = True
        try:
            leap = course.leap(limits.until)
            ended = _tried(course, last) if leap is None else _leapt(course, last, leap)
        except (ControlError, LawError) as error:
            return _failed(course, Failure(str(error)))
        if ended is not None:
            return ended
        if reason := _why_pause(course, limits, stop):
            course.checkpoint()
            return _ended(course, End.INTERRUPTED, Failure(reason))
        if time.monotonic() - saved >= limits.checkpoint_every:
            course.checkpoint()
            saved = time.monotonic()
    if not course.simulation.model.mass.any() and rounded_away(
        course.stepper.system, course.simulation.start, course.state
    ):
        return _blown_up(course, describe_rounded(course.simulation, course.state))
    course.checkpoint()
    return _ended(course, End.DONE, Failure(""), _doubts(course))


def _tried(course: Course, last: deque[Attempt]) -> Outcome | None:
    """Try a step, and take it, cut it or refuse it; how the run ended if it cannot go on.

    Raises:
        LawError: Something that the step follows has no value there.
        ControlError: A controller fails.
    """
    start, target = course.state.t, course.control.target
    result = course.step()
    last.append(Attempt.of(start, target, result))
    if result.status is not Status.CONVERGED:
        if course.control.exhausted:
            cut = course.books.counters.cuts > 0
            return _failed(course, describe_failure(course.simulation, last, cut=cut))
        course.cut(result)
        return None
    if (shorter := course.control.refused(result)) is not None:
        course.refuse(result, shorter)
        return None
    return _shown(course, course.accept(result), target - start)


def _leapt(course: Course, last: deque[Attempt], leap: Leap) -> Outcome | None:
    """What :func:`_tried` does after its steps were taken."""
    last.extend(
        Attempt(start, end, Status.CONVERGED, solves, residual, -1)
        for start, end, solves, residual in leap.attempts[-5:]
    )
    return _shown(course, leap.shown, leap.dt)


def _shown(course: Course, shown: Snapshot | None, dt: float) -> Outcome | None:
    """Tell of steps that were taken, the last of ``dt`` [s]; how the run ended if it blew up."""
    if shown is not None and not shown.finite:
        return _blown_up(course, describe_infinite(course.simulation, shown, dt))
    if shown is not None and course.books.account.runs_away(shown.energies, course.control.t_end):
        return _blown_up(course, describe_runaway(course.simulation, shown, dt))
    course.report(dt)
    return None


def _why_pause(course: Course, limits: Limits, stop: StopRequest) -> str:
    """Why to stop here; empty to go on."""
    if course.control.done:
        return ""
    if stop.requested:
        return "interrupted"
    if course.books.stopwatch.elapsed >= limits.wall:
        return "the wall-clock limit is reached"
    return "the time asked for is reached" if course.state.t >= limits.until else ""


def _doubts(course: Course) -> tuple[str, ...]:
    """Why not to believe a finished run: the balance that it ends in, and models out of their limits."""
    unit = "" if isinstance(course.simulation.integrator, Static) else " s"
    short = (course.control.doubt,) if course.control.doubt else ()
    if (found := course.books.symmetry.found()) is not None:
        short = (*short, describe_symmetry(course.simulation, found))
    return (*short, *_balance(course), *course.books.validity.doubts(course.simulation.places, unit))


def _balance(course: Course) -> tuple[str, ...]:
    """Energy from nowhere at the end, more than an integrator may round; statics that would buckle."""
    model = course.simulation.model
    if not model.mass.any():
        told = describe_unstable(course.simulation, course.state)
        return (told,) if course.stepper.stability.unstable(course.state) else ()
    entries = course.books.account.measure(course.state)
    share = course.books.account.growth(entries, course.control.t_end)
    return (describe_growth(course.simulation, entries["error"], share),) if share > _GROWTH else ()


def _failed(course: Course, failure: Failure) -> Outcome:
    """Give up where the last good step ended."""
    course.checkpoint()
    return _blown_up(course, failure)


def _blown_up(course: Course, failure: Failure) -> Outcome:
    """Give up at a state that nobody should go on from: the last checkpoint is an earlier one."""
    course.sink.event("failed", course.state.t, message=failure.message)
    return _ended(course, End.FAILED, failure)


def _ended(course: Course, end: End, why: Failure, doubts: tuple[str, ...] = ()) -> Outcome:
    """Say what came of the run."""
    singular = tuple(describe_singular(course.simulation, *found) for found in course.singular)
    ambiguity, touched = course.books.ambiguity, course.simulation.touched
    taken = (describe_ambiguity(course.simulation, ambiguity),) if ambiguity.steps else ()
    return Outcome(
        end=end,
        message=why.message,
        state=course.state,
        counters=course.counts,
        seconds=course.seconds,
        times=course.books.watched.times,
        watched=course.books.watched.values,
        doubts=(*singular, *taken, *doubts),
        remedy=why.remedy,
        penetration=None if touched is None else touched.deepest(course.state),
    )
