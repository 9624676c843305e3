"""How a command reaches the natural strains: through the inputs of the system, where they lie in order."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..laws.signal import Value
from .target import Target


@frozen
class Channel:
    """A part of the inputs: a ramp of ``n`` values between two times.

    It holds when the ramp starts and ends, and the values there. Between steps, ramps follow each other
    without a jump, so that a command is a continuous function of time: it keeps the order of integrators
    and does its work by what it moves.

    Attributes:
        first: Its first place among the inputs.
        n: Number of values.
    """

    first: int
    n: int

    @property
    def size(self) -> int:
        """Number of its places."""
        return 2 + 2 * self.n

    @property
    def end(self) -> int:
        """The place after its last."""
        return self.first + self.size

    def value(self, t: float, inputs: FloatArray) -> FloatArray:
        """The values at ``t`` [s], shape (n,)."""
        start, end = inputs[self.first], inputs[self.first + 1]
        before = inputs[self.first + 2 : self.first + 2 + self.n]
        after = inputs[self.first + 2 + self.n : self.end]
        if t >= end:
            return after
        if t <= start:
            return before
        part = (t - start) / (end - start)
        ramp: FloatArray = (1.0 - part) * before + part * after
        return ramp

    def written(
        self, inputs: FloatArray, start: float, end: float, before: FloatArray, after: FloatArray
    ) -> FloatArray:
        """The inputs with this ramp; those given stay as they are."""
        out = inputs.copy()
        out[self.first : self.first + 2] = start, end
        out[self.first + 2 : self.first + 2 + self.n] = before
        out[self.first + 2 + self.n : self.end] = after
        out.flags.writeable = False
        return out


@frozen
class Commanded:
    """A signal: some values of a channel; zero where nothing controls the system.

    Attributes:
        channel: The channel.
        members: Which of its values each place follows, shape (K,).
    """

    channel: Channel
    members: IntArray

    @property
    def constant(self) -> bool:
        """False."""
        return False

    def value(self, t: float, inputs: FloatArray, places: Value = 0.0) -> Value:
        """The values, shape (K,)."""
        if not inputs.size:
            return np.zeros(len(self.members))
        return self.channel.value(t, inputs)[self.members]


@frozen
class Stiffened:
    """A signal: where springs that are 1 + p times as stiff rest, so that they pull as a PI loop would.

    With u = f r + p (w r - y) + I the moment K (y - u) is K (1 + p) (y - r') with
    r' = ((f + p w) r + I) / (1 + p): ideal feedback is a stiffer spring with another natural strain.

    Attributes:
        target: r.
        share: (f + p w) / (1 + p).
        integral: Channel of I / (1 + p), or None without an integral.
        members: Which of the values each place follows, shape (K,).
    """

    target: Target
    share: float
    integral: Channel | None
    members: IntArray

    @property
    def constant(self) -> bool:
        """Whether the target is, and nothing is added up."""
        return self.integral is None and self.target.constant

    def value(self, t: float, inputs: FloatArray, places: Value = 0.0) -> Value:
        """The values, shape (K,)."""
        rest = self.share * self.target(t)[self.members]
        if self.integral is None or not inputs.size:
            return rest
        return rest + self.integral.value(t, inputs)[self.members]
