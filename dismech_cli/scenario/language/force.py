"""Loads."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, TypeAlias

from annotated_types import Len
from pydantic import Field, Strict

from ..values.law import (
    AccelerationLaws,
    FluidVelocity,
    ForceLaws,
    ForcePerLengthLaws,
    MomentLaws,
    MomentPerLengthLaws,
    PressureLaw,
)
from ..values.quantity import DirectionTriple, Name, Quantity
from ..values.selection import SelectedNodes
from ..values.spec import Spec

BodyNames: TypeAlias = Annotated[tuple[Name, ...], Len(1, 10_000), Strict(False)]
Density: TypeAlias = Annotated[float, Quantity("density", gt=0)]
DampingPerArea: TypeAlias = Annotated[float, Quantity("damping per area", ge=0)]
Viscosity: TypeAlias = Annotated[float, Quantity("viscosity", ge=0)]

_FLOW = (
    "Velocity of the fluid, such as a wind or a current; the drag acts on the velocity relative to it. "
    "Expressions of t and of the place x, y, z [m] where the body is now; default: still."
)


class Load(Spec):
    """A load; its class variables are all that checks and plan know of its kind.

    Attributes:
        acts_on: The key that names its bodies; None if it acts on selected nodes or on everything.
        velocity_dependent: Whether it depends on velocity, and so vanishes at rest in a still fluid.
        turns_rods: Whether it may turn a rod about its axis.
    """

    acts_on: ClassVar[Literal["rods", "shells", "shell"] | None] = None
    velocity_dependent: ClassVar[bool] = False
    turns_rods: ClassVar[bool] = False

    @property
    def acts_at_rest(self) -> bool:
        """Whether it is the drag of a fluid that moves, which acts on what is at rest too."""
        return getattr(self, "fluid_velocity", None) is not None


class Gravity(Load):
    """Weight of every body."""

    type: Literal["gravity"] = Field(description="Kind of load.")
    acceleration: AccelerationLaws = Field(description="Acceleration of free fall, such as [0, 0, -9.81].")


class Buoyancy(Load):
    """Lift of the displaced fluid, against the gravity of the scene."""

    type: Literal["buoyancy"] = Field(description="Kind of load.")
    fluid_density: Density = Field(description="Density of the fluid.")


class Point(Load):
    """A force on each selected node."""

    type: Literal["point"] = Field(description="Kind of load.")
    where: SelectedNodes = Field(description="Nodes.")
    force: ForceLaws = Field(description="Force on each node.")
    follower: bool = Field(
        default=False,
        description="Whether the force, given as in the rest shape, turns with the body: with the edges of "
        "rods at the node, or without any with the triangles around it.",
    )


class LineLoad(Load):
    """A force per length on the edges of shells between selected nodes, such as a side of a sheet."""

    type: Literal["line"] = Field(description="Kind of load.")
    where: SelectedNodes = Field(description="Nodes; an edge with both ends among them is loaded.")
    force_per_length: ForcePerLengthLaws = Field(description="Force per rest length.")
    follower: bool = Field(
        default=False,
        description="Whether the force, given as in the rest shape, turns with the triangles at each edge.",
    )


class LineMoment(Load):
    """A moment per length on the edges of shells with mid-edge bending between selected nodes."""

    type: Literal["line_moment"] = Field(description="Kind of load.")
    where: SelectedNodes = Field(description="Nodes; an edge with both ends among them is loaded.")
    moment_per_length: MomentPerLengthLaws = Field(
        description="Moment per rest length, of fixed direction; turns right-handed."
    )


class Moment(Load):
    """A moment on each selected end or node of a rod."""

    turns_rods = True

    type: Literal["moment"] = Field(description="Kind of load.")
    where: SelectedNodes = Field(description="Ends or nodes.")
    moment: MomentLaws = Field(description="Moment on each of them.")


class Distributed(Load):
    """A force per length of the rods."""

    acts_on = "rods"

    type: Literal["distributed"] = Field(description="Kind of load.")
    rods: BodyNames | None = Field(default=None, description="Names of rods; default: all.")
    force_per_length: ForcePerLengthLaws = Field(description="Force per rest length.")
    follower: bool = Field(
        default=False,
        description="Whether the force, given as in the rest shape, turns with each edge of the rods.",
    )


class Viscous(Load):
    """Drag against every motion: F = -eta l u on a node of velocity u (in the fluid) and length l."""

    acts_on = "rods"
    velocity_dependent = True

    type: Literal["viscous"] = Field(description="Kind of load.")
    rods: BodyNames | None = Field(default=None, description="Names of rods; default: all.")
    coefficient: Viscosity = Field(description="eta.")
    fluid_velocity: FluidVelocity | None = Field(default=None, description=_FLOW)


class Resistive(Load):
    """Resistive force theory: different drag along the rod and across it."""

    acts_on = "rods"
    velocity_dependent = True

    type: Literal["resistive"] = Field(description="Kind of load.")
    rods: BodyNames | None = Field(default=None, description="Names of rods; default: all.")
    tangential: Viscosity = Field(description="Coefficient along the rod.")
    normal: Viscosity = Field(description="Coefficient across the rod.")
    fluid_velocity: FluidVelocity | None = Field(default=None, description=_FLOW)


class Aerodynamic(Load):
    """Quadratic drag: -(rho c A / 6) |w| w on each corner, w its velocity along the normal, in the fluid."""

    acts_on = "shells"
    velocity_dependent = True

    type: Literal["aerodynamic"] = Field(description="Kind of load.")
    shells: BodyNames | None = Field(default=None, description="Names of shells; default: all.")
    fluid_density: Density = Field(description="Density rho of the fluid.")
    coefficient: Annotated[float, Quantity("ratio", ge=0)] = Field(description="Drag coefficient c.")
    fluid_velocity: FluidVelocity | None = Field(default=None, description=_FLOW)


class Hydrodynamic(Load):
    """Linear drag -rho c A u on a node of velocity u (in the fluid) and area A."""

    acts_on = "shells"
    velocity_dependent = True

    type: Literal["hydrodynamic"] = Field(description="Kind of load.")
    shells: BodyNames | None = Field(default=None, description="Names of shells; default: all.")
    fluid_density: Density = Field(description="Density rho of the fluid.")
    coefficient: Annotated[float, Quantity("velocity", ge=0)] = Field(
        description="c: the speed at which quadratic drag of coefficient 2 would be as large."
    )
    fluid_velocity: FluidVelocity | None = Field(default=None, description=_FLOW)


class AreaDamping(Load):
    """Damping -eta A u on a node of velocity u and area A."""

    acts_on = "shells"
    velocity_dependent = True

    type: Literal["area_damping"] = Field(description="Kind of load.")
    shells: BodyNames | None = Field(default=None, description="Names of shells; default: all.")
    coefficient: DampingPerArea = Field(description="eta.")


class Pressure(Load):
    """Pressure on a shell: follows its faces and grows with their area."""

    acts_on = "shell"

    type: Literal["pressure"] = Field(description="Kind of load.")
    shell: Name = Field(description="Name of the shell.")
    pressure: PressureLaw = Field(description="Pressure; positive pushes along the normals.")


class Thrust(Load):
    """Thrust -k dV/dt of a bell while its volume V shrinks, its opening closed by a fan."""

    acts_on = "shell"
    velocity_dependent = True

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
