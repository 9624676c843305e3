"""Scenario laws to runtime laws, with the rule of static scenes.

In a static run the time t is the load parameter from 0 to 1, and every load, displacement or
actuation written as a constant grows linearly with it; a law is taken as it is written. On a path of
equilibria t is the load factor, which may pass 1 and fall again.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Protocol

from ..arrays import FloatArray
from ..laws.laws import Constant, Law, Proportional, Ramp
from ..scenario.language.numerics import Static
from ..scenario.load import LoadedScenario
from ..scenario.values.law import LawSpec
from ..scenario.values.runtime_law import to_law

Coordinates = Mapping[str, FloatArray]
"""Values of the variables of space that an expression may use."""

NOWHERE: Coordinates = MappingProxyType({})
"""Where no variable of space has a value."""


class ToLaw(Protocol):
    """Makes the runtime law of a scenario law."""

    def __call__(self, spec: LawSpec, at: Coordinates = ...) -> Law:
        """The law, at the places of these coordinates."""


def make_laws(loaded: LoadedScenario) -> ToLaw:
    """How the laws of a scenario are to be taken."""
    integrator = loaded.scenario.numerics.integrator
    if not isinstance(integrator, Static):
        return dynamic_laws(loaded.directory)
    return static_laws(loaded.directory, _to_one if integrator.path is None else Proportional)


def dynamic_laws(directory: Path) -> ToLaw:
    """Laws as written."""
    return lambda spec, at=NOWHERE: to_law(spec, directory, at)


def static_laws(directory: Path, grown: Callable[[float], Law]) -> ToLaw:
    """Constants grow with the load parameter, as ``grown`` says."""

    def convert(spec: LawSpec, at: Coordinates = NOWHERE) -> Law:
        law = to_law(spec, directory, at)
        if isinstance(law, Constant) and law.level != 0.0:
            return grown(law.level)
        return law

    return convert


def _to_one(level: float) -> Law:
    """A ramp that ends with the run."""
    return Ramp(before=0.0, after=level, start=0.0, end=1.0)


def components(specs: Sequence[LawSpec], laws: ToLaw) -> tuple[Law, ...]:
    """One law per component of a vector."""
    return tuple(laws(spec) for spec in specs)


def vanishes(law: Law) -> bool:
    """Whether a law is zero for ever."""
    return isinstance(law, Constant) and law.level == 0.0
