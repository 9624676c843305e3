"""Loads."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from annotated_types import Len
from pydantic import Field, Strict

from .law import AccelerationLaws, ForceLaws, ForcePerLengthLaws, MomentLaws, MomentPerLengthLaws, PressureLaw
from .quantity import DirectionTriple, Name, Quantity
from .selection import Selection
from .spec import Spec

BodyNames: TypeAlias = Annotated[tuple[Name, ...], Len(1, 10_000), Strict(False)]
Density: TypeAlias = Annotated[float, Quantity("density", gt=0)]
DampingPerArea: TypeAlias = Annotated[float, Quantity("damping per area", ge=0)]
Viscosity: TypeAlias = Annotated[float, Quantity("viscosity", ge=0)]


class Gravity(Spec):
    """Weight of every body."""

    type: Literal["gravity"] = Field(description="Kind of load.")
    acceleration: AccelerationLaws = Field(description="Acceleration of free fall, such as [0, 0, -9.81].")


class Buoyancy(Spec):
    """Lift of the displaced fluid, against the gravity of the scene."""

    type: Literal["buoyancy"] = Field(description="Kind of load.")
    fluid_density: Density = Field(description="Density of the fluid.")


class Point(Spec):
    """A force on each selected node."""

    type: Literal["point"] = Field(description="Kind of load.")
    where: Selection = Field(description="Nodes.")
    force: ForceLaws = Field(description="Force on each node.")


class LineLoad(Spec):
    """A force per length on the edges of shells between selected nodes, such as a side of a sheet."""

    type: Literal["line"] = Field(description="Kind of load.")
    where: Selection = Field(description="Nodes; an edge with both ends among them is loaded.")
    force_per_length: ForcePerLengthLaws = Field(description="Force per rest length, of fixed direction.")


class LineMoment(Spec):
    """A moment per length on the edges of shells with mid-edge bending between selected nodes."""

    type: Literal["line_moment"] = Field(description="Kind of load.")
    where: Selection = Field(description="Nodes; an edge with both ends among them is loaded.")
    moment_per_length: MomentPerLengthLaws = Field(
        description="Moment per rest length, of fixed direction; turns right-handed."
    )


class Moment(Spec):
    """A moment on each selected end or node of a rod."""

    type: Literal["moment"] = Field(description="Kind of load.")
    where: Selection = Field(description="Ends or nodes.")
    moment: MomentLaws = Field(description="Moment on each of them.")


class Distributed(Spec):
    """A force per length of the rods."""

    type: Literal["distributed"] = Field(description="Kind of load.")
    rods: BodyNames | None = Field(default=None, description="Names of rods; default: all.")
    force_per_length: ForcePerLengthLaws = Field(description="Force per rest length.")


class Viscous(Spec):
    """Drag against every motion: F = -eta l u on a node of velocity u and length l."""

    type: Literal["viscous"] = Field(description="Kind of load.")
    rods: BodyNames | None = Field(default=None, description="Names of rods; default: all.")
    coefficient: Viscosity = Field(description="eta.")


class Resistive(Spec):
    """Resistive force theory: different drag along the rod and across it."""

    type: Literal["resistive"] = Field(description="Kind of load.")
    rods: BodyNames | None = Field(default=None, description="Names of rods; default: all.")
    tangential: Viscosity = Field(description="Coefficient along the rod.")
    normal: Viscosity = Field(description="Coefficient across the rod.")


class Aerodynamic(Spec):
    """Quadratic drag along the normals: -(rho c A / 6) |w| w on each corner, w its normal velocity."""

    type: Literal["aerodynamic"] = Field(description="Kind of load.")
    shells: BodyNames | None = Field(default=None, description="Names of shells; default: all.")
    fluid_density: Density = Field(description="Density rho of the fluid.")
    coefficient: Annotated[float, Quantity("ratio", ge=0)] = Field(description="Drag coefficient c.")


class Hydrodynamic(Spec):
    """Linear drag -rho c A u on a node of velocity u and area A, in every direction."""

    type: Literal["hydrodynamic"] = Field(description="Kind of load.")
    shells: BodyNames | None = Field(default=None, description="Names of shells; default: all.")
    fluid_density: Density = Field(description="Density rho of the fluid.")
    coefficient: Annotated[float, Quantity("velocity", ge=0)] = Field(
        description="c: the speed at which quadratic drag of coefficient 2 would be as large."
    )


class AreaDamping(Spec):
    """Damping -eta A u on a node of velocity u and area A."""

    type: Literal["area_damping"] = Field(description="Kind of load.")
    shells: BodyNames | None = Field(default=None, description="Names of shells; default: all.")
    coefficient: DampingPerArea = Field(description="eta.")


class Pressure(Spec):
    """Pressure on a shell: follows its faces and grows with their area."""

    type: Literal["pressure"] = Field(description="Kind of load.")
    shell: Name = Field(description="Name of the shell.")
    pressure: PressureLaw = Field(description="Pressure; positive pushes along the normals.")


class Thrust(Spec):
    """Thrust -k dV/dt of a bell while its volume V shrinks, its opening closed by a fan."""

    type: Literal["thrust"] = Field(description="Kind of load.")
    shell: Name = Field(description="Name of the shell.")
    coefficient: DampingPerArea = Field(description="k.")
    direction: DirectionTriple = Field(description="Direction of the thrust.")


Force: TypeAlias = Annotated[
    Gravity
    | Buoyancy
    | Point
    | LineLoad
    | LineMoment
    | Moment
    | Distributed
    | Viscous
    | Resistive
    | Aerodynamic
    | Hydrodynamic
    | AreaDamping
    | Pressure
    | Thrust,
    Field(discriminator="type"),
]
