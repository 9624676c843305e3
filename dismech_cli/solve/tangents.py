"""Which tangent Newton steps with, and its factors."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from ..arrays import FloatArray
from ..kinematics.rod_frames import FrameState
from .integrators import Stage
from .linear.solver import LinearSolver
from .system import Linearized, System

Factorize: TypeAlias = Callable[[System, LinearSolver, Stage, FloatArray, FrameState, Linearized], FloatArray]


def exact(
    system: System, solver: LinearSolver, stage: Stage, q: FloatArray, stored: FrameState, now: Linearized
) -> FloatArray:
    """Factorise the tangent as it is.

    Args:
        system: The model and its pattern.
        solver: Keeps the factors.
        stage: What is solved.
        q: Trial point, shape (n,).
        stored: Frames at the start of the step.
        now: Residual and tangent at the trial point.

    Returns:
        The values that were factorised, shape (slots,).

    Raises:
        FactorizationError: The matrix is singular or not finite.
    """
    solver.factorize(now.values)
    return now.values


def projected_where_indefinite(
    system: System, solver: LinearSolver, stage: Stage, q: FloatArray, stored: FrameState, now: Linearized
) -> FloatArray:
    """The same, but an indefinite tangent gives way to the one projected stencil by stencil.

    So steps go downhill past buckling, and the rate is quadratic where the end is stable.
    """
    solver.factorize(now.values)
    if not solver.indefinite:
        return now.values
    values = system.linearize_projected(stage, q, stored).values
    solver.factorize(values)
    return values


TANGENTS: dict[str, Factorize] = {"none": exact, "indefinite": projected_where_indefinite}
