"""What controllers read: strains of a body, or a probe."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import Field, Tag

from ..values.quantity import DirectionTriple, Index, Name, Quantity, Time
from ..values.selection import IndexRange, SelectedNodes
from ..values.spec import Spec, tag, told_by_key
from .actuation import Tangential
from .probe import Probe

_DELAY = Field(default=0.0, description="Age of a reading when it arrives; a multiple of the period.")
_SEED = Field(
    default=0, description="Seed of the noise; that of a sample depends on nothing else but its number."
)
_JOINTS = Field(
    default=None, description="First and last joint (for stretch: edge), both included; default: all."
)
_ROD = Field(description="Name of the rod.")
_NOISE = "Standard deviation of the noise of one reading."


class StretchSensor(Spec):
    """Axial strain of edges, as actuation counts it: 0 where an edge is as long as it is made to be."""

    strain: Literal["stretch"] = Field(description="Kind of strain.")
    rod: Name = _ROD
    joints: IndexRange | None = _JOINTS
    noise: Annotated[float, Quantity("ratio", ge=0)] = Field(default=0.0, description=_NOISE)
    delay: Time = _DELAY
    seed: Index = _SEED


class CurvatureSensor(Spec):
    """Curvature of joints about a material director, as actuation counts it: 0 at the natural curvature."""

    strain: Literal["curvature_1", "curvature_2"] = Field(description="Kind of strain.")
    rod: Name = _ROD
    joints: IndexRange | None = _JOINTS
    noise: Annotated[float, Quantity("curvature", ge=0)] = Field(default=0.0, description=_NOISE)
    delay: Time = _DELAY
    seed: Index = _SEED


class TwistSensor(Spec):
    """Twist per length of joints, as actuation counts it: 0 at the natural twist."""

    strain: Literal["twist"] = Field(description="Kind of strain.")
    rod: Name = _ROD
    joints: IndexRange | None = _JOINTS
    noise: Annotated[float, Quantity("twist rate", ge=0)] = Field(default=0.0, description=_NOISE)
    delay: Time = _DELAY
    seed: Index = _SEED


class DihedralSensor(Spec):
    """Angle of hinges of a shell from the one that they are made with; keys as those of the actuation."""

    strain: Literal["dihedral"] = Field(description="Kind of strain.")
    shell: Name = Field(description="Name of the shell.")
    hinges: SelectedNodes | None = Field(
        default=None, description="Nodes: a hinge with both ends among them is read; default: all."
    )
    tangential: Tangential | None = Field(default=None, description="Leaves only some of them.")
    order_by: DirectionTriple | None = Field(
        default=None, description="Direction along which hinges are counted; default: as numbered."
    )
    noise: Annotated[float, Quantity("angle", ge=0)] = Field(default=0.0, description=_NOISE)
    delay: Time = _DELAY
    seed: Index = _SEED


class SurfaceCurvatureSensor(Spec):
    """Curvature of triangles of a shell from the one that they are made with, along a direction."""

    strain: Literal["surface_curvature"] = Field(description="Kind of strain.")
    shell: Name = Field(description="Name of the shell; it bends by `midedge` or `averaged` normals.")
    where: SelectedNodes | None = Field(
        default=None, description="Nodes: a triangle with all corners among them is read; default: all."
    )
    along: DirectionTriple = Field(description="Direction, laid into each triangle.")
    noise: Annotated[float, Quantity("curvature", ge=0)] = Field(default=0.0, description=_NOISE)
    delay: Time = _DELAY
    seed: Index = _SEED


class ProbeSensor(Spec):
    """One number, as a probe reads it."""

    probe: Probe = Field(
        description="What is read: displacement, position, velocity, distance, mean_position, twist or turn."
    )
    noise: Annotated[float, Quantity("ratio", ge=0)] = Field(
        default=0.0, description=f"{_NOISE[:-1]}, in the SI unit of the probe, without one."
    )
    delay: Time = _DELAY
    seed: Index = _SEED


RodSensor: TypeAlias = StretchSensor | CurvatureSensor | TwistSensor
ShellSensor: TypeAlias = DihedralSensor | SurfaceCurvatureSensor
StrainSensor: TypeAlias = RodSensor | ShellSensor


Sensor: TypeAlias = Annotated[
    Annotated[Annotated[StrainSensor, Field(discriminator="strain")], Tag(tag("strain"))]
    | Annotated[ProbeSensor, Tag(tag("probe"))],
    told_by_key("strain", "probe"),
]
