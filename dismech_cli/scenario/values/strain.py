"""Quantities that depend on which strain is meant: a ratio, a curvature, a twist per length or an angle."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any, Final, Literal, TypeAlias

from pydantic_core import core_schema

from ...frozen import frozen
from ...units import KINDS, Kind
from .quantity import Quantity

Strain: TypeAlias = Literal["stretch", "curvature_1", "curvature_2", "twist", "dihedral", "surface_curvature"]

KIND_OF: Final[Mapping[str, str]] = {
    "stretch": "ratio",
    "curvature_1": "curvature",
    "curvature_2": "curvature",
    "twist": "twist rate",
    "dihedral": "angle",
    "surface_curvature": "curvature",
}
"""The quantity of each strain: a key of :data:`.units.KINDS`."""

ANY, ANY_RATE = "strain", "strain rate"

_HERE: ContextVar[str] = ContextVar("strain", default=ANY)


@contextmanager
def measured_in(strain: object) -> Iterator[None]:
    """Read quantities of strain as those of a strain by its name; as any if there is none of that name."""
    token = _HERE.set(KIND_OF.get(strain, ANY) if isinstance(strain, str) else ANY)
    try:
        yield
    finally:
        _HERE.reset(token)


def kind_here(name: str) -> Kind:
    """What a quantity is where it stands: only those of strain depend on that."""
    here = _HERE.get()
    if name == ANY:
        return KINDS[here]
    if name == ANY_RATE and here != ANY:
        return KINDS[f"rate of {here}"]
    return KINDS[name]


@frozen
class StrainQuantity(Quantity):
    """Marks a float as a strain, or a rate of it, of the kind that the mapping around it is about."""

    @property
    def kind(self) -> Kind:
        """Phrase, unit and dimension here."""
        return kind_here(self.name)


def read_within(key: str, value: Any, inner: core_schema.ValidatorFunctionWrapHandler) -> Any:
    """Validate a mapping whose quantities of strain are those of the strain that it names under ``key``."""
    named = value.get(key) if isinstance(value, Mapping) else getattr(value, key, None)
    with measured_in(named):
        return inner(value)
