"""One time step: all stages of the integrator, from one frozen state to the next."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

import numpy as np

from ..arrays import FloatArray, IntArray
from ..kinematics.motion import held_dofs, held_span, prescribe
from ..model.model import Model
from ..model.state import State
from .integrators import Integrator, Stage, Weights
from .linear.choice import LINEAR_SOLVERS, choose_solver
from .linear.solver import LinearSolver
from .linear.stability import CountNegative, negative_eigenvalues_on
from .newton import NewtonSettings, solve_stage
from .status import Status
from .system import System

_AT_STATE = Weights(q=1.0, v=0.0, a=0.0)


@dataclass(frozen=True, slots=True)
class StepResult:
    """What a step gives back.

    Attributes:
        state: The new state; the old one untouched if the step failed.
        status: How it ended.
        iterations: Linear solves.
        residual_norm: Largest free residual [N] of the last stage.
        residual: Residual (n,) of the last stage: reactions on held DOFs.
        worst: DOF with the largest residual of a failed step, or -1.
    """

    state: State
    status: Status
    iterations: int
    residual_norm: float
    residual: FloatArray
    worst: int


class Stepper:
    """Steps a model; keeps what does not change from step to step.

    Attributes:
        system: The model bound to the DOFs that are free.
        solver: Its linear solver.
        analyses: How often the model was bound.
    """

    def __init__(self, model: Model, integrator: Integrator, settings: NewtonSettings, solver: str) -> None:
        """Bind the model.

        Args:
            model: The semi-discrete system.
            integrator: Time integrator.
            settings: Newton's stopping rule.
            solver: Key of ``LINEAR_SOLVERS``, or ``"auto"``.
        """
        self.model = model
        self.integrator = integrator
        self._settings = settings
        self._wanted = solver
        self._massless = (model.mass == 0.0) & model.mass.any()
        self._since, self._until = inf, inf
        self._led: IntArray
        self._held: IntArray
        self.system: System
        self.solver: LinearSolver
        self._count_negative: CountNegative | None = None
        self.analyses = 0

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
        if not self._since <= state.t < self._until:
            self._bind(state.t)
        jumps = state.t in (0.0, self._since)
        if jumps and self.integrator.needs_acceleration:
            return replace(state, a=self._consistent_acceleration(state))
        return state

    def step(self, start: State, dt: float) -> StepResult:
        """Advance ``start`` (already prepared) by ``dt``."""
        latest, iterations = start, 0
        for index in range(self.integrator.stages):
            stage = self.integrator.stage(index, start, latest, dt)
            guess = stage.predictor.copy()
            prescribe(self.model.motions, guess, stage.t_end)
            result = solve_stage(self.system, self.solver, stage, guess, latest.frames, self._settings)
            iterations += result.iterations
            if result.status is not Status.CONVERGED:
                return StepResult(
                    start, result.status, iterations, result.residual_norm, result.residual, result.worst
                )
            latest = self._accept(stage, latest, result.q)
        # What holds a mass also moves it, along its path and not as the integrator would have it.
        held = self._held
        wanted = (latest.v[held] - start.v[held]) / dt
        inertia = self.model.mass[held] * (wanted - stage.acceleration(result.q)[held])
        result.residual[held] += inertia
        return StepResult(latest, Status.CONVERGED, iterations, result.residual_norm, result.residual, -1)

    def negative_eigenvalues(self, state: State) -> int:
        """Negative eigenvalues of the stiffness matrix at a static state."""
        stage = self.integrator.stage(0, state, state, 0.0)
        values = self.system.linearize(stage, state.q, state.frames).values
        if self._count_negative is None:  # few scenes ask, and MKL takes long to load
            self._count_negative = negative_eigenvalues_on(self.system.pattern)
        return self._count_negative(values)

    def _bind(self, t: float) -> None:
        motions = self.model.motions
        self._since, self._until = held_span(motions, t)
        held = held_dofs(motions, self.model.dofs.n, t)
        self._held, self._led = np.flatnonzero(held), np.flatnonzero(held | self._massless)
        self.system = System(self.model, ~held)
        name = choose_solver(self.system.pattern) if self._wanted == "auto" else self._wanted
        self.solver = LINEAR_SOLVERS[name]()
        self.solver.analyze(self.system.pattern)
        self._count_negative = None
        self.analyses += 1

    def _accept(self, stage: Stage, before: State, q: FloatArray) -> State:
        v, a = stage.finish(q)
        # Held DOFs move on a given path, massless ones (mid-edge normals) go where balance puts them:
        # their difference quotient is free of the integrator's ringing.
        led = self._led
        v[led] = (q[led] - before.q[led]) / (stage.t_end - before.t)
        a[led] = 0.0
        frames = self.model.frames.transport(before.frames, q).state
        return State(stage.t_end, q, v, a, frames)

    def _consistent_acceleration(self, state: State) -> FloatArray:
        """A = -M^-1 r(q, v) on the free DOFs: a wrong start costs Newmark its second order."""
        n = len(state.q)
        zero = np.zeros(n)
        stage = Stage(
            t_stage=state.t,
            t_end=state.t,
            predictor=state.q,
            weights=_AT_STATE,
            q0=zero,
            v0=state.v,
            a0=zero,
            v_end=(0.0, zero),
            a_end=(0.0, zero),
        )
        r = self.system.linearize(stage, state.q, state.frames).residual
        free = self.system.pattern.free
        movable = free[self.model.mass[free] > 0.0]
        a = np.zeros(n)
        a[movable] = -r[movable] / self.model.mass[movable]
        return a
