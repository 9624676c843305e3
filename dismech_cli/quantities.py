"""Quantities as text: ``2 MPa``, ``1.2 g/cm^3``, ``30 deg``; a small table of units, no evaluation."""

from __future__ import annotations

import math
import re
from typing import Final

from .units import KINDS, UNITS, Dimension, Kind
from .words import did_you_mean, listed

MAX_TEXT: Final = 80
MAX_EXPONENT: Final = 9

_NUMBER = re.compile(r"\s*([-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?)")
_TOKEN = re.compile(
    r"(?P<digit>(?<=[A-Za-zµμ])-?[1-9](?![\d.]))"
    r"|\s*(?:(?P<power>\*\*|\^)\s*(?P<exponent>[-+]?\d{1,2})(?!\d)"
    r"|(?P<superscript>[²³])"
    r"|(?P<operator>[*/·])"
    r"|(?P<open>\()"
    r"|(?P<close>\))"
    r"|(?P<name>[A-Za-zµμ]+|%|°|1(?!\d)))"
)


class QuantityError(ValueError):
    """A text that is no quantity of the asked kind; the message says why."""


def parse_quantity(text: str, kind: Kind) -> float:
    """The SI value of ``text``, such as ``"1.2 g/cm^3"``; without a unit it is in SI already.

    Raises:
        QuantityError: if the text cannot be read or has another dimension.
    """
    wanted = kind.phrase if kind.unit == "1" else f"{kind.phrase} such as '1 {kind.unit}'"
    if _NUMBER.match(text) is None:
        raise QuantityError(f"expected {wanted}, got '{_short(text)}'")
    value, dimension = read_quantity(text, kind)
    if dimension is not None and dimension not in (kind.dimension, *kind.also):
        raise QuantityError(f"expected {wanted}, got {name_of(dimension)}, '{text.strip()}'")
    return value


def read_quantity(text: str, kind: Kind | None = None) -> tuple[float, Dimension | None]:
    """Value in SI and dimension of ``text``; the dimension is None if there is no unit.

    Args:
        text: A number and a unit.
        kind: What is expected: only its units are suggested for an unknown one.

    Raises:
        QuantityError: if the text is not a number and a unit.
    """
    shown = _short(text)
    if len(text) > MAX_TEXT:
        raise QuantityError(f"cannot read '{shown}' as a quantity")
    number = _NUMBER.match(text)
    if number is None or not text.isprintable():
        raise QuantityError(f"expected a number with a unit such as '2 mm', got '{shown}'")
    unit = text[number.end() :].strip()
    factor, dimension = _Units(unit, shown, _suggested(kind)).read() if unit else (1.0, None)
    value = float(number[1]) * factor
    if not math.isfinite(value):
        raise QuantityError(f"'{shown}' is too large")
    return value, dimension


def _suggested(kind: Kind | None) -> list[str]:
    """Units of a quantity, and of the factors in its SI unit; all where nothing is expected."""
    if kind is None:
        return list(UNITS)
    factors = {UNITS[name][1] for name in re.findall(r"[A-Za-z]+", kind.unit)}
    near = {kind.dimension, *kind.also, *factors}
    return [name for name, (_, dimension) in UNITS.items() if dimension in near]


def _did_you_mean(name: str, known: list[str]) -> str:
    """A hint; where only the case tells several units apart, as with MPa and mPa, all of them."""
    same = [unit for unit in known if unit.lower() == name.lower()]
    if len(same) > 1:
        as_typed = [unit for unit in same if name[0].isupper() and unit[0] == name[0]]
        largest_first = sorted(as_typed or same, key=lambda unit: -UNITS[unit][0])
        return f"; did you mean {listed(largest_first)}?"
    near = did_you_mean(name, known)
    return f"; did you mean {near!r}?" if near else ""


def _short(text: str) -> str:
    shown = text if len(text) <= MAX_TEXT else text[:40] + "..."
    return "".join(c if c.isprintable() else "?" for c in shown)


