"""The state of the system between steps."""

from __future__ import annotations

from dataclasses import dataclass, fields

from ..arrays import FloatArray
from ..kinematics.rod_frames import FrameState
from .saved import Arrays, Numbers, within


@dataclass(frozen=True, slots=True)
class State:
    """Everything a step starts from; implements :class:`~.saved.Saved`.

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

    def arrays(self) -> Arrays:
        """Positions, rates and frames."""
        frames = {f"frames.{f.name}": getattr(self.frames, f.name) for f in fields(FrameState)}
        return {"q": self.q, "v": self.v, "a": self.a} | frames

    def numbers(self) -> Numbers:
        """The time."""
        return {"t": self.t}

    def restore(self, arrays: Arrays, numbers: Numbers) -> State:
        """The state that was saved."""
        frames = within("frames", arrays)
        return State(
            float(numbers["t"]),
            arrays["q"],
            arrays["v"],
            arrays["a"],
            FrameState(**{f.name: frames[f.name] for f in fields(FrameState)}),
        )
