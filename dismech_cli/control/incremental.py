"""The incremental law of other codes, for comparison with their data."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from .controller import Memory
from .limits import UNLIMITED, Limits

# Share of the integral that is left after a sample at which any command was limited.
_LEFT = 0.9


@frozen(kw_only=True)
class Incremental:
    """u += p e + i I with e = r - y, then one pass over neighbours, then limits; dI/dt = e.

    Attributes:
        p: Gain of the error, per sample.
        i: Gain of its integral, per sample [1/s].
        leak: Share of the difference to each neighbour that a command loses.
        links: Neighbours, shape (L, 2).
        period: Time between samples [s].
        limits: Of the command.
    """

    p: float
    i: float
    leak: float
    links: IntArray
    period: float
    limits: Limits = UNLIMITED

    def start(self, n: int) -> Memory:
        """No integral, no command."""
        return {"integral": np.zeros(n), "command": np.zeros(n)}

    def sample(self, t: float, y: FloatArray, r: FloatArray, memory: Memory) -> tuple[FloatArray, Memory]:
        """The command."""
        error, before = r - y, memory["command"]
        integral = memory["integral"] + self.period * error
        wanted = before + self.p * error + self.i * integral
        lost = np.zeros_like(wanted)
        a, b = self.links.T
        np.add.at(lost, a, wanted[a] - wanted[b])
        np.add.at(lost, b, wanted[b] - wanted[a])
        wanted -= self.leak * lost
        command = self.limits.applied(wanted, before)
        if np.any(command != wanted):
            integral = _LEFT * integral
        return command, {"integral": integral, "command": command}

    def scaled(self, share: float) -> Incremental:
        """With all gains times a share, and without limits."""
        return replace(self, p=share * self.p, i=share * self.i, limits=UNLIMITED)
