"""Newton's method: full steps first, an energy line search only where they fail.

The residual norm is never a merit function: stiff stretching makes it rise although the step is
right. Convergence is decided on the residual alone, relative to the forces that act in the model
and above the round-off of positions.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isfinite, sqrt

import numpy as np

from ..arrays import FloatArray, IntArray
from ..kinematics.rod_frames import FrameState
from .integrators import Stage
from .linear.solver import FactorizationError, LinearSolver, solve_updated
from .pattern import SparsityPattern
from .status import Status
from .system import Linearized, System
from .tangents import Factorize, exact

# Full steps get this many iterations before the line search takes over from the predictor.
_FULL_STEPS = 20
# A step this many times the size of the model means that nothing resists it.
_RUNAWAY = 1e6
# Armijo's constant and the shortest step of the energy line search.
_ARMIJO, _SHORTEST = 1e-4, 2.0**-20
# First share by which the diagonal of a tangent without a descent direction is raised.
_LEAST_SHIFT = 1e-9


@dataclass(frozen=True, slots=True)
class NewtonSettings:
    """Stopping rule.

    Attributes:
        tolerance: Residual relative to the largest force in the model [1].
        max_iterations: Factorisations before giving up, of full steps and line search together.
        factorize: Chooses the tangent, an entry of ``TANGENTS``.
    """

    tolerance: float = 1e-8
    max_iterations: int = 100
    factorize: Factorize = exact


@dataclass(frozen=True, slots=True)
class NewtonResult:
    """Outcome of one nonlinear solve.

    Attributes:
        q: Solution, or the last iterate.
        residual: Full residual (n,) at ``q``: reactions on held DOFs.
        status: How it ended.
        iterations: Factorisations done, those of shifted and of projected tangents included.
        residual_norm: Largest free residual [N].
        worst: Global index of the DOF with the largest residual, or -1.
    """

    q: FloatArray
    residual: FloatArray
    status: Status
    iterations: int
    residual_norm: float
    worst: int


class _Exhausted(Exception):
    """The factorisations allowed are used up."""


class _Budget:
    """A linear solver that counts its factorisations, whoever asks for them, and ends at a limit.

    Attributes:
        name: That of the solver.
        spent: Factorisations done.
    """

    def __init__(self, solver: LinearSolver, limit: int) -> None:
        self._solver = solver
        self._limit = limit
        self.name = solver.name
        self.spent = 0

    @property
    def used_up(self) -> bool:
        """Whether no factorisation is left."""
        return self.spent == self._limit

    @property
    def indefinite(self) -> bool:
        """As the solver says."""
        return self._solver.indefinite

    def analyze(self, pattern: SparsityPattern) -> None:
        """Nothing to count."""
        self._solver.analyze(pattern)

    def factorize(self, values: FloatArray) -> None:
        """Factorise; raise :class:`_Exhausted` where the limit is reached."""
        if self.used_up:
            raise _Exhausted
        self.spent += 1
        self._solver.factorize(values)

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Solve with the last factors."""
        return self._solver.solve(rhs)


def solve_stage(
    system: System,
    solver: LinearSolver,
    stage: Stage,
    guess: FloatArray,
    stored: FrameState,
    settings: NewtonSettings,
) -> NewtonResult:
    """Solve one stage from ``guess`` (prescribed values already in place)."""
    budget = _Budget(solver, settings.max_iterations)
    with np.errstate(all="ignore"):
        result = _full_steps(system, budget, stage, guess, stored, settings)
        if result.status is Status.CONVERGED or budget.used_up:
            return result
        retry = _line_search(system, budget, stage, guess, stored, settings)
    # The retry shifts the diagonal and cannot see that the tangent was singular: keep that finding.
    singular = result.status is Status.FACTORIZATION_FAILED and retry.status is not Status.CONVERGED
    return replace(retry, status=result.status) if singular else retry


def _full_steps(
    system: System,
    budget: _Budget,
    stage: Stage,
    guess: FloatArray,
    stored: FrameState,
    settings: NewtonSettings,
) -> NewtonResult:
    q = guess.copy()
    free = system.pattern.free
    floor, settled = 0.0, False
    for iterations in range(_FULL_STEPS + 1):
        now = system.linearize(stage, q, stored)
        if iterations == 0:
            floor = system.round_off(now.values, q)
        rhs = -now.residual[free]
        size = _size(rhs, system)
        if not isfinite(floor + sum(size)):
            return _failed(q, now.residual, free, Status.NOT_FINITE, budget.spent)
        # One step at least, and one more from where rounding of stiff axial forces hides the rest:
        # soft directions, whose forces are far smaller, are solved by it too. A guess taken as it is
        # would let slow motion creep to a halt short of its rest.
        at_floor = _small(size, now, system, settings.tolerance, floor)
        met = iterations > 0 and _small(size, now, system, settings.tolerance, 0.0)
        if sum(size) == 0.0 or (at_floor and (settled or met)):
            return _done(q, now.residual, free, budget.spent)
        settled = at_floor
        if iterations == _FULL_STEPS:
            break
        try:
            settings.factorize(system, budget, stage, q, stored, now)
            step = solve_updated(budget, now.columns, now.rows, rhs)
        except _Exhausted:
            break
        except FactorizationError:
            return _failed(q, now.residual, free, Status.FACTORIZATION_FAILED, budget.spent)
        moved, _ = _size(step, system)
        if not moved <= _RUNAWAY * system.extent:
            status = Status.FACTORIZATION_FAILED if isfinite(moved) else Status.NOT_FINITE
            return _failed(q, now.residual, free, status, budget.spent)
        q[free] += step
    return _failed(q, now.residual, free, Status.MAX_ITERATIONS, budget.spent)


