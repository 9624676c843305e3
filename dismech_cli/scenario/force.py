"""Loads."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from annotated_types import Len
from pydantic import Field, Strict

from .law import AccelerationLaws, ForceLaws, ForcePerLengthLaws, MomentLaws
from .quantity import Name, Quantity
from .selection import Selection
from .spec import Spec

RodNames: TypeAlias = Annotated[tuple[Name, ...], Len(1, 10_000), Strict(False)]
Viscosity: TypeAlias = Annotated[float, Quantity("viscosity", ge=0)]


class Gravity(Spec):
    """Weight of every body."""

    type: Literal["gravity"] = Field(description="Kind of load.")
    acceleration: AccelerationLaws = Field(description="Acceleration of free fall, such as [0, 0, -9.81].")


class Buoyancy(Spec):
    """Lift of the displaced fluid, against the gravity of the scene."""

    type: Literal["buoyancy"] = Field(description="Kind of load.")
    fluid_density: Annotated[float, Quantity("density", gt=0)] = Field(description="Density of the fluid.")


class Point(Spec):
    """A force on each selected node."""

    type: Literal["point"] = Field(description="Kind of load.")
    where: Selection = Field(description="Nodes.")
    force: ForceLaws = Field(description="Force on each node.")


class Moment(Spec):
    """A moment on each selected end or node."""

    type: Literal["moment"] = Field(description="Kind of load.")
    where: Selection = Field(description="Ends or nodes.")
    moment: MomentLaws = Field(description="Moment on each of them.")


class Distributed(Spec):
    """A force per length of the rods."""

    type: Literal["distributed"] = Field(description="Kind of load.")
    rods: RodNames | None = Field(default=None, description="Names of rods; default: all.")
    force_per_length: ForcePerLengthLaws = Field(description="Force per rest length.")


class Viscous(Spec):
    """Drag against every motion: F = -eta l u on a node of velocity u and length l."""

    type: Literal["viscous"] = Field(description="Kind of load.")
    rods: RodNames | None = Field(default=None, description="Names of rods; default: all.")
    coefficient: Viscosity = Field(description="eta.")


class Resistive(Spec):
    """Resistive force theory: different drag along the rod and across it."""

    type: Literal["resistive"] = Field(description="Kind of load.")
    rods: RodNames | None = Field(default=None, description="Names of rods; default: all.")
    tangential: Viscosity = Field(description="Coefficient along the rod.")
    normal: Viscosity = Field(description="Coefficient across the rod.")


Force: TypeAlias = Annotated[
    Gravity | Buoyancy | Point | Moment | Distributed | Viscous | Resistive, Field(discriminator="type")
]
