"""The trial point at which terms are evaluated, made once per iterate and shared by all terms."""

from __future__ import annotations

from dataclasses import field

from ..arrays import FloatArray
from ..frozen import frozen
from ..kinematics.rod_frames import FramesAt
from ..laws.signal import no_inputs


@frozen
class Configuration:
    """A trial point.

    Attributes:
        t: Time [s]; the load parameter in static runs.
        q: Positions [m] and angles [rad], shape (n,).
        v: Their rates [m/s, rad/s], shape (n,).
        frames: Reference and material frames transported to ``q``.
        inputs: What controllers put in, shape (K,).
    """

    t: float
    q: FloatArray
    v: FloatArray
    frames: FramesAt
    inputs: FloatArray = field(default_factory=no_inputs)
