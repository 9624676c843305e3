"""Quantities as text: ``2 MPa``, ``1.2 g/cm^3``, ``30 deg``; a small table of units, no evaluation."""

from __future__ import annotations

import math
import re
from typing import Final

from .units import KINDS, UNITS, Dimension, Kind
from .words import hint

MAX_TEXT: Final = 80
MAX_EXPONENT: Final = 9

_NUMBER = re.compile(r"\s*([-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?)")
_TOKEN = re.compile(
    r"\s*(?:(?P<power>\*\*|\^)\s*(?P<exponent>[-+]?\d{1,2})(?!\d)"
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
    value, dimension = read_quantity(text)
    if dimension is not None and dimension not in (kind.dimension, *kind.also):
        raise QuantityError(f"expected {wanted}, got {name_of(dimension)}, '{text.strip()}'")
    return value


def read_quantity(text: str) -> tuple[float, Dimension | None]:
    """Value in SI and dimension of ``text``; the dimension is None if there is no unit.

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
    factor, dimension = _Units(unit, shown).read() if unit else (1.0, None)
    value = float(number[1]) * factor
    if not math.isfinite(value):
        raise QuantityError(f"'{shown}' is too large")
    return value, dimension


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

    def __init__(self, unit: str, shown: str) -> None:
        self.shown = shown
        self.tokens = self._tokens(unit)
        self.at = 0

    def _tokens(self, unit: str) -> list[tuple[str, str]]:
        tokens, position = [], 0
        while position < len(unit):
            match = _TOKEN.match(unit, position)
            if match is None:
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
            factor, dimension = factor * value**sign, dimension.times(other, sign)
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
        return factor**exponent, Dimension().times(dimension, exponent)

    def _exponent(self) -> int:
        kind, text = self._peek()
        if kind not in ("exponent", "superscript"):
            return 1
        self.at += 1
        exponent = {"²": 2, "³": 3}.get(text) or int(text)
        if abs(exponent) > MAX_EXPONENT:
            raise QuantityError(f"exponent too large in '{self.shown}'")
        return exponent

    def _unit(self, name: str) -> tuple[float, Dimension]:
        if name not in UNITS:
            raise QuantityError(f"unknown unit '{name}' in '{self.shown}'{hint(name, UNITS)}")
        return UNITS[name]

    def _unclear(self) -> QuantityError:
        return QuantityError(f"cannot read the unit of '{self.shown}'")
