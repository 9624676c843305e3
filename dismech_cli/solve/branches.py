"""Bifurcations on a path of equilibria, told from the negative eigenvalues of the stiffness at its states."""

from __future__ import annotations

from math import isfinite

import numpy as np

from ..arrays import FloatArray
from ..model.state import State
from .linear.factors import FactorizationError
from .step import Stepper

# A step as short as this may pass a bifurcation; a longer one may have jumped to another branch.
FINE = 2e-3


def branches_passed(stepper: Stepper, start: State, end: State) -> FloatArray | None:
    """Load factors of the bifurcations up to ``end``; None where the step may have jumped to another branch.

    At a limit point of the load one eigenvalue changes its sign, and the load factor its way. Any other
    change is a bifurcation, or a jump: short steps tell which.

    Args:
        stepper: Has the stiffness.
        start: Where the step began; remembers those before.
        end: Where it ended; both remember the direction of the path.
    """
    known = start.memory.get("path.branches", np.empty(0))
    turned = float(start.memory["path.load"][0] * end.memory["path.load"][0] < 0.0)
    change = abs(_negative(stepper, end) - _negative(stepper, start))
    if not isfinite(change) or change <= turned:
        return known
    return np.append(known, end.law_time) if end.t - start.t <= FINE else None


def _negative(stepper: Stepper, state: State) -> float:
    """Negative eigenvalues; no number where the stiffness is singular or has no symmetry."""
    if not stepper.system.pattern.symmetric:
        return float("nan")
    try:
        return float(stepper.stability.negative_eigenvalues(state))
    except FactorizationError:
        return float("nan")
