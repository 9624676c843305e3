"""What strains shall be, over time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from ..laws.laws import Law


class Target(Protocol):
    """A value over time for each place."""

    @property
    def constant(self) -> bool:
        """Whether it never changes."""

    def __call__(self, t: float) -> FloatArray:
        """The values at ``t`` [s], shape (n,)."""


@frozen
class ByLaw:
    """A law of time and place.

    Attributes:
        law: The law.
        places: s of each place, shape (n,).
    """

    law: Law
    places: FloatArray

    @property
    def constant(self) -> bool:
        """That of the law."""
        return self.law.constant

    def __call__(self, t: float) -> FloatArray:
        """The values."""
        return np.asarray(self.law(t, self.places))


@frozen
class Fixed:
    """Always the same values."""

    values: FloatArray

    @property
    def constant(self) -> bool:
        """True."""
        return True

    def __call__(self, t: float) -> FloatArray:
        """The values."""
        return self.values


@frozen
class Course:
    """Values at given times, held outside.

    Attributes:
        times: Increasing [s], shape (T,).
        lookup: Values within them.
    """

    times: FloatArray
    lookup: Callable[[float], FloatArray]

    @classmethod
    def of(cls, times: FloatArray, values: FloatArray, interpolation: str) -> Course:
        """Interpolate.

        Args:
            times: Increasing [s], shape (T,).
            values: Shape (T, n).
            interpolation: ``linear`` or ``cubic`` (a natural spline).
        """
        from scipy.interpolate import CubicSpline, make_interp_spline

        if len(times) == 1:
            return cls(times, lambda t: np.asarray(values[0]))
        if interpolation == "cubic" and len(times) > 2:
            return cls(times, CubicSpline(times, values, axis=0, bc_type="natural"))
        return cls(times, make_interp_spline(times, values, k=1, axis=0))

    @property
    def constant(self) -> bool:
        """Whether there is but one time."""
        return len(self.times) == 1

    def __call__(self, t: float) -> FloatArray:
        """The values."""
        return np.asarray(self.lookup(min(max(t, self.times[0]), self.times[-1])))


@frozen
class Untold:
    """No target: a plugin that needs none gets no values."""

    constant = True

    def __call__(self, t: float) -> FloatArray:
        """No values, shape (0,)."""
        return np.empty(0)
