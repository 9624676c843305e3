"""The positional PI(D) law."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from .controller import Memory
from .limits import UNLIMITED, Limits
from .smoothing import UNSMOOTHED, Smoothing


@frozen(kw_only=True)
class Positional:
    """u = f r + F(p (w r - y) + I - d dy/dt) within limits; dI/dt = i (r - y).

    Where a limit cuts the command, the integral of that place alone is led back with the time constant
    p/i: no sum of errors grows that the actuator could not follow (back-calculation).

    Attributes:
        p: Gain of the error.
        i: Gain of its integral [1/s].
        d: Gain of the rate of the reading [s].
        weight: Share w of the target in the error of p.
        forward: Share f of the target that is commanded at once.
        period: Time between samples [s].
        smoothing: F.
        limits: Of the command.
    """

    p: float
    i: float
    d: float
    weight: float
    forward: float
    period: float
    smoothing: Smoothing = UNSMOOTHED
    limits: Limits = UNLIMITED

    def start(self, n: int) -> Memory:
        """No integral, no command; the first reading has no rate."""
        nothing = {"integral": np.zeros(n), "command": np.zeros(n)}
        return nothing | {"reading": np.full(n, np.nan)} if self.d else nothing

    def sample(self, t: float, y: FloatArray, r: FloatArray, memory: Memory) -> tuple[FloatArray, Memory]:
        """The command."""
        integral = memory["integral"]
        fed = self.p * (self.weight * r - y) + integral
        kept = {}
        if self.d:
            rate = (y - memory["reading"]) / self.period
            fed -= self.d * np.where(np.isnan(rate), 0.0, rate)
            kept = {"reading": y}
        wanted = self.forward * r + self.smoothing(fed)
        command = self.limits.applied(wanted, memory["command"])
        integral = integral + self.i * self.period * (r - y)
        if self.i:
            integral += (command - wanted) * min(self.period * self.i / self.p if self.p else 1.0, 1.0)
        return command, {"integral": integral, "command": command} | kept

    def scaled(self, share: float) -> Positional:
        """With all gains times a share, and without limits."""
        return replace(self, p=share * self.p, i=share * self.i, d=share * self.d, limits=UNLIMITED)
