"""Whoever has memory saves itself: what a checkpoint is made of."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol, Self, TypeAlias, TypeVar

from ..arrays import FloatArray

Arrays: TypeAlias = Mapping[str, FloatArray]
Numbers: TypeAlias = Mapping[str, int | float]

_V = TypeVar("_V")


class Saved(Protocol):
    """Something that a resumed run must find as it was."""

    def arrays(self) -> Arrays:
        """Its arrays by name."""

    def numbers(self) -> Numbers:
        """Its numbers by name."""

    def restore(self, arrays: Arrays, numbers: Numbers) -> Self:
        """As it was when these were saved: a new one if it is frozen, itself otherwise.

        Raises:
            KeyError: One of its names is missing.
        """


def save_all(parts: Mapping[str, Saved]) -> tuple[dict[str, FloatArray], dict[str, int | float]]:
    """Arrays and numbers of all parts, each name led by that of its part and a dot."""
    arrays = {f"{part}.{name}": x for part, saved in parts.items() for name, x in saved.arrays().items()}
    numbers = {f"{part}.{name}": x for part, saved in parts.items() for name, x in saved.numbers().items()}
    return arrays, numbers


def restore_all(parts: Mapping[str, Saved], arrays: Arrays, numbers: Numbers) -> dict[str, Saved]:
    """The parts as :func:`save_all` found them.

    Raises:
        KeyError: Something of a part is missing.
    """
    return {name: part.restore(within(name, arrays), within(name, numbers)) for name, part in parts.items()}


def within(part: str, values: Mapping[str, _V]) -> dict[str, _V]:
    """The values whose names are led by that of a part, under the rest of their names."""
    lead = f"{part}."
    return {name.removeprefix(lead): value for name, value in values.items() if name.startswith(lead)}
