"""Regular expressions of quantities as text: what an editor can tell of a unit and a sign.

Units of one factor or two are checked for their dimension, longer ones only for being made of known units.
Lengths, times, angles and masses have names of their own: products that come to one are not taken, though the
loader would.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from itertools import product
from typing import Final

from ...units import KINDS, UNITS, Dimension

_MANTISSA: Final = r"(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?(?![\d.])"
_POWERS: Final = (1, 2, 3, 4, -1, -2, -3, -4)
# Lengths and the like have names of their own: nobody writes them as products.
_PLAIN: Final = frozenset({"ratio", "length", "time", "angle", "mass"})


@cache
def quantity_text(name: str) -> str:
    """What text a quantity may be, a key of :data:`.units.KINDS`, whatever its sign."""
    return rf"^\s*[-+]?{_MANTISSA}\s*(?:{_units(name)})?\s*$"


NOT_NEGATIVE: Final = r"^\s*(?!-)"
"""Begin of text that is no negative quantity."""

POSITIVE: Final = r"^\s*\+?(?=[\d.]*[1-9])"
"""Begin of text that is a quantity above zero."""


@cache
def _units(name: str) -> str:
    wanted = {KINDS[name].dimension, *KINDS[name].also}
    forms = list(_single(wanted))
    if name not in _PLAIN:
        forms += _double(wanted)
        token = "|".join(map(re.escape, UNITS))
        factor = rf"\(*(?:{token}){_ANY_POWER}\)*{_ANY_POWER}"
        forms.append(rf"/?\s*{factor}(?:(?:\s*[*/·]\s*|\s+){factor}){{2,}}")
    return "|".join(forms)


_ANY_POWER: Final = r"(?:\s*(?:\^|\*\*)\s*[-+]?\d{1,2}|[²³]|-?[1-9])?"


@cache
def _names() -> dict[Dimension, str]:
    """Units of each dimension."""
    found: dict[Dimension, list[str]] = defaultdict(list)
    for unit, (_, dimension) in UNITS.items():
        found[dimension].append(re.escape(unit))
    return {dimension: f"(?:{'|'.join(units)})" for dimension, units in found.items()}


def _single(wanted: set[Dimension]) -> Iterator[str]:
    """Units of one factor whose dimension is wanted, under a stroke or not."""
    for a, names in _names().items():
        for p in _POWERS:
            if _power(a, p) in wanted and (any(a) or p == 1):
                yield rf"{names}{_exponent(p)}"
            if p > 0 and any(a) and _power(a, -p) in wanted:
                yield rf"1?\s*/\s*{names}{_exponent(p)}"


def _double(wanted: set[Dimension]) -> Iterator[str]:
    """Units of two factors, neither of them a plain number, whose dimension is wanted."""
    physical = {dimension: names for dimension, names in _names().items() if any(dimension)}
    for (a, first), p in product(physical.items(), _POWERS):
        for (b, second), r in product(physical.items(), _POWERS):
            if _power(a, p).times(b, r) in wanted:
                yield rf"{first}{_exponent(p)}(?:\s*[*·]\s*|\s+){second}{_exponent(r)}"
            if r > 0 and _power(a, p).times(b, -r) in wanted:
                yield rf"{first}{_exponent(p)}\s*/\s*{second}{_exponent(r)}"


def _power(dimension: Dimension, power: int) -> Dimension:
    return Dimension().times(dimension, power)


def _exponent(power: int) -> str:
    if power == 1:
        return r"(?:\s*(?:\^|\*\*)\s*\+?1|1)?"
    short = {2: "|²", 3: "|³"}.get(power, "")
    sign = r"\+?" if power > 0 else ""
    return rf"(?:\s*(?:\^|\*\*)\s*{sign}{power}|{power}{short})"
