"""What a fit that ended is worth: deviations, correlations, what the samples do not see."""

from __future__ import annotations

from typing import Final

import numpy as np

from ...arrays import FloatArray, IntArray
from . import camera
from .fit import Fit, Table
from .knobs import Knob
from .parts import parted
from .problem import Problem

# Share of the strongest direction below which a direction of the parameters is not seen at all.
_UNSEEN: Final = 1e-6


def judged(problem: Problem, x: FloatArray, jacobian: FloatArray, active: IntArray, why: str) -> Fit:
    """What a fit that ended is worth.

    Args:
        problem: What was solved.
        x: Where it ended, shape (P,).
        jacobian: Of its residual there, shape (R, P).
        active: Which numbers are at a bound, 0 for none, shape (P,).
        why: It ended.
    """
    n = len(problem.knobs)
    left = problem.left(x)
    assert left is not None
    # directions in units of the values themselves: logarithms have none
    sizes = np.array(
        [
            1.0 if knob.log else max(knob.setting.size, abs(value))
            for knob, value in zip(problem.knobs, problem.values(x), strict=True)
        ]
    )
    units = np.concatenate((sizes, np.maximum(np.abs(x[n:]), 1.0)))
    rows = np.zeros((max(len(jacobian), len(x)), len(x)))  # directions that no sample asks for count too
    rows[: len(jacobian)] = jacobian * units
    _, strength, directions = np.linalg.svd(rows, full_matrices=False)
    seen = strength > _UNSEEN * strength[0]
    fitted = np.concatenate([one[curves.fitted] for one, curves in zip(left, problem.curves, strict=True)])
    freedom = max(len(fitted) + problem.priors - len(x), 1)
    cost = np.concatenate((fitted, problem.prior(x)))
    chi2 = float(cost @ cost) / freedom
    known = all(one.deviation is not None for one in problem.curves)
    root = directions[seen].T / strength[seen]
    covariance = (root @ root.T) * np.outer(units, units) * (1.0 if known else chi2)
    covariance = covariance[:n, :n]
    deviations = np.sqrt(np.diag(covariance))
    safe = np.where(deviations > 0.0, deviations, 1.0)
    cameras = problem.cameras(x)
    condition = float(strength[0] / strength[seen][-1]) if seen.any() else np.inf
    blind = [row[:n] for row in directions[~seen]]
    values = problem.values(x)
    moved = [
        abs(x[k] - knob.inner(knob.setting.value)) > 3.0 * knob.deviation
        for k, knob in enumerate(problem.knobs)
    ]
    return Fit(
        knobs=problem.knobs,
        values=values,
        deviations=deviations,
        correlation=covariance / np.outer(safe, safe),
        condition=condition,
        unseen=tuple(blind),
        at_bound=tuple(bool(active[k]) or _near_bound(problem.knobs[k], values[k]) for k in range(n)),
        far=tuple(map(bool, moved)),
        chi2=chi2,
        known=known,
        tables=tuple(_table(problem, k, one, cameras.get(k)) for k, one in enumerate(left)),
        cameras=tuple(cameras.get(k) for k in range(len(problem.curves))),
        evaluations=problem.evaluations,
        runs=problem.experiment.runs,
        message=why,
        finer=np.empty(0),
    )


def _near_bound(knob: Knob, value: float) -> bool:
    slack = 1e-6 * knob.setting.size
    return bool(value - knob.low < slack or knob.high - value < slack)


def _table(problem: Problem, k: int, left: FloatArray, seen: FloatArray | None) -> Table:
    one, deviation = problem.curves[k], problem.deviations[k]
    off = np.abs(left) * deviation
    fitted, held = off[one.fitted], off[one.held]
    return Table(
        curves=one,
        deviation=deviation,
        fit=float(np.sqrt(np.mean(fitted**2))),
        worst=float(fitted.max()),
        held=float(np.sqrt(np.mean(held**2))) if held.size else float("nan"),
        scale=1.0 if seen is None else camera.scale(seen),
        samples=int(fitted.size),
        shown=one.values + left * deviation,
        parts=parted(one, off),
    )
