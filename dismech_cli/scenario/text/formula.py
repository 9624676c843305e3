"""Arithmetic on numbers with units and parameters: ``2*$radius``, ``$E / 3``, ``${n + 1}``; never ``eval``.

A unit belongs to the number before it and binds first: ``1 / 2 mm`` is one over two millimetres.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from typing import Any, Final, TypeAlias

from ...quantities import QuantityError, name_of, read_quantity
from ...units import Dimension
from ...words import hint
from .amount import Amount, computable

MAX_LENGTH: Final = 1000
_MAX_DEPTH: Final = 50
_MAX_POWER: Final = 16
_RATIO: Final = Dimension()
_ANGLE: Final = Dimension(rad=1)

Names: TypeAlias = Callable[[str], Amount]
"""The amount of a parameter; raises KeyError with a reason if there is none."""

CONSTANTS: Final = {"pi": math.pi, "e": math.e}
_UNIT: Final = r"(?!(?:pi|e)(?![A-Za-z]))(?:[A-Za-zµμ]+|%|°)(?![A-Za-zµμ_]|\s*\()"
_POWER: Final = r"(?:\s*(?:\^|\*\*)\s*[-+]?\d{1,2}|[²³]|-?[1-9](?![\d.]))?"
_FACTOR: Final = rf"(?:{_UNIT}){_POWER}"
_MORE: Final = (
    rf"(?:\s*[*/·]\s*{_FACTOR}|[ \t]+{_FACTOR}|\s*/\s*\(\s*{_FACTOR}(?:\s*[*/·]\s*{_FACTOR})*\s*\))*"
)
_NUMBER: Final = re.compile(
    rf"(?P<number>(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?)(?P<unit>\s*{_FACTOR}{_MORE})?"
)
_TOKEN: Final = re.compile(
    r"\$(?P<parameter>[A-Za-z_][A-Za-z0-9_]*)|\$\{(?P<braces>[^{}$]*)\}"
    r"|(?P<name>[A-Za-z_][A-Za-z0-9_]*)|(?P<operator>\*\*|[-+*/(),])"
)


class FormulaError(ValueError):
    """A text that is no formula; the message says why."""


def evaluate(text: str, names: Names) -> Amount:
    """What a formula comes to.

    Args:
        text: The formula; parameters as ``$name`` or ``${name}``. In braces they go by bare names, beside
            plain numbers: ``${n + 1}``.
        names: Amounts of parameters.

    Raises:
        FormulaError: It cannot be read, or has no value.
    """
    if len(text) > MAX_LENGTH:
        raise FormulaError(f"longer than {MAX_LENGTH} characters")
    return _Reader(text, names).whole()


def evaluate_bare(text: str, names: Names) -> Amount:
    """What the text between the braces of ``${n + 1}`` comes to: names are parameters, numbers have no units.

    Raises:
        FormulaError: It cannot be read, or has no value.
    """
    return _BareReader(text, names).whole()


class _Reader:
    """Reads from left to right, and computes on the way."""

    number = _NUMBER

    def __init__(self, text: str, names: Names) -> None:
        self.text, self.names = text, names
        self.at = 0
        self.depth = 0
        self.token: re.Match[str] | None = None
        self._advance()

    def whole(self) -> Amount:
        amount = self._sum()
        if self.token is not None:
            raise self._unread()
        return amount

    def _advance(self) -> None:
        while self.at < len(self.text) and self.text[self.at].isspace():
            self.at += 1
        if self.at == len(self.text):
            self.token = None
            return
        self.token = self.number.match(self.text, self.at) or _TOKEN.match(self.text, self.at)
        if self.token is None:
            raise FormulaError(f"cannot read {self.text[self.at : self.at + 12]!r}")
        self.at = self.token.end()

    def _operator(self) -> str:
        found = None if self.token is None else self.token.groupdict().get("operator")
        return found or ""

    def _sum(self) -> Amount:
        self.depth += 1
        if self.depth > _MAX_DEPTH:
            raise FormulaError(f"nested deeper than {_MAX_DEPTH}")
        total = self._product()
        while (operator := self._operator()) in ("+", "-"):
            self._advance()
            total = _added(total, self._product(), 1 if operator == "+" else -1)
        self.depth -= 1
        return total

    def _product(self) -> Amount:
        product = self._signed()
        while (operator := self._operator()) in ("*", "/"):
            self._advance()
            product = _multiplied(product, self._signed(), 1 if operator == "*" else -1)
        return product

    def _signed(self) -> Amount:
        sign = 1
        while (operator := self._operator()) in ("+", "-"):
            self._advance()
            sign = -sign if operator == "-" else sign
        amount = self._power()
        return amount if sign > 0 else Amount(-amount.value, amount.dimension)

    def _power(self) -> Amount:
        base = self._primary()
        if self._operator() != "**":
            return base
        self._advance()
        self.depth += 1
        if self.depth > _MAX_DEPTH:
            raise FormulaError(f"nested deeper than {_MAX_DEPTH}")
        exponent = self._signed()
        self.depth -= 1
        return _raised(base, exponent)

    def _primary(self) -> Amount:
        if self.token is None:
            raise FormulaError("the formula ends too early")
        found = self.token.groupdict()
        if found.get("number"):
            return self._quantity(found["number"], found.get("unit"))
        if found.get("parameter"):
            return self._parameter(found["parameter"])
        if found.get("braces") is not None:
            self._advance()
            return evaluate_bare(found["braces"], self.names)
        if found.get("name"):
            return self._named(found["name"])
        if found.get("operator") == "(":
            self._advance()
            amount = self._sum()
            self._close()
            return amount
        raise self._unread()

    def _quantity(self, number: str, unit: str | None) -> Amount:
        self._advance()
        if unit:
            try:
                return Amount(*read_quantity(number + unit))
            except QuantityError as error:
                raise FormulaError(str(error)) from None
        whole = number.isdigit()
        return _sound(Amount(int(number) if whole else float(number)))

    def _parameter(self, name: str) -> Amount:
        self._advance()
        try:
            return self.names(name)
        except KeyError as error:
            raise FormulaError(str(error.args[0])) from None

    def _named(self, name: str) -> Amount:
        self._advance()
        if self._operator() == "(":
            return self._call(name)
        if name in CONSTANTS:
            return Amount(CONSTANTS[name])
        raise FormulaError(f"unknown name {name!r}; a parameter is written ${name}")

    def _call(self, name: str) -> Amount:
        if name not in FUNCTIONS:
            raise FormulaError(f"unknown function {name!r}{hint(name, FUNCTIONS)}")
        function, least, most = FUNCTIONS[name]
        self._advance()
        arguments = [self._sum()]
        while self._operator() == ",":
            self._advance()
            arguments.append(self._sum())
        self._close()
        if not least <= len(arguments) <= most:
            raise FormulaError(f"{name} takes {least} to {most} arguments, got {len(arguments)}")
        return _sound(function(name, *arguments))

    def _close(self) -> None:
        if self._operator() != ")":
            raise FormulaError("a bracket is not closed" if self.token is None else str(self._unread()))
        self._advance()

    def _unread(self) -> FormulaError:
        assert self.token is not None
        return FormulaError(f"cannot read {self.text[self.token.start() : self.token.start() + 12]!r}")


class _BareReader(_Reader):
    """Between braces."""

    number = re.compile(r"(?P<number>(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?)")

    def _named(self, name: str) -> Amount:
        if name in CONSTANTS or self.text[self.at :].lstrip().startswith("("):
            return super()._named(name)
        return self._parameter(name)


def _sound(amount: Amount) -> Amount:
    if not computable(amount):
        raise FormulaError("comes to no number that can be computed with")
    return amount


def _added(a: Amount, b: Amount, sign: int) -> Amount:
    return _sound(Amount(a.value + sign * b.value, _common("add", a, b)))


def _common(verb: str, *amounts: Amount) -> Dimension | None:
    """The dimension that all have; a number without a unit goes with ratios."""
    dimensions = {amount.dimension for amount in amounts}
    if dimensions == {None, _RATIO}:
        return _RATIO
    if len(dimensions) > 1:
        first, second = list(dict.fromkeys(amount.dimension for amount in amounts))[:2]
        raise FormulaError(f"cannot {verb} {_called(first)} and {_called(second)}")
    return amounts[0].dimension


def _called(dimension: Dimension | None) -> str:
    return "a number without a unit" if dimension is None else name_of(dimension)


def _multiplied(a: Amount, b: Amount, sign: int) -> Amount:
    dimension = None
    if a.dimension is not None or b.dimension is not None:
        dimension = (a.dimension or _RATIO).times(b.dimension or _RATIO, sign)
    if sign > 0:
        return _sound(Amount(a.value * b.value, dimension))
    if b.value == 0:
        raise FormulaError("divides by zero")
    return _sound(Amount(a.value / b.value, dimension))


def _raised(base: Amount, exponent: Amount) -> Amount:
    power = exponent.value
    if not exponent.plain or abs(power) > _MAX_POWER:
        raise FormulaError(f"an exponent is a plain number of at most {_MAX_POWER} in size")
    dimension = base.dimension
    if dimension is not None and any(dimension):
        if float(power) != int(power):
            raise FormulaError(f"the power {power:g} of {name_of(dimension)} has no unit")
        dimension = _RATIO.times(dimension, int(power))
    try:
        value = base.value**power
    except (OverflowError, ZeroDivisionError):
        value = math.inf
    if isinstance(value, complex):
        raise FormulaError("a broken power of a negative number")
    return _sound(Amount(value, dimension))


def _root(_: str, a: Amount) -> Amount:
    if a.value < 0:
        raise FormulaError("the root of a negative number")
    powers = a.dimension or ()
    if any(power % 2 for power in powers):
        raise FormulaError(f"the root of {_called(a.dimension)} has no unit")
    dimension = None if a.dimension is None else Dimension(*(power // 2 for power in powers))
    return Amount(math.sqrt(a.value), dimension)


def _size(_: str, a: Amount) -> Amount:
    return Amount(abs(a.value), a.dimension)


def _extreme(name: str, *amounts: Amount) -> Amount:
    dimension = _common("compare", *amounts)
    values = [amount.value for amount in amounts]
    return Amount(min(values) if name == "min" else max(values), dimension)


_TRIGONOMETRY: Final[Mapping[str, Callable[[float], float]]] = {
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
}


def _wave(name: str, a: Amount) -> Amount:
    if not a.plain and a.dimension != _ANGLE:
        raise FormulaError(f"{name} takes an angle, got {_called(a.dimension)}")
    return Amount(_TRIGONOMETRY[name](a.value), None if a.dimension is None else _RATIO)


_OF_NUMBERS: Final[Mapping[str, Callable[[float], float]]] = {"exp": math.exp, "log": math.log}


def _number(name: str, a: Amount) -> Amount:
    if not a.plain:
        raise FormulaError(f"{name} takes a plain number, got {_called(a.dimension)}")
    try:
        return Amount(_OF_NUMBERS[name](a.value), a.dimension)
    except (OverflowError, ValueError):
        raise FormulaError(f"{name} of {a.value:g} is no number") from None


_WHOLE: Final[Mapping[str, Callable[[float], int]]] = {
    "round": round,
    "floor": math.floor,
    "ceil": math.ceil,
}


def _whole(name: str, a: Amount) -> Amount:
    """A count: a whole number without a unit."""
    if not a.plain:
        raise FormulaError(f"{name} takes a plain number, got {_called(a.dimension)}")
    return Amount(_WHOLE[name](a.value))


# name: (function, least and most arguments)
FUNCTIONS: Final[Mapping[str, tuple[Callable[..., Any], int, int]]] = {
    "sqrt": (_root, 1, 1),
    "abs": (_size, 1, 1),
    "min": (_extreme, 2, 8),
    "max": (_extreme, 2, 8),
    **{name: (_wave, 1, 1) for name in _TRIGONOMETRY},
    **{name: (_number, 1, 1) for name in _OF_NUMBERS},
    **{name: (_whole, 1, 1) for name in _WHOLE},
}
