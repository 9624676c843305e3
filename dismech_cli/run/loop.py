"""The run: step, watch, write; cut steps that fail, stop when asked, resume where it stopped."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from enum import Enum
from typing import Protocol

import numpy as np

from ..arrays import FloatArray
from ..errors import LawError
from ..kinematics.rod_frames import FrameState
from ..model.state import State
from ..output.frame import Frame
from ..solve.status import Status
from ..solve.step import Stepper, StepResult
from .account import EnergyAccount
from .clock import Clock
from .failure import Attempt, describe_failure, describe_growth, describe_runaway
from .interrupt import StopRequest
from .observables.snapshot import Snapshot
from .observe import Observer
from .simulation import Simulation

Arrays = Mapping[str, FloatArray]

# A run that ends with more energy from nowhere than this share of its largest has an unstable step.
_GROWTH = 0.05


class End(Enum):
    """How a run ended."""

    DONE = "done"
    FAILED = "failed"
    INTERRUPTED = "interrupted"


@dataclass(frozen=True, slots=True)
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

    def checkpoint(self, arrays: Arrays, numbers: Mapping[str, int | float]) -> None:
        """Store what :func:`run` needs to go on."""

    def progress(self, progress: Progress) -> None:
        """Tell the user."""


@dataclass(frozen=True, slots=True)
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


@dataclass(frozen=True, slots=True)
class Outcome:
    """Result of a run.

    Attributes:
        end: How it ended.
        message: One or more lines for the user; empty when done.
        state: Last accepted state.
        counters: Steps, iterations, cuts, frames.
        seconds: Wall time by phase [s].
        times: Times of the watched values [s].
        watched: Values of the watched probes after every step.
        doubts: What makes a finished run doubtful, a line each.
    """

    end: End
    message: str
    state: State
    counters: Mapping[str, int]
    seconds: Mapping[str, float]
    times: FloatArray
    watched: Mapping[str, FloatArray]
    doubts: tuple[str, ...] = ()


@dataclass
class _Counters:
    steps: int = 0
    iterations: int = 0
    cuts: int = 0
    frames: int = 0
    analyses: int = 0


@dataclass
class _Loop:
    """Mutable bookkeeping of one run."""

    simulation: Simulation
    stepper: Stepper
    account: EnergyAccount
    observer: Observer
    sink: Sink
    clock: Clock = field(default_factory=Clock)
    counters: _Counters = field(default_factory=_Counters)
    seconds: dict[str, float] = field(
        default_factory=lambda: dict.fromkeys(("solve", "observe", "write"), 0.0)
    )
    since_frame: int = 0
    wall_before: float = 0.0
    began: float = field(default_factory=time.monotonic)

    @property
    def elapsed(self) -> float:
        return time.monotonic() - self.began

    @property
    def wall(self) -> float:
        return self.wall_before + self.elapsed


def run(
    simulation: Simulation,
    sink: Sink,
    *,
    limits: Limits = Limits(),
    stop: StopRequest | None = None,
    resume_from: tuple[Arrays, Mapping[str, int | float]] | None = None,
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
    stepper = Stepper(simulation.model, simulation.integrator, simulation.newton, simulation.linear_solver)
    account = EnergyAccount(simulation.model, simulation.roles, simulation.initial_velocity)
    account.bind(stepper.system, 0.0)
    loop = _Loop(simulation, stepper, account, Observer(simulation, stepper, account), sink)
    if resume_from is None:
        state = _prepared(loop, stepper.rest_state(simulation.initial_velocity))
        account.start(state)
        _emit(loop, state, _at_rest(state), 0.0)
    else:
        state = _restore(loop, *resume_from)
    announce(f"linear solver: {stepper.system.solver.name}, {stepper.system.pattern.m} free DOFs")
    return _advance(loop, state, limits, stop or StopRequest())


def _advance(loop: _Loop, state: State, limits: Limits, stop: StopRequest) -> Outcome:
    grid, last = loop.simulation.grid, deque[Attempt](maxlen=5)
    t_end, saved = float(grid[-1]), time.monotonic()
    while not loop.clock.done(grid):
        now, target = state.t, loop.clock.target(grid)
        try:
            result = _step(loop, state, target)
        except LawError as error:
            return _failed(loop, state, str(error))
        state = result.state
        last.append((now, target, result))
        loop.counters.iterations += result.iterations
        loop.since_frame += result.iterations
        if result.status is not Status.CONVERGED:
            if loop.clock.level >= loop.simulation.max_cuts:
                return _failed(loop, state, describe_failure(loop.simulation, last))
            loop.clock = loop.clock.failed()
            loop.counters.cuts += 1
            loop.sink.event("step_cut", now, dt=target - now, status=result.status.name)
            continue
        loop.clock = loop.clock.succeeded()
        loop.counters.steps += 1
        frame = _emit(loop, state, result, target - now)
        if frame is not None and loop.account.runs_away(frame.energies, t_end):
            return _failed(
                loop, state, describe_runaway(loop.simulation, state.t, target - now, frame.energies)
            )
        loop.sink.progress(
            Progress(state.t, t_end, target - now, loop.counters.steps, loop.counters.iterations)
        )
        if _pause(loop, state, limits, stop):
            return _outcome(loop, state, End.INTERRUPTED, _why(loop, limits, stop))
        if time.monotonic() - saved >= limits.checkpoint_every:
            _checkpoint(loop, state)
            saved = time.monotonic()
    _checkpoint(loop, state)
    return replace(_outcome(loop, state, End.DONE, ""), doubts=_doubts(loop, state))


def _doubts(loop: _Loop, state: State) -> tuple[str, ...]:
    """Energy from nowhere at the end, more than an integrator may round."""
    entries = loop.account.measure(state)
    share = loop.account.growth(entries)
    return (describe_growth(loop.simulation, entries["error"], share),) if share > _GROWTH else ()


def _step(loop: _Loop, state: State, target: float) -> StepResult:
    """Step to ``target`` and book what the step did; where it fails, the result holds its start."""
    tick = time.perf_counter()
    state = _prepared(loop, state)
    result = loop.stepper.step(state, target - state.t)
    loop.seconds["solve"] += time.perf_counter() - tick
    if result.status is Status.CONVERGED:
        # the integrator adds dt, which may round
        after = result.state if result.state.t == target else replace(result.state, t=target)
        loop.account.advance(state, after)
        result = replace(result, state=after)
    return result


def _prepared(loop: _Loop, state: State) -> State:
    """Start a step: the account follows the stepper to other free DOFs."""
    analyses = loop.stepper.analyses
    state = loop.stepper.prepare(state)
    if loop.stepper.analyses != analyses:
        loop.account.bind(loop.stepper.system, state.t)
    return state


def _pause(loop: _Loop, state: State, limits: Limits, stop: StopRequest) -> bool:
    if loop.clock.done(loop.simulation.grid):
        return False
    return stop.requested or loop.elapsed >= limits.wall or state.t >= limits.until


def _why(loop: _Loop, limits: Limits, stop: StopRequest) -> str:
    if stop.requested:
        return "interrupted"
    return (
        "the wall-clock limit is reached" if loop.elapsed >= limits.wall else "the time asked for is reached"
    )


def _failed(loop: _Loop, state: State, message: str) -> Outcome:
    loop.sink.event("failed", state.t, message=message)
    return _outcome(loop, state, End.FAILED, message)


def _outcome(loop: _Loop, state: State, end: End, message: str) -> Outcome:
    if end is not End.DONE:
        _checkpoint(loop, state)
    loop.counters.analyses = loop.stepper.analyses
    return Outcome(
        end,
        message,
        state,
        vars(loop.counters),
        loop.seconds | {"total": loop.wall},
        np.array(loop.observer.times),
        {name: np.array(values) for name, values in loop.observer.watched.items()},
    )


def _at_rest(state: State) -> StepResult:
    return StepResult(state, Status.CONVERGED, 0, 0.0, np.zeros_like(state.q), -1)


def _emit(loop: _Loop, state: State, result: StepResult, dt: float) -> Snapshot | None:
    """Watch every state; write a frame when one is due, and return what it shows."""
    due = loop.counters.frames * loop.simulation.frame_every * (1.0 - 1e-12)
    framed = state.t >= due or loop.clock.done(loop.simulation.grid)
    if not framed and not loop.observer.watched:
        return None
    tick = time.perf_counter()
    snapshot = loop.observer.snapshot(state, result.residual)
    loop.observer.watch(snapshot)
    if not framed:
        loop.seconds["observe"] += time.perf_counter() - tick
        return None
    frame = loop.observer.frame(
        loop.counters.frames, snapshot, dt, loop.since_frame, result.residual_norm, loop.wall
    )
    tock = time.perf_counter()
    loop.seconds["observe"] += tock - tick
    loop.sink.frame(frame)
    loop.seconds["write"] += time.perf_counter() - tock
    loop.counters.frames += 1
    loop.since_frame = 0
    return snapshot


def _checkpoint(loop: _Loop, state: State) -> None:
    observer = loop.observer
    arrays = {
        "q": state.q,
        "v": state.v,
        "a": state.a,
        "watch.t": np.array(observer.times),
    }
    arrays |= {f.name: getattr(state.frames, f.name) for f in fields(FrameState)}
    arrays |= {f"watch.{name}": np.array(values) for name, values in observer.watched.items()}
    numbers: dict[str, int | float] = {"t": state.t, "since_frame": loop.since_frame, "wall": loop.wall}
    numbers |= {f"clock.{k}": getattr(loop.clock, k) for k in ("index", "part", "level")}
    numbers |= {f"count.{k}": v for k, v in vars(loop.counters).items()}
    numbers |= {f"account.{k}": v for k, v in loop.account.sums.items()}
    loop.sink.checkpoint(arrays, numbers)


def _restore(loop: _Loop, arrays: Arrays, numbers: Mapping[str, int | float]) -> State:
    frames = FrameState(**{f.name: arrays[f.name] for f in fields(FrameState)})
    state = State(float(numbers["t"]), arrays["q"], arrays["v"], arrays["a"], frames)
    loop.clock = Clock(*(int(numbers[f"clock.{k}"]) for k in ("index", "part", "level")))
    for k in vars(loop.counters):
        setattr(loop.counters, k, int(numbers[f"count.{k}"]))
    loop.account.sums |= {k: float(numbers[f"account.{k}"]) for k in loop.account.sums}
    loop.since_frame, loop.wall_before = int(numbers["since_frame"]), float(numbers["wall"])
    loop.observer.times = arrays["watch.t"].tolist()
    loop.observer.watched = {name: arrays[f"watch.{name}"].tolist() for name in loop.observer.watched}
    return _prepared(loop, state)
