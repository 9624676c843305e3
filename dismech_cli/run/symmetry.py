"""Whether a run in time stays perfectly straight, round or flat where it would buckle.

In exact symmetry nothing pushes a robot out of an unstable balance, and rounding takes its time to. So the
stiffness is looked at now and then: a mode in which it is negative, which grows within the run and in which
nothing yet moves, is one that a real robot would take and this one does not.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from ..arrays import FloatArray
from ..model.saved import Arrays, Numbers
from ..model.state import State
from ..solve.linear.factors import FactorizationError
from ..solve.linear.modes import softest_modes
from ..solve.step import Stepper

# How often a run is looked at; each time costs a factorisation.
_LOOKS = 20
# A mode that grows by less than e to this power until the end of the run does not matter.
_GROWTH = 5.0
# Root mean square of the motion in a mode, in units of the robot's size, up to which it is rounding.
_ROUNDING = 1e-9
# Modes looked at beyond those that matter: others may be nearer to zero. And how many at most.
_MORE, _MOST = 4, 32


@dataclass(frozen=True, slots=True)
class Found:
    """An unstable balance that nothing disturbs.

    Attributes:
        t: When it was seen [s].
        modes: In how many modes, of those looked at.
        rate: At which the fastest would grow [1/s].
    """

    t: float
    modes: int
    rate: float


class Symmetry:
    """Looks for what nothing disturbs; implements :class:`~dismech_cli.model.saved.Saved`.

    Attributes:
        found: What was found, as long as nothing has disturbed it since.
    """

    def __init__(self, stepper: Stepper) -> None:
        """Look at the states of what a stepper steps."""
        self._stepper = stepper
        self._next = 0.0
        self.found: Found | None = None

    def look(self, state: State, t_end: float) -> None:
        """Look at a state on the way to the end of the run [s], if it is time to."""
        system = self._stepper.system
        if state.t < self._next or not system.model.mass.any():
            return
        self._next = state.t + t_end / _LOOKS
        before, self.found = self.found, None
        if not system.pattern.symmetric or not self._stepper.stability.unstable(state):
            return
        since = state.t if before is None else before.t
        if t_end <= since:
            return
        with np.errstate(all="ignore"):
            try:
                sizes, vectors, mass = self._modes(state, _GROWTH / (t_end - since))
            except FactorizationError:
                return
        moved, speed = (x[system.pattern.free] for x in (state.q - system.model.rest, state.v))
        size = system.extent * sqrt(float(mass.sum()))
        rates = np.sqrt(np.maximum(-sizes, 0.0))
        grows = rates * (t_end - since) > _GROWTH
        amplitudes = np.abs(vectors.T @ (mass * moved))
        amplitudes += np.abs(vectors.T @ (mass * speed)) / np.maximum(rates, 1.0 / t_end)
        still = grows & (amplitudes <= _ROUNDING * size)
        if still.any():
            self.found = Found(since, int(still.sum()), float(rates[still].max()))

    def _modes(self, state: State, rate: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Squares of frequencies, modes of unit mass, and the mass, on the free DOFs; none if none matters.

        Args:
            state: Where.
            rate: Of growth [1/s], that of the slowest mode that matters.

        Raises:
            FactorizationError: They cannot be found.
        """
        stepper, system = self._stepper, self._stepper.system
        mass = system.model.mass[system.pattern.free]
        mass = np.where(mass > 0.0, mass, 1e-6 * np.median(mass[mass > 0.0]))
        # K + rate^2 M has a negative eigenvalue for each mode that grows faster
        fast = stepper.stability.negative_eigenvalues(state, rate * rate * mass)
        if not fast:
            return np.empty(0), np.empty((len(mass), 0)), mass
        count = min(fast, _MOST) + _MORE
        values = stepper.stability.stiffness(state)
        sizes, vectors = softest_modes(system.pattern, system.solver, values, mass, count)
        return sizes, vectors, mass

    def arrays(self) -> Arrays:
        """None."""
        return {}

    def numbers(self) -> Numbers:
        """When to look again, and what was found; a rate of 0 for nothing."""
        found = self.found or Found(0.0, 0, 0.0)
        return {"next": self._next, "t": found.t, "modes": found.modes, "rate": found.rate}

    def restore(self, arrays: Arrays, numbers: Numbers) -> Symmetry:
        """Go on from what was found."""
        self._next = float(numbers["next"])
        if numbers["modes"]:
            self.found = Found(float(numbers["t"]), int(numbers["modes"]), float(numbers["rate"]))
        return self
