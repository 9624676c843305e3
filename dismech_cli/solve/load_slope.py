"""How an equilibrium moves with the load factor: dq/dlambda, at a trial point."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import FloatArray
from ..kinematics.motion import Since, prescribe
from .linear.factors import Factors
from .path_metric import Way
from .predictor import Predictor
from .problem import StageProblem


def load_slope(
    problem: StageProblem, predictor: Predictor, since: Since, q: FloatArray, change: float, factors: Factors
) -> Way:
    """K_ff dq_f = -dr/dlambda - K_fh dq_h, with the motion dq_h of what is held, per load factor.

    Args:
        problem: Balance at the load factor.
        predictor: Knows how what is held pulls.
        since: The state that the trial point starts from.
        q: The trial point, shape (n,).
        change: Of the load factor, over which loads and motions are differentiated; its sign says on
            which side of a kink.
        factors: Of the tangent there.
    """
    free, load, motions = problem.free, problem.stage.t_stage, problem.system.model.motions
    here, ahead = q.copy(), q.copy()
    prescribe(motions, here, load, since)
    prescribe(motions, ahead, load + change, since)
    slope = (ahead - here) / change
    rate = _rate(problem, q, change)
    if slope.any():
        rate += predictor.pull(problem, q, slope)
    slope[free] = factors.solve(-rate[free])
    return Way(slope, 1.0)


def _rate(problem: StageProblem, q: FloatArray, change: float) -> FloatArray:
    """dr/dlambda at a fixed shape (n,), of the terms that may depend on it."""
    system, stage = problem.system, problem.stage
    sums = []
    for at in (stage.t_stage, stage.t_stage + change):
        c = system.configuration(replace(stage, t_stage=at), q, problem.stored)
        r = np.zeros_like(q)
        for term in system.terms:
            if term.potential is None or not term.potential.steady:
                term.add_residual(c, r)
        sums.append(r)
    return np.asarray((sums[1] - sums[0]) / change)
