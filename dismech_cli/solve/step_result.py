"""What a step gives back."""

from __future__ import annotations

from ..arrays import FloatArray
from ..frozen import frozen
from ..model.state import State
from .status import Status


@frozen
class StepResult:
    """What a step gives back.

    Attributes:
        state: The new state; the old one untouched if the step failed.
        status: How it ended.
        iterations: Linear solves.
        residual_norm: Largest free residual [N] of the last stage.
        residual: Residual (n,) of the last stage: reactions on held DOFs.
        worst: DOF with the largest residual of a failed step, or -1.
        ambiguous: Whether a step in time may have another solution: one was found from another guess, or the
            tangent of a stage is known to have a negative eigenvalue at its own.
        arrived: Whether this is where a path was to end.
        put_in: Energy [J] that came from nothing moving: contact that was made stiffer.
        unsettled: Whether what comes and goes asked for the step once more, and that failed.
        trail: State that the step started from, and that at the end of each stage.
        reactions: What terms do to held DOFs at the end, shape (K,); None where that is not known.
        auxiliary: Inputs of kernels at the end, shape (size,); None where they are yet to be found.
    """

    state: State
    status: Status
    iterations: int
    residual_norm: float
    residual: FloatArray
    worst: int
    ambiguous: bool = False
    arrived: bool = False
    put_in: float = 0.0
    unsettled: bool = False
    trail: tuple[State, ...] = ()
    reactions: FloatArray | None = None
    auxiliary: FloatArray | None = None
