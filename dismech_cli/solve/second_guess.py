"""Whether a solution that was slow to be found is the one: asked from another guess.

Something thin that is hit hard has several balances within a step, each at a least of its energy, so that no
tangent tells them apart. Extrapolated motion may lead to a wrong one, slowly as a rule; from where the step
begins the nearest one is found. Where both agree there is no doubt.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..arrays import FloatArray
from .problem import StageProblem
from .result import NewtonResult
from .status import Status

# Factorisations from which a stage was slow: measured on 30 shipped scenes, all but a few stages take fewer.
SLOW = 8
# Factorisations that the other guess may take at least.
_PATIENCE = 20
# Solutions farther apart than this share of the motion are two; what Newton leaves is far smaller.
_APART = 0.05


def confirmed(
    problem: StageProblem,
    solve: Callable[[StageProblem, FloatArray], NewtonResult],
    start: FloatArray,
    guess: FloatArray,
    found: NewtonResult,
) -> tuple[bool, int]:
    """Whether no other solution is found from another guess, and the factorisations that took.

    Args:
        problem: The stage, with nothing spent.
        solve: Its solver.
        start: Where the stage begins, shape (n,).
        guess: The other guess, shape (n,).
        found: The solution in doubt.
    """
    settings = replace(problem.settings, max_iterations=max(_PATIENCE, problem.settings.max_iterations))
    other = solve(replace(problem, settings=settings), guess)
    if other.status is not Status.CONVERGED:
        return True, other.iterations
    nodes = problem.free[problem.system.at_node > 0.0]
    moved = float(np.abs(found.q - start)[nodes].max(initial=0.0))
    apart = float(np.abs(found.q - other.q)[nodes].max(initial=0.0))
    return apart <= _APART * moved, other.iterations