def name_of(dimension: Dimension) -> str:
    """A phrase such as "a length", or the base units of a dimension without a name."""
    for kind in KINDS.values():
        if kind.dimension == dimension:
            return kind.phrase
    units = (
        f"{unit}^{power}" if power != 1 else unit for unit, power in dimension._asdict().items() if power
    )
    return "a quantity in " + " ".join(units)


def with_unit(number: str, unit: str) -> str:
    """``3 m``; ``3`` where the unit is ``1`` or there is none."""
    return number if unit in ("", "1") else f"{number} {unit}"


class _Units:
    """Reads ``N*s/m^2``: factors joined by ``*``, ``/`` or a blank, with whole powers and brackets."""

    def __init__(self, unit: str, shown: str, suggested: list[str]) -> None:
        self.shown = shown
        self.suggested = suggested
        self.tokens = self._tokens(unit)
        self.at = 0

    def _tokens(self, unit: str) -> list[tuple[str, str]]:
        tokens, position = [], 0
        while position < len(unit):
            match = _TOKEN.match(unit, position)
            if match is None:
                if re.match(r",\d", unit):
                    number = self.shown.replace(",", ".", 1)
                    raise QuantityError(f"'{self.shown}' has a decimal comma; write {number}")
                raise QuantityError(f"cannot read the unit '{unit}' of '{self.shown}'")
            kind = str(match.lastgroup)
            tokens.append((kind, match[kind]))
            position = match.end()
        return tokens

    def read(self) -> tuple[float, Dimension]:
        if self._peek() == ("operator", "/"):  # '2 /m' is read as '2 1/m'
            self.tokens.insert(0, ("name", "1"))
        result = self._product()
        if self.at < len(self.tokens):
            raise self._unclear()
        return result

    def _peek(self) -> tuple[str, str]:
        return self.tokens[self.at] if self.at < len(self.tokens) else ("end", "")

    def _next(self) -> tuple[str, str]:
        token = self._peek()
        self.at += 1
        return token

    def _product(self) -> tuple[float, Dimension]:
        factor, dimension = self._power()
        divided = False
        while (kind := self._peek()[0]) in ("operator", "name", "open"):
            sign = 1
            if kind == "operator":
                sign = -1 if self._next()[1] == "/" else 1
                divided = divided or sign < 0
            elif divided:  # 'N/m s' reads both ways
                raise QuantityError(f"unclear unit in '{self.shown}': write N/(m*s) or N*s/m")
            value, other = self._power()
            factor, dimension = factor * self._to_power(value, sign), dimension.times(other, sign)
        return factor, dimension

    def _power(self) -> tuple[float, Dimension]:
        kind, text = self._next()
        if kind == "open":
            factor, dimension = self._product()
            if self._next()[0] != "close":
                raise self._unclear()
        elif kind == "name":
            factor, dimension = self._unit(text)
        else:
            raise self._unclear()
        exponent = self._exponent()
        return self._to_power(factor, exponent), Dimension().times(dimension, exponent)

    def _to_power(self, factor: float, exponent: int) -> float:
        """``factor ** exponent``, refused where it leaves the range of floating-point numbers."""
        try:
            power = float(factor**exponent)
        except (OverflowError, ZeroDivisionError):
            power = math.inf
        if not 0.0 < power < math.inf:
            raise QuantityError(f"the unit of '{self.shown}' is too large or too small to compute with")
        return power

    def _exponent(self) -> int:
        kind, text = self._peek()
        if kind not in ("exponent", "superscript", "digit"):  # m^3, m³ and m3
            return 1
        self.at += 1
        exponent = {"²": 2, "³": 3}.get(text) or int(text)
        if abs(exponent) > MAX_EXPONENT:
            raise QuantityError(f"exponent too large in '{self.shown}'")
        return exponent

    def _unit(self, name: str) -> tuple[float, Dimension]:
        if name not in UNITS:
            raise QuantityError(
                f"unknown unit '{name}' in '{self.shown}'{_did_you_mean(name, self.suggested)}"
            )
        return UNITS[name]

    def _unclear(self) -> QuantityError:
        return QuantityError(f"cannot read the unit of '{self.shown}'")
