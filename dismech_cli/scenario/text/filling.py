"""Formulas and counted names in a text: what stands in them for a parameter is put in its place."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import field
from typing import Final, TypeAlias

from ...frozen import frozen
from .amount import Amount
from .formula import FormulaError, evaluate
from .parameters import INDEX, Parameter, unknown

_PART: Final = re.compile(r"\$\$|\$\{[^{}$]*\}|\$[A-Za-z_][A-Za-z0-9_]*|\$")
_IN_NAME: Final = re.compile(r"[A-Za-z0-9_.](?:\$\$)*\$(?!\$)")
_Shown: TypeAlias = Callable[[Amount], str]


@frozen
class Filling:
    """Parameters, in one copy of a repeated entry or outside of any, and what a text met of them.

    Attributes:
        parameters: All that a scenario declares.
        index: Which copy it is; None outside of repeated entries.
        met: By name, each parameter that was met, as it is told.
        used: Names of these parameters; several fillings add to one set.
    """

    parameters: Mapping[str, Parameter]
    index: int | None
    used: set[str]
    met: dict[str, str] = field(default_factory=dict)

    def arithmetic(self, text: str) -> str:
        """An expression whose parameters stand as numbers in SI units."""
        return self._filled(text, lambda amount: f"({amount.value!r})")

    def name(self, text: str) -> str:
        """A name or path with the numbers of its copy.

        Raises:
            FormulaError: if it is in no copy, or takes what is no whole number.
        """
        if "$" not in text.replace("$$", ""):
            return text.replace("$$", "$")
        if self.index is None:
            raise FormulaError("a name or path takes no parameters; a dollar sign is written $$")
        return self._filled(text, _counted)

    def amount(self, text: str) -> Amount:
        """What a formula comes to.

        Raises:
            FormulaError: if it cannot be read or computed.
        """
        return evaluate(text, self._parameter)

    def _filled(self, text: str, shown: _Shown) -> str:
        """A text whose parameters are replaced one by one."""

        def one(match: re.Match[str]) -> str:
            part = match[0]
            if part == "$$":
                return "$"
            if part == "$":
                raise FormulaError("a name in letters must follow '$'; a dollar sign is written $$")
            return shown(self.amount(part))

        return _PART.sub(one, text)

    def _parameter(self, name: str) -> Amount:
        if name == INDEX and self.index is not None:
            self.met[name] = f"{INDEX} = {self.index}"
            return Amount(self.index)
        if name not in self.parameters:
            raise KeyError(unknown(name, self.parameters))
        parameter = self.parameters[name]
        self.used.add(name)
        self.met[name] = f"{name} = {parameter.amount} at {parameter.origin}"
        return parameter.amount


def is_name(text: str) -> bool:
    """Whether a dollar sign follows a letter, a digit, ``_`` or ``.``: a name that is counted, no formula."""
    return _IN_NAME.search(text) is not None


def _counted(amount: Amount) -> str:
    number = amount.scalar()
    if not isinstance(number, int):
        raise FormulaError(f"a name takes whole numbers, got {amount}")
    return str(number)
