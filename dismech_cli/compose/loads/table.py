"""The table of forces, and those of the scenario as terms of the model."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from enum import Enum, auto
from typing import Any, Generic, TypeVar

from ...model.term import Term
from ...scenario.language import force as said
from . import nodes as node_forces
from . import rods as rod_forces
from . import shells as shell_forces
from .setting import Place, Setting

_Load = TypeVar("_Load", bound=said.Load)


class Role(Enum):
    """Place of a force in the energy account."""

    GRAVITATIONAL = auto()
    """Conservative, counted as potential energy."""
    LOAD = auto()
    """Its work is counted as external."""
    DISSIPATIVE = auto()
    """Takes energy out."""


@dataclass(frozen=True, slots=True)
class Builder(Generic[_Load]):
    """How a kind of force becomes terms.

    Attributes:
        kind: Its class in the scenario.
        role: Its place in the energy account.
        terms: Makes the terms of one force.
    """

    kind: type[_Load]
    role: Role
    terms: Callable[[Setting, Place, _Load], Iterable[Term]]


_TABLE: tuple[Builder[Any], ...] = (
    Builder(said.Gravity, Role.GRAVITATIONAL, node_forces.gravity),
    Builder(said.Buoyancy, Role.GRAVITATIONAL, node_forces.buoyancy),
    Builder(said.Point, Role.LOAD, node_forces.point),
    Builder(said.LineLoad, Role.LOAD, shell_forces.line_load),
    Builder(said.LineMoment, Role.LOAD, shell_forces.line_moment),
    Builder(said.Moment, Role.LOAD, rod_forces.moment),
    Builder(said.Distributed, Role.LOAD, rod_forces.distributed),
    Builder(said.Viscous, Role.DISSIPATIVE, rod_forces.viscous),
    Builder(said.Resistive, Role.DISSIPATIVE, rod_forces.resistive),
    Builder(said.Aerodynamic, Role.DISSIPATIVE, shell_forces.aerodynamic),
    Builder(said.Hydrodynamic, Role.DISSIPATIVE, shell_forces.hydrodynamic),
    Builder(said.AreaDamping, Role.DISSIPATIVE, shell_forces.area_damping),
    Builder(said.Pressure, Role.LOAD, shell_forces.pressure),
    Builder(said.Thrust, Role.LOAD, shell_forces.thrust),
)

BUILDERS: Mapping[type[said.Load], Builder[Any]] = {builder.kind: builder for builder in _TABLE}


@dataclass(frozen=True, slots=True)
class Forces:
    """Force terms by their place in the energy account: see :class:`Role`."""

    gravitational: tuple[Term, ...]
    loads: tuple[Term, ...]
    dissipative: tuple[Term, ...]

    @property
    def all(self) -> tuple[Term, ...]:
        """Every force."""
        return (*self.gravitational, *self.loads, *self.dissipative)


def build_forces(setting: Setting) -> Forces:
    """Make the force terms.

    Raises:
        ScenarioError: A selection is empty or a force leaves the plane of a planar scene.
    """
    made: dict[Role, list[Term]] = {role: [] for role in Role}
    for index, force in enumerate(setting.loaded.scenario.forces):
        builder = BUILDERS[type(force)]
        made[builder.role] += builder.terms(setting, Place.of(index, force), force)
    return Forces(
        gravitational=tuple(made[Role.GRAVITATIONAL]),
        loads=tuple(made[Role.LOAD]),
        dissipative=tuple(made[Role.DISSIPATIVE]),
    )
