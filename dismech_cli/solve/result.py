"""Outcome of one nonlinear solve."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from ..kinematics.rod_frames import FrameState
from .assembly import Linearized
from .problem import StageProblem
from .status import Status


@frozen
class NewtonResult:
    """Outcome of one nonlinear solve.

    Attributes:
        q: Solution, or the last iterate.
        residual: Full residual (n,) at ``q``: reactions on held DOFs.
        status: How it ended.
        iterations: Factorisations done, those of shifted and of projected tangents included.
        residual_norm: Largest free residual [N].
        worst: Global index of the DOF with the largest residual, or -1.
        indefinite: Whether the last tangent is known to have a negative eigenvalue.
        frames: Frames at ``q``, where they were carried there; None where they are still to be.
        auxiliary: Inputs of kernels at ``q``, shape (size,); None likewise.
    """

    q: FloatArray
    residual: FloatArray
    status: Status
    iterations: int
    residual_norm: float
    worst: int
    indefinite: bool = False
    frames: FrameState | None = None
    auxiliary: FloatArray | None = None


def done(problem: StageProblem, q: FloatArray, now: Linearized, *, indefinite: bool) -> NewtonResult:
    """Balance at ``q``, reached with a last tangent that was indefinite or not."""
    largest = float(np.abs(now.residual[problem.free]).max(initial=0.0))
    found = NewtonResult(q, now.residual.copy(), Status.CONVERGED, problem.spent, largest, -1, indefinite)
    if not problem.stage.balanced_end:
        return found
    return replace(found, frames=now.frames.state, auxiliary=now.frames.auxiliary)


def failed(problem: StageProblem, q: FloatArray, now: Linearized, status: Status) -> NewtonResult:
    """The last iterate, and where it is worst."""
    r = np.abs(now.residual[problem.free])
    worst = int(problem.free[int(np.argmax(np.where(np.isfinite(r), r, np.inf)))]) if r.size else -1
    return NewtonResult(q, now.residual.copy(), status, problem.spent, float(r.max(initial=0.0)), worst)
