"""Errors of refined solutions from their differences, with a safety factor.

After the grid convergence index (Roache 1994; ASME V&V 20): where three levels fall with an observed order
near the nominal one the difference is extrapolated and enlarged by 1.25, else by 2.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite, log, nan
from typing import Final

import numpy as np

from ...arrays import FloatArray
from ...errors import ScenarioError
from ...run.observables.reduce import period, time_mean
from ...scenario.language.study import Measured

# Safety with and without an observed order, the least order that is believed, and the share of the
# nominal one from which on three levels are said to converge.
_SAFE, _UNSURE, _LEAST, _STEADY = 1.5, 2.0, 0.5, 0.5
# Times at which courses are compared.
_TIMES: Final = 400

Courses = Mapping[str, tuple[FloatArray, FloatArray]]
"""Times [s], shape (K,), and values of each quantity, by name: of a probe (K,), of the shape (K, N, 3)."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """Error of the finest of some levels.

    Attributes:
        error: As a share.
        order: Observed; NaN with fewer than three levels.
        steady: Whether three levels fell as they should, or there are not three.
    """

    error: float
    order: float = nan
    steady: bool = True


NO_ERROR: Final = Estimate(0.0)
"""Of what is not refined."""


def estimate(differences: Sequence[float], ratio: float, nominal: float) -> Estimate:
    """The error from differences between successive levels, the coarsest first; the last two count.

    Args:
        differences: One, or more.
        ratio: Between the levels.
        nominal: Order that is to be expected.
    """
    fine = differences[-1]
    if not isfinite(fine):
        return Estimate(inf, steady=False)
    if len(differences) < 2:
        return Estimate(_UNSURE * fine / (ratio**nominal - 1.0))
    coarse = differences[-2]
    if coarse == 0.0:
        return Estimate(_UNSURE * fine / (ratio**_LEAST - 1.0), steady=fine == 0.0)
    order = log(coarse / fine) / log(ratio) if fine > 0.0 else inf
    if order < _LEAST:
        # hardly falling: the coarser difference may be the lucky one
        return Estimate(_UNSURE * max(fine, coarse) / (ratio**_LEAST - 1.0), order, steady=False)
    # a difference that is small by chance is no smaller than the one before it says
    believed = min(order, nominal)
    size = max(fine, coarse / ratio**nominal)
    return Estimate(_SAFE * size / (ratio**believed - 1.0), order, order >= _STEADY * nominal)


class Yardstick:
    """Compares courses; every study has one, so that all its errors are shares of the same range."""

    def __init__(self, quantities: Mapping[str, Measured], t_end: float) -> None:
        """Compare nothing yet.

        Args:
            quantities: Whose errors count.
            t_end: End of the runs.
        """
        self._quantities = quantities
        self._times = np.linspace(0.0, t_end, _TIMES + 1)
        self._ranges: dict[str, float] = {}
        self._reference: Courses | None = None

    @property
    def given(self) -> bool:
        """Whether all quantities have right values, whatever was run."""
        return all(one.value is not None for one in self._quantities.values())

    @property
    def known(self) -> bool:
        """Whether it is known what is right: by given values, or a run that counts as right."""
        return self.given or self._reference is not None

    def measure_from(self, reference: Courses) -> None:
        """Take a run as right."""
        self._reference = reference

    def is_reference(self, courses: Courses) -> bool:
        """Whether these are of the run that counts as right: of its own error nothing is known."""
        return courses is self._reference

    def start(self, courses: Courses) -> None:
        """Take the ranges of a run.

        Raises:
            ScenarioError: A quantity does not change: no error is a share of that.
        """
        self._ranges = {name: _extent(courses[name][1]) for name in self._quantities}
        still = [name for name, extent in self._ranges.items() if not extent > 0.0]
        if still:
            raise ScenarioError(f"study: {', '.join(still)} does not change in the run: name others")

    def distance(self, one: Courses, other: Courses) -> float:
        """The largest difference of any quantity, as a share."""
        return max(self._apart(name, one, other) for name in self._quantities)

    def error(self, courses: Courses) -> float:
        """The largest distance from what is right, as a share."""
        if self._reference is not None:
            return self.distance(courses, self._reference)
        return max(
            abs(self._number(name, courses) - float(how.value or 0.0))
            / self._scale(name, float(how.value or 0.0))
            for name, how in self._quantities.items()
        )

    def _apart(self, name: str, one: Courses, other: Courses) -> float:
        norm = self._quantities[name].norm
        if norm in _COURSES:
            if one[name][1].shape[1:] != other[name][1].shape[1:]:
                raise ScenarioError("study: the shapes of different meshes cannot be compared: name probes")
            gap = _at(*one[name], self._times) - _at(*other[name], self._times)
            return _COURSES[norm](_size(gap)) / self._ranges[name]
        first, second = self._number(name, one), self._number(name, other)
        return abs(first - second) / self._scale(name, second)

    def _number(self, name: str, courses: Courses) -> float:
        return _NUMBERS[self._quantities[name].norm](*courses[name])

    def _scale(self, name: str, value: float) -> float:
        return abs(value) if self._quantities[name].norm == "period" else self._ranges[name]


_COURSES: Mapping[str, Callable[[FloatArray], float]] = {
    "max": lambda gap: float(gap.max()),
    "rms": lambda gap: float(np.sqrt(np.mean(gap * gap))),
}
_NUMBERS: Mapping[str, Callable[[FloatArray, FloatArray], float]] = {
    "last": lambda t, x: float(x[-1]),
    "mean": time_mean,
    "period": period,
}


def _size(change: FloatArray) -> FloatArray:
    """Of changes at some times, shape (K,): of shapes the root mean square over the nodes."""
    if change.ndim == 1:
        return np.abs(change)
    size: FloatArray = np.sqrt((change * change).sum(axis=2).mean(axis=1))
    return size


def _extent(values: FloatArray) -> float:
    """The range of a course; of shapes the farthest from the first."""
    return float(np.ptp(values) if values.ndim == 1 else _size(values - values[0]).max())


def _at(times: FloatArray, values: FloatArray, wanted: FloatArray) -> FloatArray:
    """A course at other times: by a spline, whose own error is far below that of the steps."""
    from scipy.interpolate import CubicSpline, make_interp_spline

    spline = CubicSpline if len(times) >= 4 else lambda t, x: make_interp_spline(t, x, k=1)
    found: FloatArray = spline(times, values)(wanted)
    return found
