"""Whether a run in time stays perfectly straight, round or flat where it would buckle.

In exact symmetry nothing pushes a robot out of an unstable balance, and rounding takes its time to. So the
stiffness is looked at now and then: a mode in which it is negative, which grows within the run and in which
nothing yet moves, is one that a real robot would take and this one does not.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from ..model.saved import Arrays, Numbers
from ..model.state import State
from ..solve.linear.factors import FactorizationError
from ..solve.linear.modes import softest_modes
from ..solve.stability import Stability
from ..solve.step import Stepper
from ..solve.system import System

# How often a run is looked at, and how many looks are put by, as long as what is bound stays: each costs a
# factorisation, but what is stable at the last of them was so from then on, whatever came before. All are put
# by where they are no more numbers than these.
_LOOKS, _PUT_BY, _NUMBERS = 20, 4, 2**20
# A mode that grows by less than e to this power until the end of the run does not matter.
_GROWTH = 5.0
# Root mean square of the motion in a mode, in units of the robot's size, up to which it is rounding.
_ROUNDING = 1e-9
# Modes looked at beyond those that matter: others may be nearer to zero. And how many at most.
_MORE, _MOST = 4, 32


@frozen
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


@frozen
class _Look:
    """A state that is looked at.

    Attributes:
        state: The state.
        t_end: End of the run [s].
        system: The model, bound to the DOFs that are free then.
        stability: Of its states.
    """

    state: State
    t_end: float
    system: System
    stability: Stability

    def calm(self, since: float) -> bool:
        """Whether nothing grows that matters, from a time [s] to the end of the run.

        It takes but a factorisation, and what is calm from one time is calm from any later one.
        """
        if self.t_end <= since:
            return True
        # K + rate^2 M has a negative eigenvalue for each mode that grows faster
        values = self.stability.stiffness(self.state)
        values[self.system.pattern.diagonal] += self._slowest(since) ** 2 * self._mass
        try:
            factors = self.system.solver.factorize(values)
        except FactorizationError:
            return False
        return not factors.indefinite

    def found(self, before: Found | None) -> Found | None:
        """What is unstable and has not moved yet, if anything; ``before`` is what was at the last look."""
        system, state, t_end = self.system, self.state, self.t_end
        since = state.t if before is None else before.t
        if self.calm(since) or not self.stability.unstable(state):
            return None
        with np.errstate(all="ignore"):
            try:
                sizes, vectors = self._modes(self._slowest(since))
            except FactorizationError:
                return None
        mass = self._mass
        moved, speed = (x[system.pattern.free] for x in (state.q - system.model.rest, state.v))
        size = system.extent * sqrt(float(mass.sum()))
        rates = np.sqrt(np.maximum(-sizes, 0.0))
        grows = rates * (t_end - since) > _GROWTH
        amplitudes = np.abs(vectors.T @ (mass * moved))
        amplitudes += np.abs(vectors.T @ (mass * speed)) / np.maximum(rates, 1.0 / t_end)
        still = grows & (amplitudes <= _ROUNDING * size)
        return Found(since, int(still.sum()), float(rates[still].max())) if still.any() else None

    def _slowest(self, since: float) -> float:
        """Rate of growth [1/s] of the slowest mode that matters."""
        return _GROWTH / (self.t_end - since)

    @property
    def _mass(self) -> FloatArray:
        """Of the free DOFs in matrix order; a little where there is none, shape (m,)."""
        mass = self.system.model.mass[self.system.pattern.free]
        return mass if mass.all() else np.where(mass > 0.0, mass, 1e-6 * np.median(mass[mass > 0.0]))

    def _modes(self, rate: float) -> tuple[FloatArray, FloatArray]:
        """Squares of frequencies and modes of unit mass, on the free DOFs; none if none matters.

        Raises:
            FactorizationError: They cannot be found.
        """
        system, mass = self.system, self._mass
        fast = self.stability.negative_eigenvalues(self.state, rate * rate * mass)
        if not fast:
            return np.empty(0), np.empty((len(mass), 0))
        count = min(fast, _MOST) + _MORE
        values = self.stability.stiffness(self.state)
        return softest_modes(system.pattern, system.solver, values, mass, count)


class Symmetry:
    """Looks for what nothing disturbs; implements :class:`~dismech_cli.model.saved.Saved`."""

    def __init__(self, stepper: Stepper) -> None:
        """Look at the states of what a stepper steps."""
        self._stepper = stepper
        self._moves = bool(stepper.model.mass.any())
        small = _LOOKS if _LOOKS * stepper.model.dofs.n < _NUMBERS else _PUT_BY
        self._put_by = 0 if stepper.model.changing else small
        self._next = 0.0
        self._found: Found | None = None
        self._looks: list[_Look] = []

    def found(self) -> Found | None:
        """What was found, as long as nothing has disturbed it since; goes through what was put by."""
        if self._looks:
            since = self._looks[0].state.t if self._found is None else self._found.t
            if self._looks[-1].calm(since):
                self._found = None
            else:
                for look in self._looks:
                    self._found = look.found(self._found)
            self._looks.clear()
        return self._found

    def due(self, t: float) -> bool:
        """Whether it is time [s] to look."""
        return self._moves and t >= self._next

    def look(self, state: State, t_end: float) -> None:
        """Look at a state on the way to the end of the run [s], if it is time to."""
        if not self.due(state.t):
            return
        self._next = state.t + t_end / _LOOKS
        if not self._stepper.system.pattern.symmetric:
            self._looks.clear()
            self._found = None
            return
        self._looks.append(_Look(state, t_end, self._stepper.system, self._stepper.stability))
        if len(self._looks) > self._put_by:
            self.found()

    def arrays(self) -> Arrays:
        """None."""
        return {}

    def numbers(self) -> Numbers:
        """When to look again, and what was found; a rate of 0 for nothing."""
        found = self.found() or Found(0.0, 0, 0.0)
        return {"next": self._next, "t": found.t, "modes": found.modes, "rate": found.rate}

    def restore(self, arrays: Arrays, numbers: Numbers) -> Symmetry:
        """Go on from what was found."""
        self._next = float(numbers["next"])
        if numbers["modes"]:
            self._found = Found(float(numbers["t"]), int(numbers["modes"]), float(numbers["rate"]))
        return self
