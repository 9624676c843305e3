"""Natural strains that change in time."""

from __future__ import annotations

import math
from typing import Annotated, Literal, TypeAlias

from pydantic import Field, Tag

from ..values.law import (
    PLACES,
    ExpressionLaw,
    LawSpec,
    RampLaw,
    SawtoothLaw,
    SineLaw,
    TableLaw,
)
from ..values.law_of import FieldValue, LawOf
from ..values.quantity import DirectionTriple, LengthTriple, Name, Quantity
from ..values.selection import IndexRange, SelectedNodes
from ..values.spec import Spec, tag, told_by_key

_ALONG = ("t", "s")


_JOINTS = Field(
    default=None, description="First and last joint (for stretch: edge), both included; default: all."
)


class Controlled(Spec):
    """What a controller commands."""

    controlled_by: Name = Field(description="Name of the controller, which drives nothing else.")


Driven: TypeAlias = Annotated[
    Annotated[FieldValue, Tag("<constant>")]
    | Annotated[TableLaw, Tag(tag("table"))]
    | Annotated[RampLaw, Tag(tag("ramp"))]
    | Annotated[SineLaw, Tag(tag("sine"))]
    | Annotated[SawtoothLaw, Tag(tag("sawtooth"))]
    | Annotated[ExpressionLaw, Tag(tag("expression"))]
    | Annotated[Controlled, Tag(tag("controlled_by"))],
    told_by_key("table", "ramp", "sine", "sawtooth", "expression", "controlled_by", scalar="<constant>"),
]
"""A law, or the command of a controller."""


class StretchActuation(Spec):
    """Adds to the natural axial strain of the edges."""

    type: Literal["stretch"] = Field(description="Kind of strain.")
    rod: Name = Field(description="Name of the rod.")
    joints: IndexRange | None = _JOINTS
    value: Annotated[Driven, LawOf("ratio", _ALONG)] = Field(
        description="Added strain, or `{controlled_by: NAME}`."
    )


class CurvatureActuation(Spec):
    """Adds to the natural curvature about a material director."""

    type: Literal["curvature_1", "curvature_2"] = Field(description="Kind of strain.")
    rod: Name = Field(description="Name of the rod.")
    joints: IndexRange | None = _JOINTS
    value: Annotated[Driven, LawOf("curvature", _ALONG)] = Field(
        description="Added curvature, or `{controlled_by: NAME}`."
    )


class TwistActuation(Spec):
    """Adds to the natural twist."""

    type: Literal["twist"] = Field(description="Kind of strain.")
    rod: Name = Field(description="Name of the rod.")
    joints: IndexRange | None = _JOINTS
    value: Annotated[Driven, LawOf("twist rate", _ALONG)] = Field(
        description="Added twist per length, or `{controlled_by: NAME}`."
    )


class Tangential(Spec):
    """Hinges across the lines to a point, such as the rings of a bell around its apex."""

    apex: LengthTriple = Field(description="The point.")
    min_angle: Annotated[float, Quantity("angle", ge=0, le=math.pi / 2)] = Field(
        description="Least angle between the edge of a hinge and the line from its middle to the point."
    )


class DihedralActuation(Spec):
    """Adds to the natural dihedral angle of hinges: the edges between two triangles of a shell, not seams."""

    type: Literal["dihedral"] = Field(description="Kind of strain.")
    shell: Name = Field(description="Name of the shell.")
    hinges: SelectedNodes | None = Field(
        default=None, description="Nodes: a hinge with both ends among them is driven; default: all."
    )
    tangential: Tangential | None = Field(default=None, description="Leaves only some of them.")
    order_by: DirectionTriple | None = Field(
        default=None,
        description="Direction along which s counts the driven hinges from 0 to 1; default: as numbered.",
    )
    value: Annotated[Driven, LawOf("angle", (*_ALONG, *PLACES))] = Field(
        description="Added angle between the two triangles; positive folds them toward the side of their "
        "normals. Or `{controlled_by: NAME}`."
    )


class SurfaceCurvatureActuation(Spec):
    """Adds to the natural curvature of a shell, as a swelling layer on it does."""

    type: Literal["surface_curvature"] = Field(description="Kind of strain.")
    shell: Name = Field(description="Name of the shell; it bends by `midedge` or `averaged` normals.")
    where: SelectedNodes | None = Field(
        default=None, description="Nodes: a triangle with all corners among them is driven; default: all."
    )
    along: DirectionTriple = Field(description="Direction that bends, laid into each triangle.")
    value: Annotated[Driven, LawOf("curvature", ("t", *PLACES))] = Field(
        description="Added curvature along it; positive bends toward the side of the normals. Or "
        "`{controlled_by: NAME}`."
    )
    across: Annotated[LawSpec, LawOf("curvature", ("t", *PLACES))] = Field(
        default=0.0, description="The same across it, in the triangle."
    )


RodActuation: TypeAlias = StretchActuation | CurvatureActuation | TwistActuation
ShellActuation: TypeAlias = DihedralActuation | SurfaceCurvatureActuation
Actuation: TypeAlias = Annotated[RodActuation | ShellActuation, Field(discriminator="type")]
