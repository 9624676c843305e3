"""Newton's method: full steps first, an energy line search only where they fail.

The residual norm is never a merit function: stiff stretching makes it rise although the step is
right. Convergence is decided on the residual alone, relative to the forces that act in the model
and above the round-off of positions.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite, sqrt

import numpy as np

from ..arrays import FloatArray, IntArray
from ..model.frames import FrameState
from .integrators import Stage
from .linear import FactorizationError, LinearSolver, solve_updated
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
        max_iterations: Iterations before giving up.
        factorize: Chooses the tangent, an entry of ``TANGENTS``.
    """

    tolerance: float = 1e-8
    max_iterations: int = 50
    factorize: Factorize = exact


@dataclass(frozen=True, slots=True)
class NewtonResult:
    """Outcome of one nonlinear solve.

    Attributes:
        q: Solution, or the last iterate.
        residual: Full residual (n,) at ``q``: reactions on held DOFs.
        status: How it ended.
        iterations: Linear solves done.
        residual_norm: Largest free residual [N].
        worst: Global index of the DOF with the largest residual, or -1.
    """

    q: FloatArray
    residual: FloatArray
    status: Status
    iterations: int
    residual_norm: float
    worst: int


def solve_stage(
    system: System,
    solver: LinearSolver,
    stage: Stage,
    guess: FloatArray,
    stored: FrameState,
    settings: NewtonSettings,
) -> NewtonResult:
    """Solve one stage from ``guess`` (prescribed values already in place)."""
    with np.errstate(all="ignore"):
        result = _full_steps(system, solver, stage, guess, stored, settings)
        if result.status is Status.CONVERGED:
            return result
        retry = _line_search(system, solver, stage, guess, stored, settings)
    # The retry shifts the diagonal and cannot see that the tangent was singular: keep that finding.
    singular = result.status is Status.FACTORIZATION_FAILED and retry.status is not Status.CONVERGED
    return NewtonResult(
        retry.q,
        retry.residual,
        result.status if singular else retry.status,
        result.iterations + retry.iterations,
        retry.residual_norm,
        retry.worst,
    )


def _full_steps(
    system: System,
    solver: LinearSolver,
    stage: Stage,
    guess: FloatArray,
    stored: FrameState,
    settings: NewtonSettings,
) -> NewtonResult:
    q = guess.copy()
    free = system.pattern.free
    floor, settled = 0.0, False
    for iterations in range(min(settings.max_iterations, _FULL_STEPS) + 1):
        now = system.linearize(stage, q, stored)
        if iterations == 0:
            floor = system.round_off(now.values, q)
        rhs = -now.residual[free]
        size = _size(rhs, system)
        if not isfinite(floor + sum(size)):
            return _failed(q, now.residual, free, Status.NOT_FINITE, iterations)
        # One step at least, and one more from where rounding of stiff axial forces hides the rest:
        # soft directions, whose forces are far smaller, are solved by it too. A guess taken as it is
        # would let slow motion creep to a halt short of its rest.
        at_floor = _small(size, now, system, settings.tolerance, floor)
        met = iterations > 0 and _small(size, now, system, settings.tolerance, 0.0)
        if sum(size) == 0.0 or (at_floor and (settled or met)):
            return _done(q, now.residual, free, iterations)
        settled = at_floor
        try:
            settings.factorize(system, solver, stage, q, stored, now)
            step = solve_updated(solver, now.columns, now.rows, rhs)
        except FactorizationError:
            return _failed(q, now.residual, free, Status.FACTORIZATION_FAILED, iterations)
        moved, _ = _size(step, system)
        if not moved <= _RUNAWAY * system.extent:
            status = Status.FACTORIZATION_FAILED if isfinite(moved) else Status.NOT_FINITE
            return _failed(q, now.residual, free, status, iterations + 1)
        q[free] += step
    return _failed(q, now.residual, free, Status.MAX_ITERATIONS, iterations)


def _line_search(
    system: System,
    solver: LinearSolver,
    stage: Stage,
    guess: FloatArray,
    stored: FrameState,
    settings: NewtonSettings,
) -> NewtonResult:
    """Newton with descent directions on the stage's potential and Armijo backtracking.

    Where the tangent gives no descent direction, its diagonal is raised until it does.
    """
    q = guess.copy()
    free = system.pattern.free
    iterations, shift, floor = 0, 0.0, 0.0
    for _ in range(settings.max_iterations):
        now = system.linearize(stage, q, stored)
        if iterations == 0:
            floor = system.round_off(now.values, q)
        gradient = now.residual[free]
        size = _size(gradient, system)
        if not isfinite(floor + sum(size)):
            return _failed(q, now.residual, free, Status.NOT_FINITE, iterations)
        if _small(size, now, system, settings.tolerance, floor):
            return _done(q, now.residual, free, iterations)
        step = None
        try:
            values = settings.factorize(system, solver, stage, q, stored, now)
            iterations += 1
            if shift == 0.0:
                step = _downhill(solver, gradient)
        except FactorizationError:
            values = now.values
        if step is None:
            step, shift, solves = _shifted(system, solver, values, gradient, shift or _LEAST_SHIFT)
            iterations += solves
        if step is None:
            return _failed(q, now.residual, free, Status.FACTORIZATION_FAILED, iterations)
        # A string of a rod bends at once over many times its length: let it fall a length at a time.
        moved, _ = _size(step, system)
        step *= min(1.0, system.extent / moved) if moved > 0.0 else 1.0
        length = _backtrack(system, stage, q, stored, step, gradient)
        if length == 0.0:
            return _failed(q, now.residual, free, Status.LINE_SEARCH_FAILED, iterations)
        q[free] += length * step
    return _failed(q, now.residual, free, Status.MAX_ITERATIONS, iterations)


def _downhill(solver: LinearSolver, gradient: FloatArray) -> FloatArray | None:
    """Newton's step with the last factors, if it goes down the slope."""
    step = solver.solve(-gradient)
    return step if np.isfinite(step).all() and float(step @ gradient) < 0.0 else None


def _shifted(
    system: System, solver: LinearSolver, values: FloatArray, gradient: FloatArray, shift: float
) -> tuple[FloatArray | None, float, int]:
    """Direction down the slope, the diagonal raised as little as needed; the next shift; solves done."""
    diagonal = system.pattern.diagonal
    size = np.abs(values[diagonal])
    base = values[diagonal].copy()
    for attempt in range(24):
        values[diagonal] = base + shift * size
        try:
            solver.factorize(values)
            step = _downhill(solver, gradient)
        except FactorizationError:
            step = None
        if step is not None:
            # a shift that was needed is tried ten times smaller at the next iterate
            return step, (0.1 * shift if shift > 0.1 * _LEAST_SHIFT else 0.0), attempt + 1
        shift = 10.0 * shift
    return None, shift, 24


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
