"""A number with what it measures, as formulas compute it."""

from __future__ import annotations

from typing import Final

from ...frozen import frozen
from ...units import KINDS, Dimension

_LARGEST: Final = 1e300
_MAX_EXPONENT: Final = 9
_WHOLE: Final = 2**53


@frozen
class Amount:
    """A number in SI units.

    Attributes:
        value: The number; an int where only whole numbers went into it.
        dimension: What it measures; None for a number without a unit, which is whatever its place asks for.
    """

    value: int | float
    dimension: Dimension | None = None

    @property
    def plain(self) -> bool:
        """Whether it is a number without a unit, or a ratio."""
        return self.dimension is None or not any(self.dimension)

    @property
    def unit(self) -> str:
        """Its unit, ``1`` of a ratio; empty for a number without one."""
        if self.dimension is None:
            return ""
        named = (kind.unit for kind in KINDS.values() if kind.dimension == self.dimension)
        factors = (f"{name}^{power}" for name, power in self.dimension._asdict().items() if power)
        return next(named, None) or "*".join(factors)

    def scalar(self) -> int | float | str:
        """As a scenario would write it: a whole number as such, and a quantity with its unit."""
        if self.dimension is not None:
            return f"{float(self.value)!r} {self.unit}"
        number = self.value
        if isinstance(number, float) and number.is_integer() and abs(number) < _WHOLE:
            return int(number)
        return number

    def __str__(self) -> str:
        return f"{self.value:g} {self.unit}".rstrip() if self.unit != "1" else f"{self.value:g}"


def computable(amount: Amount) -> bool:
    """Whether its number is finite, and its unit one that can be written."""
    return abs(amount.value) <= _LARGEST and all(
        abs(power) <= _MAX_EXPONENT for power in amount.dimension or ()
    )
