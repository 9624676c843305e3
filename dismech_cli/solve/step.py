"""One time step: all stages of the integrator, from one frozen state to the next."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Protocol, TypeAlias

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..kinematics.motion import Since, held_dofs, held_span
from ..kinematics.rod_frames import FrameState
from ..model.model import Model
from ..model.state import State
from .accelerations import LENGTH, balanced, rescaled, rubbed
from .integrators import Integrator
from .kept import Kept
from .newton import solve_stage
from .plain import Plain, Steps
from .predictor import Predictor
from .problem import NewtonSettings, StageProblem
from .result import NewtonResult
from .second_guess import SLOW, confirmed
from .stability import Stability
from .stage import Stage, mean_acceleration
from .status import Status
from .step_result import StepResult
from .system import System


@frozen
class _Binding:
    """The model bound to the DOFs that are free for a while.

    Attributes:
        since: Time [s] from which on they are.
        until: Time [s] at which a motion lets go.
        held: DOFs that follow a motion.
        led: Those and the massless ones.
        system: The bound model.
        stability: Of its states.
        plain: Takes the steps that a compiled function can take.
    """

    since: float
    until: float
    held: IntArray
    led: IntArray
    system: System
    stability: Stability
    plain: Plain


Solve: TypeAlias = Callable[[StageProblem, FloatArray], NewtonResult]
"""Solves a stage from a guess."""


class Advance(Protocol):
    """How a step goes on from a state that is prepared for it."""

    def __call__(self, stepper: Stepper, start: State, dt: float, settings: NewtonSettings) -> StepResult:
        """The step of length ``dt``."""


class Stepper:
    """Steps a model; keeps what does not change from step to step."""

    def __init__(
        self,
        model: Model,
        integrator: Integrator,
        settings: NewtonSettings,
        solver: str,
        advance: Advance | None = None,
    ) -> None:
        """Bind the model to the DOFs that are free at t = 0.

        Args:
            model: The semi-discrete system.
            integrator: Time integrator.
            settings: Newton's stopping rule.
            solver: Key of ``LINEAR_SOLVERS``, or ``"auto"``.
            advance: How steps go; through the stages of the integrator by default.
        """
        self.model = model
        self.integrator = integrator
        moves = bool(model.mass.any())
        self._settings = replace(settings, slow=SLOW) if moves else settings
        self._hasty = replace(self._settings, max_iterations=min(settings.patience, settings.max_iterations))
        self._wanted = solver
        self.predictor = Predictor(model)
        self._massless = (model.mass == 0.0) & moves
        self._advance = through_stages if advance is None else advance
        self._analyses, self._changing_seconds = 0, 0.0
        self._binding = self._bound(0.0)

    @property
    def system(self) -> System:
        """The model bound to the DOFs that are free now."""
        return self._binding.system

    @property
    def stability(self) -> Stability:
        """Of states, with the DOFs that are free now."""
        return self._binding.stability

    @property
    def analyses(self) -> int:
        """How often a pattern has been analysed."""
        return self._analyses + self.system.analyses

    @property
    def changing_seconds(self) -> float:
        """Wall time that what comes and goes took so far, such as contact [s]."""
        return self._changing_seconds + self.system.changing_seconds

    def rest_state(self, velocity: FloatArray | None = None, t: float = 0.0) -> State:
        """State at rest in the rest shape, or moving with ``velocity`` (n,)."""
        q = self.model.rest.copy()
        v = np.zeros_like(q) if velocity is None else velocity.copy()
        return State(t, q, v, np.zeros_like(q), self.model.frames.rest(q))

    def prepare(self, state: State) -> State:
        """Bind to the DOFs that are free from ``state`` on.

        At the start and where a motion lets go the acceleration jumps: it is made consistent with
        the balance of forces.
        """
        if not self._binding.since <= state.t < self._binding.until:
            self._analyses += self.system.analyses
            self._changing_seconds += self.system.changing_seconds
            self._binding = self._bound(state.t)
        self.system.recall(state)
        if self._jumps(state) and self.integrator.needs_acceleration:
            return replace(state, a=balanced(self.system, state))
        return state

    def step(self, start: State, dt: float) -> StepResult:
        """Advance ``start`` (already prepared) by ``dt``."""
        return self._advanced(start, dt, self._settings)

    def attempt(self, start: State, dt: float) -> StepResult:
        """The same, but give up soon, and where a shorter step may take another way.

        Slow convergence is how a wrong root announces itself: one that was slow to come is looked for from
        elsewhere too. So does a tangent that is not positive
        definite at the solution: it is one of several, among them the motion that a step too long for
        something that buckles strides over. Short steps have one solution. Statics has no such steps:
        there an unstable balance is one. What stays deeper in something than it may is held more easily in
        a shorter step.
        """
        result = self._advanced(start, dt, self._hasty)
        if result.unsettled:
            return replace(result, state=start, status=Status.UNSETTLED)
        if result.ambiguous:
            return replace(result, state=start, status=Status.AMBIGUOUS)
        return result

    def _advanced(self, start: State, dt: float, settings: NewtonSettings) -> StepResult:
        """A step, taken again as long as what comes and goes in it asks for that."""
        system = self.system
        system.recall(start)
        if not self.model.changing:
            return self._advance(self, start, dt, settings)
        if not self.integrator.needs_acceleration:
            system.begin_step(start, dt)
        elif self._jumps(start):
            system.begin_step(start, dt)
            start = rubbed(system, self.predictor, start, dt, settings)
        else:
            start = rescaled(system, start, dt)
            system.begin_step(start, dt)
        result = self._advance(self, start, dt, settings)
        spent = result.iterations
        while result.status is Status.CONVERGED and not system.settle(result.state):
            # worth all patience: what fails now ends a promise
            again = self._advance(self, start, dt, self._settings)
            spent += again.iterations
            if again.status is not Status.CONVERGED:
                # better unsettled than nowhere, if no shorter step helps
                system.take_back()
                result = replace(result, unsettled=True)
                break
            result = again
        if result.status is not Status.CONVERGED:
            return replace(result, iterations=spent)
        memory, put_in = system.left(start)
        kept = {**result.state.memory, **memory, LENGTH: np.array([dt])}
        return replace(result, state=replace(result.state, memory=kept), iterations=spent, put_in=put_in)

    @property
    def balanced_ends(self) -> bool:
        """Whether steps end where their last stages are in balance."""
        return self._binding.plain.balanced_ends

    def leap(self, start: State, targets: Sequence[float]) -> Steps | None:
        """Steps to times [s] as by :meth:`attempt`, as far as they are plain, from a prepared state."""
        if self._advance is not through_stages:
            return None
        times = (start.t, *targets)
        return self.plain(start, times, [end - begin for begin, end in pairwise(times)], self._hasty)

    def plain(
        self, start: State, times: Sequence[float], lengths: Sequence[float], settings: NewtonSettings
    ) -> Steps | None:
        """Steps one after another as :meth:`.plain.Plain.take` takes them; None if the first is not plain."""
        return self._binding.plain.take(start, times, lengths, settings)

    def _bound(self, t: float) -> _Binding:
        motions = self.model.motions
        since, until = held_span(motions, t)
        held = held_dofs(motions, self.model.dofs.n, t)
        system = System(self.model, ~held, self._wanted)
        led = np.flatnonzero(held | self._massless)
        plain = Plain(system, self.integrator, self.predictor, held, led, t)
        return _Binding(since, until, np.flatnonzero(held), led, system, Stability(system), plain)

    @property
    def held(self) -> IntArray:
        """DOFs that follow a motion now, shape (K,)."""
        return self._binding.held

    def accept(self, stage: Stage, before: State, q: FloatArray, frames: FrameState | None = None) -> State:
        """The state at the end of a stage, with its frames where they are known."""
        v, a = stage.finish(q)
        # Held DOFs move on a given path, massless ones (mid-edge normals) go where balance puts them:
        # their difference quotient is free of the integrator's ringing.
        led = self._binding.led
        v[led] = stage.mean_velocity(before, q, led)
        a[led] = 0.0
        if frames is None:
            frames = self.model.frames.transport(before.frames, q).state
        return State(stage.t_end, q, v, a, frames, before.inputs, before.memory)

    def _jumps(self, state: State) -> bool:
        """Whether the acceleration jumps at a state: the start, and where a motion lets go."""
        return state.t in (0.0, self._binding.since)


def through_stages(
    stepper: Stepper, start: State, dt: float, settings: NewtonSettings, solve: Solve = solve_stage
) -> StepResult:
    """All stages of the integrator, each by a solver for its balance."""
    plain = stepper.plain(start, (start.t, start.t + dt), (dt,), settings)
    if plain is not None:
        return plain.result(0)
    system, latest, iterations, ambiguous = stepper.system, start, 0, False
    share, trail, kept = stepper.predictor.share(start), [start], Kept()
    for index in range(stepper.integrator.stages):
        stage = stepper.integrator.stage(index, start, latest, dt)
        ahead = StageProblem(system, stage, latest.frames, settings, kept)
        since = Since(latest.t, latest.q, latest.frames)
        for guess in stepper.predictor.guesses(ahead, since, share):
            problem = StageProblem(system, stage, latest.frames, settings, kept)
            result = solve(problem, problem.reachable(latest.q, guess))
            iterations += result.iterations
            if result.status is Status.CONVERGED:
                break
        iterations += ahead.spent
        if result.status is not Status.CONVERGED:
            return StepResult(
                start, result.status, iterations, result.residual_norm, result.residual, result.worst
            )
        ambiguous = ambiguous or (result.indefinite and stage.weights.a > 0.0)
        if result.iterations - problem.turned >= settings.slow:
            again = StageProblem(system, stage, latest.frames, settings, kept)
            still = again.reachable(latest.q, stepper.predictor.still(again, since))
            sure, spent = confirmed(again, solve, latest.q, still, result)
            iterations += spent
            ambiguous = ambiguous or not sure
        end = stepper.accept(stage, latest, result.q, result.frames)
        latest = stepper.predictor.learnt(stage, end)
        trail.append(latest)
    # What holds a mass also moves it, along its path and not as the integrator would have it.
    held, mass = stepper.held, stepper.model.mass[stepper.held]
    inertia = mass * stage.acceleration_of(result.q, held)
    reactions = result.residual[held] - inertia if stage.balanced_end else None
    result.residual[held] += mass * mean_acceleration(start, latest, dt, held) - inertia
    return StepResult(
        latest,
        Status.CONVERGED,
        iterations,
        result.residual_norm,
        result.residual,
        -1,
        ambiguous,
        trail=tuple(trail),
        reactions=reactions,
        # those of shells are of frames at the start, too
        auxiliary=None if stepper.model.frames.tables is None else result.auxiliary,
    )
