"""The state of the system between steps."""

from __future__ import annotations

from dataclasses import dataclass

from ..arrays import FloatArray
from ..kinematics.rod_frames import FrameState


@dataclass(frozen=True, slots=True)
class State:
    """Everything a step starts from.

    Attributes:
        t: Time [s].
        q: Positions [m] and angles [rad], shape (n,).
        v: Rates, shape (n,).
        a: Second rates, shape (n,).
        frames: Reference frames stored at ``q``.
    """

    t: float
    q: FloatArray
    v: FloatArray
    a: FloatArray
    frames: FrameState
