"""Shells that are generated rather than read from a mesh."""

from __future__ import annotations

from itertools import pairwise
from math import pi
from typing import Annotated, Literal, TypeAlias

from annotated_types import Len
from pydantic import Field, Strict, field_validator, model_validator

from ..values.quantity import Angle, DirectionTriple, LengthTriple, PositiveLength, Quantity, Triple
from ..values.spec import Spec, problem

Divisions: TypeAlias = Annotated[int, Field(ge=1, le=100_000)]
Counts: TypeAlias = Annotated[
    tuple[Annotated[int, Field(ge=3, le=1_000_000)], ...], Len(1, 100_000), Strict(False)
]
Axes: TypeAlias = Annotated[tuple[DirectionTriple, ...], Len(2, 2), Strict(False)]

PatternName: TypeAlias = Literal["equilateral", "right", "alternating", "unstructured"]
# 360 degrees in radians carries a rounding error.
FullTurn: TypeAlias = Annotated[float, Quantity("angle", gt=0, le=2.0 * pi * (1.0 + 1e-12))]

_X: Triple = (1.0, 0.0, 0.0)
_Z: Triple = (0.0, 0.0, 1.0)
_LAID = (
    "How the triangles are laid; `right` has all diagonals the same way, `alternating` every other one, "
    "`unstructured` no preferred direction."
)
_START = "Direction from the axis to `bottom`, made normal to the axis."
_COUNTS = Field(default=None, description="Nodes of each circle; default: about equilateral triangles.")
_NORMAL = Field(default=_Z, description="Direction of the normals.")


class SheetSurface(Spec):
    """A flat rectangle; its groups are `left`, `right`, `bottom`, `top` and `rim`."""

    shape: Literal["sheet"] = Field(description="Kind of surface.")
    origin: LengthTriple = Field(description="Corner where `left` and `bottom` meet.")
    length: PositiveLength = Field(description="Size along the first axis, from `left` to `right`.")
    width: PositiveLength = Field(description="Size along the second axis, from `bottom` to `top`.")
    divisions: Divisions = Field(description="Number of edges along the length; the width follows.")
    pattern: PatternName = Field(default="equilateral", description=_LAID)
    axes: Axes = Field(
        default=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
        description="Directions of length and width; the second is made normal to the first. The normals "
        "are their cross product.",
    )

    @field_validator("axes")
    @classmethod
    def _spanning(cls, axes: tuple[Triple, ...]) -> tuple[Triple, ...]:
        _not_parallel(axes[0], axes[1], "two axes of a sheet")
        return axes


class DiscSurface(Spec):
    """A flat disc; its groups are `center` and `rim`."""

    shape: Literal["disc"] = Field(description="Kind of surface.")
    center: LengthTriple = Field(description="Its centre.")
    radius: PositiveLength = Field(description="Its radius.")
    rings: Divisions = Field(description="Number of rings of nodes around the central one.")
    counts: Counts | None = _COUNTS
    normal: DirectionTriple = _NORMAL


class AnnulusSurface(Spec):
    """A flat disc with a hole; its groups are `inner` and `outer`."""

    shape: Literal["annulus"] = Field(description="Kind of surface.")
    center: LengthTriple = Field(description="Its centre.")
    inner_radius: PositiveLength = Field(description="Radius of the hole.")
    outer_radius: PositiveLength = Field(description="Outer radius.")
    rings: Divisions = Field(description="Number of strips between hole and rim.")
    counts: Counts | None = _COUNTS
    normal: DirectionTriple = _NORMAL

    @model_validator(mode="after")
    def _hollow(self) -> AnnulusSurface:
        if self.inner_radius >= self.outer_radius:
            raise problem(
                f"the inner radius of an annulus must be less than the outer one, "
                f"got {self.inner_radius:g} m and {self.outer_radius:g} m"
            )
        return self


