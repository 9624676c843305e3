"""Newton with descent directions on the stage's potential and Armijo backtracking."""

from __future__ import annotations

from math import inf, isfinite

import numpy as np

from ..arrays import FloatArray
from .assembly import Linearized
from .linear.factors import FactorizationError, Factors
from .problem import ExhaustedError, StageProblem
from .result import NewtonResult, done, failed
from .status import Status

# Armijo's constant and the shortest step.
_ARMIJO, _SHORTEST = 1e-4, 2.0**-20
# First share by which the diagonal of a tangent without a descent direction is raised.
_LEAST_SHIFT = 1e-9


def search(problem: StageProblem, guess: FloatArray) -> NewtonResult:
    """Solve one stage from ``guess`` (prescribed values already in place)."""
    q, free = guess.copy(), problem.free
    now = problem.linearize(q)
    floor = inf
    shift, settled, moves = 0.0, False, 0
    while True:
        floor = min(floor, problem.system.round_off(now.values, q))
        gradient = now.residual[free]
        size = problem.size(gradient)
        if not isfinite(floor + sum(size)):
            return failed(problem, q, now, Status.NOT_FINITE)
        # As for full steps: a guess whose forces rounding may explain is no balance before a step says so.
        at_floor = problem.small(size, now, floor)
        met = moves > 0 and problem.small(size, now, 0.0)
        if sum(size) == 0.0 or (at_floor and (settled or met)):
            return done(problem, q, now, indefinite=shift > 0.0)
        settled = at_floor
        try:
            step, shift = _descent(problem, q, now, gradient, shift)
        except ExhaustedError:
            return failed(problem, q, now, Status.MAX_ITERATIONS)
        if step is None:
            return failed(problem, q, now, Status.FACTORIZATION_FAILED)
        # A string of a rod bends at once over many times its length: let it fall a length at a time.
        moved, _ = problem.size(step)
        step *= min(1.0, problem.system.extent / moved) if moved > 0.0 else 1.0
        step *= problem.longest_step(q, step)
        length = _backtrack(problem, q, step, gradient)
        if length == 0.0:
            return failed(problem, q, now, Status.LINE_SEARCH_FAILED)
        q[free] += length * step
        moves += 1
        now = problem.linearize(q)


def _descent(
    problem: StageProblem, q: FloatArray, now: Linearized, gradient: FloatArray, shift: float
) -> tuple[FloatArray | None, float]:
    """Newton's step if it goes down the slope, or with the diagonal raised until it does; the next shift."""
    try:
        tangent = problem.tangent(q, now)
        values, step = tangent.values, _downhill(tangent.factors, gradient) if shift == 0.0 else None
    except FactorizationError:
        values, step = now.values, None
    if step is not None:
        return step, 0.0
    return _shifted(problem, values, gradient, shift or _LEAST_SHIFT)


def _downhill(factors: Factors, gradient: FloatArray) -> FloatArray | None:
    """Newton's step, if it goes down the slope."""
    step = factors.solve(-gradient)
    return step if np.isfinite(step).all() and float(step @ gradient) < 0.0 else None


def _shifted(
    problem: StageProblem, values: FloatArray, gradient: FloatArray, shift: float
) -> tuple[FloatArray | None, float]:
    """Direction down the slope, the diagonal raised as little as needed; the next shift."""
    diagonal = problem.diagonal
    size = np.abs(values[diagonal])
    base = values[diagonal].copy()
    for _ in range(24):
        values[diagonal] = base + shift * size
        try:
            step = _downhill(problem.factorize(values), gradient)
        except FactorizationError:
            step = None
        if step is not None:
            # a shift that was needed is tried ten times smaller at the next iterate
            return step, (0.1 * shift if shift > 0.1 * _LEAST_SHIFT else 0.0)
        shift = 10.0 * shift
    return None, shift


def _backtrack(problem: StageProblem, q: FloatArray, step: FloatArray, gradient: FloatArray) -> float:
    """Armijo step length on the potential; work of other forces by the trapezoidal rule."""
    free = problem.free
    slope = float(step @ gradient)
    energy0, rest0 = problem.potential(q)
    work0 = float(step @ rest0[free])
    length = 1.0
    while length >= _SHORTEST:
        trial = q.copy()
        trial[free] += length * step
        energy, rest = problem.potential(trial)
        change = energy - energy0 + 0.5 * length * (work0 + float(step @ rest[free]))
        # round-off of the energies hides changes below this
        noise = 1e-14 * (abs(energy) + abs(energy0))
        if change <= _ARMIJO * length * slope + noise:
            return length
        length *= 0.5
    return 0.0
