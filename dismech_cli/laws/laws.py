"""Laws of time: what a prescribed value, a load or an actuation does as the run goes on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field
from math import inf
from typing import Any, ClassVar, Literal, Protocol, TypeAlias

import numpy as np

from ..arrays import FloatArray, distinct
from ..errors import LawError, ScenarioError
from ..frozen import frozen
from .expression import VARIABLES, Compiled, compile_expression
from .signal import Signal, Value
from .waves import sawtooth

Interpolation: TypeAlias = Literal["linear", "step", "cubic"]


class Law(Signal, Protocol):
    """A value that may depend on time t [s] and on the place s, 0 to 1 along a rod."""

    def __call__(self, t: float, s: Value = 0.0) -> Value:
        """The value at ``t``: a float, or an array of the shape of ``s`` if that is an array."""

    def kinks(self, end: float) -> FloatArray:
        """Known times in (0, ``end``) at which the value or its slope jumps [s], increasing."""

    @property
    def cycle(self) -> float:
        """Period after which it repeats [s]; infinite if none is known."""


def _within(times: FloatArray, end: float) -> FloatArray:
    """The times between 0 and ``end``, once each and in order."""
    return distinct(times[(times > 0.0) & (times < end)])


def _no_kinks(law: Law, end: float) -> FloatArray:
    """None that is known."""
    return np.empty(0)


def _without_inputs(law: Law, t: float, inputs: FloatArray, places: Value = 0.0) -> Value:
    """The value of a law: inputs do not change it."""
    return law(t, places)


def _spread(value: Any, s: Value) -> Value:
    """``value`` in the shape of ``s``."""
    if isinstance(s, np.ndarray):
        out = np.empty(s.shape)
        out[...] = value
        return out
    return float(value)


@frozen
class Constant:
    """Always the same value.

    Attributes:
        level: The value.
    """

    level: float
    value = _without_inputs
    kinks = _no_kinks
    cycle: ClassVar[float] = inf

    @property
    def constant(self) -> bool:
        """True."""
        return True

    def __call__(self, t: float, s: Value = 0.0) -> Value:
        """The value."""
        return _spread(self.level, s)


@frozen
class Proportional:
    """``slope`` times t, without an end.

    Attributes:
        slope: The value at t = 1.
    """

    slope: float
    value = _without_inputs
    kinks = _no_kinks
    cycle: ClassVar[float] = inf

    @property
    def constant(self) -> bool:
        """True if it stays zero."""
        return self.slope == 0.0

    def __call__(self, t: float, s: Value = 0.0) -> Value:
        """The value."""
        return _spread(self.slope * t, s)


@frozen(kw_only=True)
class Table:
    """Values at given times, held before the first and after the last.

    Attributes:
        times: Strictly increasing [s], at least one.
        values: One per time.
        interpolation: ``linear``; ``step`` holds each value until the next time; ``cubic`` is the
            natural cubic spline (continuous curvature).

    Raises:
        ScenarioError: if the lengths differ, the times do not increase or a number is not finite.
    """

    times: tuple[float, ...]
    values: tuple[float, ...]
    interpolation: Interpolation = "linear"
    _lookup: Callable[[float], Any] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if len(self.times) != len(self.values) or not self.times:
            raise ScenarioError(
                f"a table needs as many values as times, got {len(self.values)}, {len(self.times)}"
            )
        x, y = np.array(self.times), np.array(self.values)
        if not (np.isfinite(x).all() and np.isfinite(y).all()):
            raise ScenarioError("a table holds a number that is not finite")
        late = np.flatnonzero(np.diff(x) <= 0.0)
        if late.size:
            i = int(late[0])
            raise ScenarioError(f"the times of a table must increase, but {x[i + 1]:g} follows {x[i]:g}")
        object.__setattr__(self, "_lookup", _interpolator(x, y, self.interpolation))

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled by its data: the interpolator is made again."""
        return _table, (self.times, self.values, self.interpolation)

    value = _without_inputs
    cycle: ClassVar[float] = inf

    def kinks(self, end: float) -> FloatArray:
        """Its times; of a spline, which is smooth inside, the first and the last."""
        times = np.array(self.times)
        return _within(times[[0, -1]] if self.interpolation == "cubic" else times, end)

    @property
    def constant(self) -> bool:
        """True if all values are equal."""
        return len(set(self.values)) == 1

    def __call__(self, t: float, s: Value = 0.0) -> Value:
        """The interpolated value."""
        return _spread(self._lookup(t), s)


def _table(times: tuple[float, ...], values: tuple[float, ...], interpolation: Interpolation) -> Table:
    return Table(times=times, values=values, interpolation=interpolation)


