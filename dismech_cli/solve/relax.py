"""Equilibria by damped motion to rest: slower than Newton's method, and safe where shapes buckle.

The robot moves as in a thick fluid, mu D q' = -r with the same resistance D for every length that moves,
by steps that are implicit: (K + mu D) s = -r. A step that the energy follows as foreseen lets the next be
longer, until steps are Newton's; one that it does not follow is taken back and shortened. So each goes
downhill, and what is at rest in the end is in equilibrium by the same criterion as any other static state.
"""

from __future__ import annotations

from functools import partial
from math import inf, isfinite

import numpy as np

from ..arrays import FloatArray
from .assembly import Linearized
from .linear.factors import FactorizationError
from .problem import StageProblem
from .result import NewtonResult, done, failed
from .status import Status
from .step import through_stages

# Factorisations per unit of the limit for Newton's method.
_PATIENCE = 20
# Resistance at the start, of the largest stiffness; how it changes; below the last share steps are Newton's.
_FIRST, _SHORTER, _LONGER, _NEWTON = 1e-6, 4.0, 0.25, 1e-16
# Part of the foreseen fall of the energy below which a step is taken back, and above which it may grow.
_BAD, _GOOD = 0.1, 0.7
# Largest step, of the size of the robot.
_FAR = 0.1


def relax_stage(problem: StageProblem, guess: FloatArray) -> NewtonResult:
    """Let a stage come to rest from ``guess`` (prescribed values already in place)."""
    with np.errstate(all="ignore"):
        return _to_rest(problem, guess)


def _to_rest(problem: StageProblem, guess: FloatArray) -> NewtonResult:
    q, free, system = guess.copy(), problem.free, problem.system
    resisting = system.at_node + system.at_angle * system.model.length**2
    now = problem.linearize(q)
    if not np.isfinite(now.values).all():
        return failed(problem, q, now, Status.NOT_FINITE)
    scale = float(np.abs(now.values[problem.diagonal] / resisting).max(initial=0.0))
    resistance, floor, settled, moves = _FIRST, inf, False, 0
    while problem.spent < _PATIENCE * problem.settings.max_iterations:
        floor = min(floor, system.round_off(now.values, q))
        gradient = now.residual[free]
        size = problem.size(gradient)
        if not isfinite(floor + sum(size)):
            return failed(problem, q, now, Status.NOT_FINITE)
        # as for Newton's method: one step at least, and one more from where rounding hides the rest
        at_floor = problem.small(size, now, floor)
        if sum(size) == 0.0 or (at_floor and (settled or (moves > 0 and problem.small(size, now, 0.0)))):
            return done(problem, q, now, indefinite=False)
        settled = at_floor
        step, resistance = _step(problem, now, gradient, scale * resisting, resistance)
        if step is None:
            return failed(problem, q, now, Status.FACTORIZATION_FAILED)
        moved, _ = problem.size(step)
        step *= min(1.0, _FAR * system.extent / moved) if moved > 0.0 else 1.0
        step *= problem.longest_step(q, step)
        share = _share(problem, q, step, gradient, now)
        if share >= _BAD:
            q[free] += step
            moves += 1
        else:
            settled = False
        if share < _BAD:
            resistance = _SHORTER * max(resistance, _NEWTON)
        elif share > _GOOD:
            resistance *= _LONGER
        now = problem.linearize(q)
    return failed(problem, q, now, Status.MAX_ITERATIONS)


def _step(
    problem: StageProblem, now: Linearized, gradient: FloatArray, resisting: FloatArray, resistance: float
) -> tuple[FloatArray | None, float]:
    """A step down the slope, with as much more resistance as that needs; the resistance."""
    diagonal = problem.diagonal
    base = now.values[diagonal].copy()
    for _ in range(40):
        now.values[diagonal] = base + (resistance if resistance > _NEWTON else 0.0) * resisting
        try:
            problem.spent += 1
            factors = problem.system.solver.factorize(now.values)
            if not factors.indefinite:
                step = factors.solve(-gradient)
                if np.isfinite(step).all() and float(step @ gradient) < 0.0:
                    now.values[diagonal] = base
                    return step, resistance
        except FactorizationError:
            pass
        resistance = _SHORTER * max(resistance, _NEWTON)
    now.values[diagonal] = base
    return None, resistance


def _share(
    problem: StageProblem, q: FloatArray, step: FloatArray, gradient: FloatArray, now: Linearized
) -> float:
    """Fall of the energy over a step, of the fall that a parabola foresees; 1 where rounding hides both."""
    free, pattern = problem.free, problem.system.pattern
    foreseen = float(gradient @ step) + 0.5 * float(step @ pattern.product(now.values, step))
    energy0, rest0 = problem.potential(q)
    work0 = float(step @ rest0[free])
    trial = q.copy()
    trial[free] += step
    energy, rest = problem.potential(trial)
    change = energy - energy0 + 0.5 * (work0 + float(step @ rest[free]))
    noise = 1e-14 * (abs(energy) + abs(energy0))
    if abs(change) <= noise and abs(foreseen) <= noise:
        return 1.0
    if not isfinite(change) or foreseen >= 0.0:
        return -inf
    return change / foreseen


relaxed = partial(through_stages, solve=relax_stage)
"""The stages of an integrator, each by damped motion to rest; an :class:`~.step.Advance`."""
