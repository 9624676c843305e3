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
from ..scenario.language.numerics import Static
from ..scenario.load import LoadedScenario
from ..scenario.values.law import LawSpec
from ..scenario.values.runtime_law import to_law

Coordinates = Mapping[str, FloatArray]
"""Values of the variables of space that an expression may use."""

_NOWHERE: Coordinates = MappingProxyType({})


class ToLaw(Protocol):
    """Makes the runtime law of a scenario law."""

    def __call__(self, spec: LawSpec, at: Coordinates = ...) -> Law:
        """The law, at the places of these coordinates."""


def make_laws(loaded: LoadedScenario) -> ToLaw:
    """How the laws of a scenario are to be taken."""
    static = isinstance(loaded.scenario.numerics.integrator, Static)
    return (static_laws if static else dynamic_laws)(loaded.directory)


def dynamic_laws(directory: Path) -> ToLaw:
    """Laws as written."""
    return lambda spec, at=_NOWHERE: to_law(spec, directory, at)


def static_laws(directory: Path) -> ToLaw:
    """Constants become ramps over the load parameter."""

    def convert(spec: LawSpec, at: Coordinates = _NOWHERE) -> Law:
        law = to_law(spec, directory, at)
        if isinstance(law, Constant) and law.level != 0.0:
            return Ramp(before=0.0, after=law.level, start=0.0, end=1.0)
        return law

    return convert


def components(specs: Sequence[LawSpec], laws: ToLaw) -> tuple[Law, ...]:
    """One law per component of a vector."""
    return tuple(laws(spec) for spec in specs)


def vanishes(law: Law) -> bool:
    """Whether a law is zero for ever."""
    return isinstance(law, Constant) and law.level == 0.0