def _interpolator(x: FloatArray, y: FloatArray, interpolation: Interpolation) -> Callable[[float], Any]:
    if interpolation == "step":
        return lambda t: y[max(int(np.searchsorted(x, t, side="right")) - 1, 0)]
    if interpolation == "cubic" and len(x) > 2:
        from scipy.interpolate import CubicSpline

        spline = CubicSpline(x, y, bc_type="natural")
        return lambda t: spline(min(max(t, x[0]), x[-1]))
    return lambda t: np.interp(t, x, y)


@frozen(kw_only=True)
class Ramp:
    """``before`` until ``start``, then straight to ``after`` at ``end``, and held."""

    before: float
    after: float
    start: float
    end: float

    value = _without_inputs
    cycle: ClassVar[float] = inf

    def kinks(self, end: float) -> FloatArray:
        """Its start and end."""
        return _within(np.array([self.start, self.end]), end)

    @property
    def constant(self) -> bool:
        """True if the ramp goes nowhere."""
        return self.before == self.after

    def __call__(self, t: float, s: Value = 0.0) -> Value:
        """The value on the ramp."""
        part = min(max((t - self.start) / (self.end - self.start), 0.0), 1.0)
        return _spread(self.before + (self.after - self.before) * part, s)


def _cycle(frequency: float) -> float:
    """Period of a frequency [Hz]."""
    return 1.0 / abs(frequency) if frequency else inf


@frozen(kw_only=True)
class Sine:
    """``offset + amplitude sin(2 pi frequency t + phase)``; frequency [Hz], phase [rad]."""

    amplitude: float
    frequency: float
    phase: float = 0.0
    offset: float = 0.0

    value = _without_inputs
    kinks = _no_kinks

    @property
    def cycle(self) -> float:
        """One over the frequency."""
        return _cycle(self.frequency)

    @property
    def constant(self) -> bool:
        """True without amplitude."""
        return self.amplitude == 0.0

    def __call__(self, t: float, s: Value = 0.0) -> Value:
        """The value of the wave."""
        angle = 2 * np.pi * self.frequency * t + self.phase
        return _spread(self.offset + self.amplitude * np.sin(angle), s)


@frozen(kw_only=True)
class Sawtooth:
    """``offset + amplitude sawtooth(2 pi frequency t + phase, width)``, see :mod:`.waves`."""

    amplitude: float
    frequency: float
    phase: float = 0.0
    offset: float = 0.0
    width: float = 1.0

    value = _without_inputs

    @property
    def cycle(self) -> float:
        """One over the frequency."""
        return _cycle(self.frequency)

    def kinks(self, end: float) -> FloatArray:
        """Where it turns round or jumps."""
        if not self.frequency:
            return np.empty(0)
        first = self.phase / (2 * np.pi)
        last = first + self.frequency * end
        whole = np.arange(np.floor(min(first, last)), np.ceil(max(first, last)) + 1.0)
        turns = np.concatenate((whole, whole + self.width))
        return _within((turns - first) / self.frequency, end)

    @property
    def constant(self) -> bool:
        """True without amplitude."""
        return self.amplitude == 0.0

    def __call__(self, t: float, s: Value = 0.0) -> Value:
        """The value of the wave."""
        angle = 2 * np.pi * self.frequency * t + self.phase
        return _spread(self.offset + self.amplitude * sawtooth(angle, self.width), s)


@frozen
class Expression:
    """Arithmetic text of ``t`` and ``s``, see :func:`.expression.compile_expression`.

    Attributes:
        text: The text.
        places: More variables, each an array of the shape of ``s``: where the value is asked for.

    Raises:
        ExpressionError: if the text is not arithmetic.
    """

    text: str
    places: Mapping[str, FloatArray] = field(default_factory=dict, repr=False)
    _compiled: Compiled = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_compiled", compile_expression(self.text, (*VARIABLES, *self.places)))

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled by its text: closures cannot be."""
        return Expression, (self.text, self.places)

    value = _without_inputs
    kinks = _no_kinks
    cycle: ClassVar[float] = inf

    @property
    def constant(self) -> bool:
        """True if ``t`` does not occur."""
        return "t" not in self._compiled.variables

    def __call__(self, t: float, s: Value = 0.0) -> Value:
        """The value.

        Raises:
            LawError: if it is not finite there, such as ``log(t)`` at 0.
        """
        with np.errstate(all="ignore"):
            value = _spread(self._compiled.program({"t": t, "s": s, **self.places}), s)
        if not np.isfinite(value).all():
            raise LawError(f"the expression {self.text!r} has no finite value at t = {t:g} s")
        return value
