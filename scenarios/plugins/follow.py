"""A controller that leads the tip of an arm along a circle.

dismech run scenarios/plugins/following_arm.yaml --plugin scenarios/plugins/follow.py
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Follow:
    """Turns the arm, in a few pieces of even curvature, so that its tip goes where the target will be.

    It knows the length of the arm and nothing of its weight and stiffness: what the arm does not do by
    itself, the next samples ask for again.
    """

    def __init__(
        self, length: float, pieces: int, center: list[float], radius: float, frequency: float, gain: float
    ) -> None:
        """Take the settings of the scenario; lengths in m, frequency in Hz."""
        self.length, self.pieces = length, pieces
        self.center, self.radius, self.frequency = np.array(center), radius, frequency
        self.gain = gain

    def start(self, n: int) -> Mapping[str, Array]:
        """A straight arm, and where its joints are along it."""
        return {"pieces": np.zeros(self.pieces), "joints": np.linspace(0.0, 1.0, n)}

    def sample(
        self, t: float, y: Array, r: Array, memory: Mapping[str, Array]
    ) -> tuple[Array, Mapping[str, Array]]:
        """Curvatures of all joints from the place (x, z) of the tip, which is all that it reads."""
        pieces, joints = memory["pieces"], memory["joints"]
        slopes = np.stack(
            [(self._tip(pieces + d) - self._tip(pieces - d)) / 2e-6 for d in 1e-6 * np.eye(len(pieces))]
        )
        off = self.gain * (self._target(t) - y)
        # the least change that moves the tip there; damped, since a straight arm cannot shorten
        change = slopes @ np.linalg.solve(slopes.T @ slopes + 1e-3 * np.eye(2), off)
        pieces = pieces + change
        return np.interp(joints, self._middles(), pieces), {"pieces": pieces, "joints": joints}

    def _target(self, t: float) -> Array:
        angle = 2.0 * np.pi * self.frequency * t
        return self.center + self.radius * np.array([np.sin(angle), np.cos(angle)])

    def _middles(self) -> Array:
        return (np.arange(self.pieces) + 0.5) / self.pieces

    def _tip(self, pieces: Array) -> Array:
        """Where a weightless arm of these curvatures would end."""
        s = np.linspace(0.0, 1.0, 101)
        turned = np.cumsum(np.interp(s, self._middles(), pieces)) * self.length / len(s)
        # positive curvature turns an upright arm towards -x
        return self.length * np.array([-np.sin(turned).mean(), np.cos(turned).mean()])
