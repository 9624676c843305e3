"""Newton's method: full steps first, an energy line search only where they fail.

The residual norm is never a merit function: stiff stretching makes it rise although the step is
right. Convergence is decided on the residual alone, relative to the forces that act in the model
and above the round-off of positions.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf, isfinite

import numpy as np

from ..arrays import FloatArray
from .line_search import search
from .linear.factors import FactorizationError
from .problem import ExhaustedError, StageProblem
from .result import NewtonResult, done, failed
from .status import Status

# Full steps get this many iterations before the line search takes over from the predictor.
FULL_STEPS = 20
# A step this many times the size of the model means that nothing resists it.
_RUNAWAY = 1e6


def solve_stage(problem: StageProblem, guess: FloatArray) -> NewtonResult:
    """Solve one stage from ``guess`` (prescribed values already in place)."""
    solved = problem.at_once(guess, FULL_STEPS)
    if solved is not None:
        return NewtonResult(
            solved.q,
            solved.residual,
            Status.CONVERGED,
            solved.iterations,
            solved.residual_norm,
            -1,
            frames=solved.frames,
        )
    with np.errstate(all="ignore"):
        result = _full_steps(problem, guess)
        if result.status is Status.CONVERGED or problem.used_up:
            return result
        retry = search(problem, guess)
    # The retry shifts the diagonal and cannot see that the tangent was singular: keep that finding.
    singular = result.status is Status.FACTORIZATION_FAILED and retry.status is not Status.CONVERGED
    return replace(retry, status=result.status) if singular else retry


def _full_steps(problem: StageProblem, guess: FloatArray) -> NewtonResult:
    q, free = guess.copy(), problem.free
    floor, settled, indefinite = inf, False, False
    for iterations in range(FULL_STEPS + 1):
        now = problem.linearize(q)
        # the least of all iterates: where a guess crushes an edge, its stiffness would excuse any residual
        floor = min(floor, problem.system.round_off(now.values, q))
        rhs = -now.residual[free]
        size = problem.size(rhs)
        if not isfinite(floor + sum(size)):
            return failed(problem, q, now, Status.NOT_FINITE)
        # One step at least, and one more from where rounding of stiff axial forces hides the rest:
        # soft directions, whose forces are far smaller, are solved by it too. A guess taken as it is
        # would let slow motion creep to a halt short of its rest.
        at_floor = problem.small(size, now, floor)
        met = iterations > 0 and problem.small(size, now, 0.0)
        if sum(size) == 0.0 or (at_floor and (settled or met)):
            return done(problem, q, now, indefinite=indefinite)
        settled = at_floor
        if iterations == FULL_STEPS:
            break
        try:
            step, indefinite = problem.step(q, now, rhs)
        except ExhaustedError:
            break
        except FactorizationError:
            return failed(problem, q, now, Status.FACTORIZATION_FAILED)
        moved, _ = problem.size(step)
        if not moved <= _RUNAWAY * problem.system.extent:
            status = Status.FACTORIZATION_FAILED if isfinite(moved) else Status.NOT_FINITE
            return failed(problem, q, now, status)
        part = problem.stride(q, now, step)
        q[free] += step if part == 1.0 else part * step
    return failed(problem, q, now, Status.MAX_ITERATIONS)