class HemisphereSurface(Spec):
    """A hemisphere or cap with normals outward; its groups are `apex` and `rim`."""

    shape: Literal["hemisphere"] = Field(description="Kind of surface.")
    center: LengthTriple = Field(description="Centre of the sphere.")
    radius: PositiveLength = Field(description="Radius of the sphere.")
    rings: Divisions | None = Field(
        default=None, description="Number of rings of nodes from the apex to the equator, evenly spaced."
    )
    polar_angles: Annotated[tuple[Angle, ...], Len(1, 100_000), Strict(False)] | None = Field(
        default=None, description="Angle of each ring from the axis, ascending; in place of `rings`."
    )
    counts: Counts | None = _COUNTS
    axis: DirectionTriple = Field(default=_Z, description="From the centre to the apex.")

    @model_validator(mode="after")
    def _sound(self) -> HemisphereSurface:
        if (self.rings is None) == (self.polar_angles is None):
            raise problem("give either 'rings' or 'polar_angles'")
        for before, after in pairwise(self.polar_angles or ()):
            if after <= before:
                raise problem("the polar angles of a hemisphere must increase")
        return self


class CylinderSurface(Spec):
    """A sheet rolled around an axis, normals outward.

    Its groups are `left` and `right` (the arcs), `bottom` and `top` (the first and last straight side, one
    seam of a full tube) and `rim`.
    """

    shape: Literal["cylinder"] = Field(description="Kind of surface.")
    origin: LengthTriple = Field(description="Point of the axis at `left`.")
    axis: DirectionTriple = Field(default=_Z, description="From `left` to `right`.")
    start: DirectionTriple = Field(default=_X, description=_START)
    radius: PositiveLength = Field(description="Its radius.")
    length: PositiveLength = Field(description="Size along the axis.")
    angle: FullTurn = Field(default=2.0 * pi, description="Angle from `bottom` to `top`; 360 deg: a tube.")
    divisions: Divisions = Field(description="Number of edges along the axis; those around follow.")
    pattern: PatternName = Field(default="equilateral", description=_LAID)

    @model_validator(mode="after")
    def _sound(self) -> CylinderSurface:
        _not_parallel(self.axis, self.start, "axis and start of a cylinder")
        return self


class SphereSurface(Spec):
    """The part of a sphere between two parallels, normals outward, all around or between two meridians.

    Its groups are `left` and `right` (the parallels), `bottom` and `top` (the meridians, one seam if it
    goes all around) and `rim`.
    """

    shape: Literal["sphere"] = Field(description="Kind of surface.")
    center: LengthTriple = Field(description="Its centre.")
    axis: DirectionTriple = Field(default=_Z, description="From the centre to the pole.")
    start: DirectionTriple = Field(default=_X, description=_START)
    radius: PositiveLength = Field(description="Its radius.")
    polar: Annotated[tuple[Angle, ...], Len(2, 2), Strict(False)] = Field(
        description="Angles of `left` and `right` from the axis, ascending, between 0 and a half turn."
    )
    angle: FullTurn = Field(default=2.0 * pi, description="Angle from `bottom` to `top`.")
    divisions: Divisions = Field(description="Number of edges along a meridian; those around follow.")
    pattern: PatternName = Field(default="equilateral", description=_LAID)

    @model_validator(mode="after")
    def _sound(self) -> SphereSurface:
        _not_parallel(self.axis, self.start, "axis and start of a sphere")
        if not 0.0 < self.polar[0] < self.polar[1] < pi:
            raise problem("the polar angles of a sphere must increase and lie between 0 and a half turn")
        return self


class IcosphereSurface(Spec):
    """A whole sphere of like triangles, normals outward; its groups are `top` and `bottom`, the poles."""

    shape: Literal["icosphere"] = Field(description="Kind of surface.")
    center: LengthTriple = Field(description="Its centre.")
    axis: DirectionTriple = Field(default=_Z, description="From the centre to `top`.")
    start: DirectionTriple = Field(
        default=_X, description="Across the axis, towards a corner of the icosahedron."
    )
    radius: PositiveLength = Field(description="Its radius.")
    divisions: Divisions = Field(
        description="Number n of edges along a side of the icosahedron: 20 n^2 triangles."
    )

    @model_validator(mode="after")
    def _sound(self) -> IcosphereSurface:
        _not_parallel(self.axis, self.start, "axis and start of an icosphere")
        return self


Surface: TypeAlias = Annotated[
    SheetSurface
    | DiscSurface
    | AnnulusSurface
    | HemisphereSurface
    | CylinderSurface
    | SphereSurface
    | IcosphereSurface,
    Field(discriminator="shape"),
]


def _not_parallel(a: Triple, b: Triple, what: str) -> None:
    cross = sum((a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2]) ** 2 for i in range(3))
    if cross <= 1e-18 * sum(x * x for x in a) * sum(x * x for x in b):
        raise problem(f"the {what} must not be parallel")
