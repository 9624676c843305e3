"""The state of the system between steps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, fields

from ..arrays import FloatArray
from ..frozen import frozen
from ..kinematics.rod_frames import FrameState
from ..laws.signal import no_inputs
from .saved import Arrays, Numbers, within


@frozen
class State:
    """Everything a step starts from; implements :class:`~.saved.Saved`.

    Attributes:
        t: Time [s].
        q: Positions [m] and angles [rad], shape (n,).
        v: Rates, shape (n,).
        a: Second rates, shape (n,).
        frames: Reference frames stored at ``q``.
        inputs: What controllers put in, held until the next step begins, shape (K,).
        memory: What else the next step depends on, by name.
        load: Load factor, where it is not the time: on a path of equilibria, whose time is its length.
    """

    t: float
    q: FloatArray
    v: FloatArray
    a: FloatArray
    frames: FrameState
    inputs: FloatArray = field(default_factory=no_inputs)
    memory: Mapping[str, FloatArray] = field(default_factory=dict)
    load: float | None = None

    @property
    def law_time(self) -> float:
        """Time [s] or load factor at which laws are taken."""
        return self.t if self.load is None else self.load

    def arrays(self) -> Arrays:
        """All but the time."""
        frames = {f"frames.{f.name}": getattr(self.frames, f.name) for f in fields(FrameState)}
        memory = {f"memory.{name}": values for name, values in self.memory.items()}
        return {"q": self.q, "v": self.v, "a": self.a, "inputs": self.inputs} | frames | memory

    def numbers(self) -> Numbers:
        """The time, and the load factor where it is another."""
        return {"t": self.t} | ({} if self.load is None else {"load": self.load})

    def restore(self, arrays: Arrays, numbers: Numbers) -> State:
        """The state that was saved."""
        frames = within("frames", arrays)
        return State(
            float(numbers["t"]),
            arrays["q"],
            arrays["v"],
            arrays["a"],
            FrameState(**{f.name: frames[f.name] for f in fields(FrameState)}),
            arrays["inputs"],
            within("memory", arrays),
            float(numbers["load"]) if "load" in numbers else None,
        )
