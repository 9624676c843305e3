"""What runs are compared by: the quantities of a study, as shares of the range that they go through."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

import numpy as np

from ...arrays import FloatArray
from ...errors import ScenarioError
from ...run.observables.reduce import period, time_mean
from ...scenario.language.study import Measured
from .gap import Gap, Norm, largest, root_mean_square

# Times at which courses are compared.
_TIMES: Final = 400

Courses = Mapping[str, tuple[FloatArray, FloatArray]]
"""Times [s], shape (K,), and values of each quantity, by name: of a probe (K,), of the shape (K, N, 3)."""


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

    def gap(self, one: Courses, other: Courses) -> Gap:
        """How far two runs are apart in every quantity."""
        return self._gap({name: self._apart(name, one, other) for name in self._quantities})

    def error(self, courses: Courses) -> Gap:
        """How far a run is from what is right."""
        if self._reference is not None:
            return self.gap(courses, self._reference)
        return self._gap(
            {
                name: np.array([self._off(name, courses, float(how.value or 0.0))])
                for name, how in self._quantities.items()
            }
        )

    def _gap(self, parts: Mapping[str, FloatArray]) -> Gap:
        norms = tuple(_COURSES.get(self._quantities[name].norm, largest) for name in parts)
        return Gap(tuple(parts.values()), norms)

    def _apart(self, name: str, one: Courses, other: Courses) -> FloatArray:
        """Of one quantity, shape (K,), or (1,) if it is one number."""
        if self._quantities[name].norm in _COURSES:
            if one[name][1].shape[1:] != other[name][1].shape[1:]:
                raise ScenarioError("study: the shapes of different meshes cannot be compared: name probes")
            gap = _at(*one[name], self._times) - _at(*other[name], self._times)
            return _size(gap) / self._ranges[name]
        return np.array([self._off(name, one, self._number(name, other))])

    def _off(self, name: str, courses: Courses, right: float) -> float:
        """How far a number is from the right one, as a share."""
        return abs(self._number(name, courses) - right) / self._scale(name, right)

    def _number(self, name: str, courses: Courses) -> float:
        return _NUMBERS[self._quantities[name].norm](*courses[name])

    def _scale(self, name: str, value: float) -> float:
        return abs(value) if self._quantities[name].norm == "period" else self._ranges[name]


_COURSES: Mapping[str, Norm] = {"max": largest, "rms": root_mean_square}
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
