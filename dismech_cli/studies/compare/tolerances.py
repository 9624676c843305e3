"""How far two runs may be apart: for all quantities, or for one by its name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, Literal

from ...errors import ScenarioError
from ...frozen import frozen
from ...quantities import QuantityError, parse_quantity, with_unit
from ...units import KINDS, Kind
from ...words import hint

_RATIO: Final = KINDS["ratio"]


@frozen
class Tolerance:
    """Greatest difference.

    Attributes:
        size: Of the scale of the quantity where ``kind`` is relative, else in its unit.
        kind: ``relative`` or ``absolute``.
    """

    size: float
    kind: Literal["relative", "absolute"] = "relative"

    def allows(self, difference: float, scale: float) -> bool:
        """Whether a difference of a quantity of some size is small enough; never for NaN."""
        return difference <= self.size * (scale if self.kind == "relative" else 1.0)

    def told(self, unit: str) -> str:
        """In words."""
        if self.kind == "absolute":
            return with_unit(f"{self.size:.6g}", unit)
        return f"{100.0 * self.size:.6g} %"


def tolerances(texts: Sequence[str], units: Mapping[str, str]) -> dict[str, Tolerance]:
    """The tolerance of each quantity; zero where none is given.

    Args:
        texts: ``1e-6`` or ``1 %`` for all, ``NAME=1e-6`` or ``NAME='1 um'`` for one; the last wins.
        units: Unit of each quantity by name.

    Raises:
        ScenarioError: A text is no tolerance, or there is no such quantity.
    """
    given = dict.fromkeys(units, Tolerance(0.0))
    for text in texts:
        name, equals, value = text.rpartition("=")
        name = name.strip()
        if not equals:
            given = dict.fromkeys(units, _read(text, value, None))
        elif name not in units:
            raise ScenarioError(f"--tol {text!r}: the runs have no {name!r}{hint(name, units)}")
        else:
            given[name] = _read(text, value, units[name])
    return given


def _read(text: str, value: str, unit: str | None) -> Tolerance:
    """A tolerance: without a unit it is a ratio."""
    try:
        size, kind = parse_quantity(value, _RATIO), "relative"
    except QuantityError as error:
        measured = next((one for one in KINDS.values() if one.unit == unit), None)
        if measured is None or unit in (None, "1"):
            raise ScenarioError(f"--tol {text!r}: {error}") from None
        size, kind = _quantity(text, value, measured), "absolute"
    if size < 0.0:
        raise ScenarioError(f"--tol {text!r}: a tolerance must not be negative")
    return Tolerance(size, "relative" if kind == "relative" else "absolute")


def _quantity(text: str, value: str, kind: Kind) -> float:
    try:
        return parse_quantity(value, kind)
    except QuantityError as error:
        raise ScenarioError(f"--tol {text!r}: {error}, or a ratio") from None
