"""How much energy from nowhere is too much, beside what a robot holds and was given."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np

from ..frozen import frozen
from ..model.model import Model

# Energy from nowhere, in units of all energy that was given: no damping scheme comes near, and an
# unstable one passes it within a few steps.
_RUNAWAY: Final = 100.0
# A motion by this share of the robot's size in the time of the run is no motion.
_STILL: Final = 1e-6


@frozen
class Growth:
    """Judges the error of an account; statics rests in a balance that Newton's method has checked.

    Attributes:
        mass: Sum of all masses [kg]; 0 in statics.
        size: Of the robot at rest [m].
    """

    mass: float
    size: float

    @classmethod
    def of(cls, model: Model) -> Growth:
        """Of a model."""
        size = float(np.ptp(model.dofs.positions(model.rest), axis=0).max())
        return cls(float(model.mass.sum()), size)

    def share(self, entries: Mapping[str, float], largest: float, seconds: float) -> float:
        """Energy that nothing gave, as a share of all that the robot held or turned into heat.

        What drag takes is summed step by step, each to within the error of a step: where far more
        flows through the robot than it ever holds, the account is that far from exact.

        Args:
            entries: Of the account [J].
            largest: The most that the robot held [J].
            seconds: Duration of the run [s].
        """
        if not self.mass:
            return 0.0
        return entries["error"] / (largest + abs(entries["dissipation"]) + self._stillness(seconds))

    def runs_away(self, entries: Mapping[str, float], initial: float, seconds: float) -> bool:
        """Whether the robot holds far more energy than it was given: the integrator has blown up.

        Args:
            entries: Of the account [J].
            initial: What it held at the start [J].
            seconds: Duration of the run [s].
        """
        if not self.mass:
            return False
        given = abs(entries["external_work"]) + abs(entries["dissipation"]) + abs(initial)
        given += abs(entries["gravitational"]) + self._stillness(seconds)
        return entries["error"] > _RUNAWAY * given

    def _stillness(self, seconds: float) -> float:
        """Energy [J] of a motion by a millionth of the robot's size in the time of the run: round-off."""
        speed = _STILL * self.size / seconds
        return self.mass * speed**2
