"""Quantities as text: ``2 MPa``, ``1.2 g/cm^3``, ``30 deg``; a small table, no evaluation.

A dimension is the exponents of metre, kilogram, second and radian. The radian counts as a
dimension so that an angle cannot pass for a plain ratio, nor rad/s for Hz.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Final, NamedTuple

from .words import hint

MAX_TEXT: Final = 80
MAX_EXPONENT: Final = 9


class Dimension(NamedTuple):
    """Exponents of the base units."""

    m: int = 0
    kg: int = 0
    s: int = 0
    rad: int = 0

    def times(self, other: Dimension, power: int = 1) -> Dimension:
        """This dimension multiplied by ``other ** power``."""
        return Dimension(*(a + power * b for a, b in zip(self, other, strict=True)))


@dataclass(frozen=True, slots=True)
class Kind:
    """A physical quantity that a key of the scenario may ask for.

    Attributes:
        phrase: With its article, for messages: "a pressure".
        unit: SI unit as written, ``"1"`` if a plain number.
        dimension: Exponents of the base units.
        also: Other dimensions taken for it.
    """

    phrase: str
    unit: str
    dimension: Dimension
    also: tuple[Dimension, ...] = ()


KINDS: Final[dict[str, Kind]] = {
    "ratio": Kind("a plain number", "1", Dimension()),
    "length": Kind("a length", "m", Dimension(m=1)),
    "area": Kind("an area", "m^2", Dimension(m=2)),
    "torsion constant": Kind("a torsion constant", "m^4", Dimension(m=4)),
    "time": Kind("a time", "s", Dimension(s=1)),
    "frequency": Kind("a frequency", "Hz", Dimension(s=-1)),
    "angle": Kind("an angle", "rad", Dimension(rad=1)),
    "curvature": Kind("a curvature", "1/m", Dimension(m=-1), (Dimension(m=-1, rad=1),)),
    "twist rate": Kind("a twist per length", "rad/m", Dimension(m=-1, rad=1), (Dimension(m=-1),)),
    "velocity": Kind("a velocity", "m/s", Dimension(m=1, s=-1)),
    "angular velocity": Kind("an angular velocity", "rad/s", Dimension(s=-1, rad=1)),
    "acceleration": Kind("an acceleration", "m/s^2", Dimension(m=1, s=-2)),
    "mass": Kind("a mass", "kg", Dimension(kg=1)),
    "density": Kind("a density", "kg/m^3", Dimension(m=-3, kg=1)),
    "mass per length": Kind("a mass per length", "kg/m", Dimension(m=-1, kg=1)),
    "inertia per length": Kind("a rotary inertia per length", "kg*m", Dimension(m=1, kg=1)),
    "force": Kind("a force", "N", Dimension(1, 1, -2)),
    "force per length": Kind("a force per length", "N/m", Dimension(0, 1, -2)),
    "pressure": Kind("a pressure", "Pa", Dimension(-1, 1, -2)),
    "moment": Kind("a moment", "N*m", Dimension(2, 1, -2), (Dimension(2, 1, -2, -1),)),
    "moment per length": Kind("a moment per length", "N*m/m", Dimension(1, 1, -2)),
    "energy": Kind("an energy", "J", Dimension(2, 1, -2)),
    "bending stiffness": Kind("a bending stiffness", "N*m^2", Dimension(3, 1, -2)),
    "damping per area": Kind("a damping per area", "N*s/m^3", Dimension(-2, 1, -1)),
    "viscosity": Kind("a viscous coefficient", "N*s/m^2", Dimension(-1, 1, -1)),
}

_NEWTON = KINDS["force"].dimension
_PASCAL = KINDS["pressure"].dimension
_JOULE = KINDS["energy"].dimension

_PREFIXES: Final = {
    "n": 1e-9,
    "u": 1e-6,
    "µ": 1e-6,
    "μ": 1e-6,
    "m": 1e-3,
    "": 1.0,
    "k": 1e3,
    "M": 1e6,
    "G": 1e9,
    "T": 1e12,
}
_PREFIXED: Final[dict[str, tuple[float, Dimension]]] = {
    "m": (1.0, Dimension(m=1)),
    "g": (1e-3, Dimension(kg=1)),
    "s": (1.0, Dimension(s=1)),
    "N": (1.0, _NEWTON),
    "Pa": (1.0, _PASCAL),
    "J": (1.0, _JOULE),
    "W": (1.0, Dimension(2, 1, -3)),
    "Hz": (1.0, Dimension(s=-1)),
    "rad": (1.0, Dimension(rad=1)),
}
UNITS: Final[dict[str, tuple[float, Dimension]]] = {
    **{p + u: (f * v, d) for u, (v, d) in _PREFIXED.items() for p, f in _PREFIXES.items()},
    "cm": (1e-2, Dimension(m=1)),
    "dm": (1e-1, Dimension(m=1)),
    "min": (60.0, Dimension(s=1)),
    "h": (3600.0, Dimension(s=1)),
    "bar": (1e5, _PASCAL),
    "deg": (math.pi / 180, Dimension(rad=1)),
    "°": (math.pi / 180, Dimension(rad=1)),
    "%": (1e-2, Dimension()),
    "1": (1.0, Dimension()),
}

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