def _line_search(
    system: System,
    budget: _Budget,
    stage: Stage,
    guess: FloatArray,
    stored: FrameState,
    settings: NewtonSettings,
) -> NewtonResult:
    """Newton with descent directions on the stage's potential and Armijo backtracking."""
    q = guess.copy()
    free = system.pattern.free
    now = system.linearize(stage, q, stored)
    floor = system.round_off(now.values, q)
    shift = 0.0
    while True:
        gradient = now.residual[free]
        size = _size(gradient, system)
        if not isfinite(floor + sum(size)):
            return _failed(q, now.residual, free, Status.NOT_FINITE, budget.spent)
        if _small(size, now, system, settings.tolerance, floor):
            return _done(q, now.residual, free, budget.spent)
        try:
            step, shift = _descent(system, budget, stage, q, stored, settings, now, gradient, shift)
        except _Exhausted:
            return _failed(q, now.residual, free, Status.MAX_ITERATIONS, budget.spent)
        if step is None:
            return _failed(q, now.residual, free, Status.FACTORIZATION_FAILED, budget.spent)
        # A string of a rod bends at once over many times its length: let it fall a length at a time.
        moved, _ = _size(step, system)
        step *= min(1.0, system.extent / moved) if moved > 0.0 else 1.0
        length = _backtrack(system, stage, q, stored, step, gradient)
        if length == 0.0:
            return _failed(q, now.residual, free, Status.LINE_SEARCH_FAILED, budget.spent)
        q[free] += length * step
        now = system.linearize(stage, q, stored)


def _descent(
    system: System,
    solver: LinearSolver,
    stage: Stage,
    q: FloatArray,
    stored: FrameState,
    settings: NewtonSettings,
    now: Linearized,
    gradient: FloatArray,
    shift: float,
) -> tuple[FloatArray | None, float]:
    """Newton's step if it goes down the slope, or with the diagonal raised until it does; the next shift."""
    try:
        values = settings.factorize(system, solver, stage, q, stored, now)
        step = _downhill(solver, gradient) if shift == 0.0 else None
    except FactorizationError:
        values, step = now.values, None
    if step is not None:
        return step, 0.0
    return _shifted(system, solver, values, gradient, shift or _LEAST_SHIFT)


def _downhill(solver: LinearSolver, gradient: FloatArray) -> FloatArray | None:
    """Newton's step with the last factors, if it goes down the slope."""
    step = solver.solve(-gradient)
    return step if np.isfinite(step).all() and float(step @ gradient) < 0.0 else None


def _shifted(
    system: System, solver: LinearSolver, values: FloatArray, gradient: FloatArray, shift: float
) -> tuple[FloatArray | None, float]:
    """Direction down the slope, the diagonal raised as little as needed; the next shift."""
    diagonal = system.pattern.diagonal
    size = np.abs(values[diagonal])
    base = values[diagonal].copy()
    for _ in range(24):
        values[diagonal] = base + shift * size
        try:
            solver.factorize(values)
            step = _downhill(solver, gradient)
        except FactorizationError:
            step = None
        if step is not None:
            # a shift that was needed is tried ten times smaller at the next iterate
            return step, (0.1 * shift if shift > 0.1 * _LEAST_SHIFT else 0.0)
        shift = 10.0 * shift
    return None, shift


def _backtrack(
    system: System, stage: Stage, q: FloatArray, stored: FrameState, step: FloatArray, gradient: FloatArray
) -> float:
    """Armijo step length on the potential; work of other forces by the trapezoidal rule."""
    free, weight = system.pattern.free, stage.weights.q
    slope = float(step @ gradient)
    energy0, rest0 = system.potential(stage, q, stored)
    work0 = float(step @ rest0[free])
    length = 1.0
    while length >= _SHORTEST:
        trial = q.copy()
        trial[free] += length * step
        energy, rest = system.potential(stage, trial, stored)
        change = (energy - energy0) / weight + 0.5 * length * (work0 + float(step @ rest[free]))
        # round-off of the energies hides changes below this
        noise = 1e-14 * (abs(energy) + abs(energy0)) / weight
        if change <= _ARMIJO * length * slope + noise:
            return length
        length *= 0.5
    return 0.0


def _size(x: FloatArray, system: System) -> tuple[float, float]:
    """Euclidean norms of the entries at positions and at angles of a vector in matrix order."""
    squares = x * x
    return sqrt(squares @ system.at_node), sqrt(squares @ system.at_angle)


def _small(
    size: tuple[float, float], now: Linearized, system: System, tolerance: float, floor: float
) -> bool:
    """Whether a free residual of this size is small against the model's forces, or within ``floor`` [N]."""
    force, moment = size
    length = system.model.length
    largest = max(now.moment, now.force * length)
    return force <= tolerance * now.force + floor and moment <= tolerance * largest + floor * length


def _done(q: FloatArray, residual: FloatArray, free: IntArray, iterations: int) -> NewtonResult:
    return NewtonResult(
        q, residual.copy(), Status.CONVERGED, iterations, float(np.abs(residual[free]).max(initial=0.0)), -1
    )


def _failed(
    q: FloatArray,
    residual: FloatArray,
    free: IntArray,
    status: Status,
    iterations: int,
) -> NewtonResult:
    r = np.abs(residual[free])
    worst = int(free[int(np.argmax(np.where(np.isfinite(r), r, np.inf)))]) if r.size else -1
    return NewtonResult(q, residual.copy(), status, iterations, float(r.max(initial=0.0)), worst)
