"""States between the ends of a step: cubic Hermite interpolation of shape and velocity."""

from __future__ import annotations

from dataclasses import replace

from ..arrays import FloatArray
from ..kinematics.rod_frames import Frames
from ..model.state import State


def between(before: State, after: State, t: float, frames: Frames) -> State:
    """The state at a time within a step, good to fourth order in its length.

    Args:
        before: Start of the step.
        after: Its end.
        t: Time [s].
        frames: Carry the frames of rods along: rotations are not interpolated.
    """
    h = after.t - before.t
    s = (t - before.t) / h
    moved: FloatArray = after.q - before.q
    q = before.q + moved * (s * s * (3.0 - 2.0 * s))
    q += h * s * (1.0 - s) * ((1.0 - s) * before.v - s * after.v)
    v = moved * (6.0 * s * (1.0 - s) / h)
    v += (1.0 - s) * (1.0 - 3.0 * s) * before.v + s * (3.0 * s - 2.0) * after.v
    a = (1.0 - s) * before.a + s * after.a
    return replace(after, t=t, q=q, v=v, a=a, frames=frames.transport(before.frames, q).state)
