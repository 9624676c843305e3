"""Scenario laws to runtime laws, with the rule of static scenes.

In a static run the time t is the load parameter from 0 to 1, and every load, displacement or
actuation written as a constant grows linearly with it; a law is taken as it is written.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Protocol

from ..arrays import FloatArray
from ..laws.laws import Constant, Law, Ramp
from ..scenario.values.law import LawSpec, to_law

Places = Mapping[str, FloatArray]
_NOWHERE: Places = MappingProxyType({})


class ToLaw(Protocol):
    """Makes the runtime law of a scenario law."""

    def __call__(self, spec: LawSpec, places: Places = ...) -> Law:
        """The law; ``places`` are the variables of space that its expression may use."""


def dynamic_laws(directory: Path) -> ToLaw:
    """Laws as written."""
    return lambda spec, places=_NOWHERE: to_law(spec, directory, places)


def static_laws(directory: Path) -> ToLaw:
    """Constants become ramps over the load parameter."""

    def convert(spec: LawSpec, places: Places = _NOWHERE) -> Law:
        law = to_law(spec, directory, places)
        if isinstance(law, Constant) and law.value != 0.0:
            return Ramp(before=0.0, after=law.value, start=0.0, end=1.0)
        return law

    return convert


def components(specs: Sequence[LawSpec], laws: ToLaw) -> tuple[Law, ...]:
    """One law per component of a vector."""
    return tuple(laws(spec) for spec in specs)


def vanishes(law: Law) -> bool:
    """Whether a law is zero for ever."""
    return isinstance(law, Constant) and law.value == 0.0
