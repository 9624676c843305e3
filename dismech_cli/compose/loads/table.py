"""The table of forces, and those of the scenario as terms of the model."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from enum import Enum, auto
from typing import Any, Generic, TypeVar

from ...frozen import frozen
from ...model.term import Term
from ...scenario.language.force import (
    Aerodynamic,
    AreaDamping,
    Buoyancy,
    Distributed,
    Gravity,
    Hydrodynamic,
    LineLoad,
    LineMoment,
    Load,
    Moment,
    Point,
    Pressure,
    Resistive,
    Thrust,
    Viscous,
)
from ..scene import Scene
from ..structure.structure import Structure
from . import nodes as node_forces
from . import rods as rod_forces
from . import shells as shell_forces
from .vectors import Place

_Load = TypeVar("_Load", bound=Load)


class Role(Enum):
    """Place of a force in the energy account."""

    GRAVITATIONAL = auto()
    """Conservative, counted as potential energy."""
    LOAD = auto()
    """Its work is counted as external."""
    DISSIPATIVE = auto()
    """Takes energy out."""


@frozen
class Builder(Generic[_Load]):
    """How a kind of force becomes terms.

    Attributes:
        kind: Its class in the scenario.
        role: Its place in the energy account.
        terms: Makes the terms of one force.
    """

    kind: type[_Load]
    role: Role
    terms: Callable[[Scene, Structure, Place, _Load], Iterable[Term]]


_TABLE: tuple[Builder[Any], ...] = (
    Builder(Gravity, Role.GRAVITATIONAL, node_forces.gravity),
    Builder(Buoyancy, Role.GRAVITATIONAL, node_forces.buoyancy),
    Builder(Point, Role.LOAD, node_forces.point),
    Builder(LineLoad, Role.LOAD, shell_forces.line_load),
    Builder(LineMoment, Role.LOAD, shell_forces.line_moment),
    Builder(Moment, Role.LOAD, rod_forces.moment),
    Builder(Distributed, Role.LOAD, rod_forces.distributed),
    Builder(Viscous, Role.DISSIPATIVE, rod_forces.viscous),
    Builder(Resistive, Role.DISSIPATIVE, rod_forces.resistive),
    Builder(Aerodynamic, Role.DISSIPATIVE, shell_forces.aerodynamic),
    Builder(Hydrodynamic, Role.DISSIPATIVE, shell_forces.hydrodynamic),
    Builder(AreaDamping, Role.DISSIPATIVE, shell_forces.area_damping),
    Builder(Pressure, Role.LOAD, shell_forces.pressure),
    Builder(Thrust, Role.LOAD, shell_forces.thrust),
)

BUILDERS: Mapping[type[Load], Builder[Any]] = {builder.kind: builder for builder in _TABLE}


@frozen
class Forces:
    """Force terms by their place in the energy account: see :class:`Role`."""

    gravitational: tuple[Term, ...]
    loads: tuple[Term, ...]
    dissipative: tuple[Term, ...]

    @property
    def all(self) -> tuple[Term, ...]:
        """Every force."""
        return (*self.gravitational, *self.loads, *self.dissipative)


def make_forces(scene: Scene, structure: Structure) -> Forces:
    """Make the force terms.

    Raises:
        ScenarioError: A place holds nothing that its force acts on, or a force leaves the plane of a
            planar scene.
    """
    made: dict[Role, list[Term]] = {role: [] for role in Role}
    for index, force in enumerate(scene.scenario.forces):
        builder = BUILDERS[type(force)]
        # a fluid that moves gives energy as well as it takes
        role = Role.LOAD if force.acts_at_rest else builder.role
        made[role] += builder.terms(scene, structure, Place.of(index, force), force)
    return Forces(
        gravitational=tuple(made[Role.GRAVITATIONAL]),
        loads=tuple(made[Role.LOAD]),
        dissipative=tuple(made[Role.DISSIPATIVE]),
    )
