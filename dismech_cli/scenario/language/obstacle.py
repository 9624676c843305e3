"""Rigid bodies that are only in the way."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from annotated_types import Len
from pydantic import Field, Strict, model_validator

from ..values.law import AngleLaw, LawSpec
from ..values.law_of import LawOf
from ..values.quantity import Angle, DirectionTriple, LengthTriple, Name, PositiveLength, Quantity
from ..values.spec import Spec, exactly_one, exclusive, problem
from .geometry import SurfaceFile
from .surface import Surface

Sizes: TypeAlias = LengthTriple
Way: TypeAlias = Annotated[LawSpec, LawOf("length")]
Ways: TypeAlias = Annotated[tuple[Way, ...], Len(3, 3), Strict(False)]


class ObstacleMotion(Spec):
    """How an obstacle moves from where it is described; it turns first and is displaced then."""

    displacement: Ways | None = Field(default=None, description="Displacement of the whole.")
    angle: AngleLaw | None = Field(default=None, description="Turn, right-handed about `axis`.")
    axis: DirectionTriple = Field(default=(0.0, 0.0, 1.0), description="Axis of the turn.")
    about: LengthTriple = Field(default=(0.0, 0.0, 0.0), description="A point of that axis.")


class PlaneObstacle(Spec):
    """All space below a plane, such as a floor."""

    name: Name = Field(description="Name.")
    type: Literal["plane"] = Field(description="Kind of obstacle.")
    point: LengthTriple = Field(description="A point of the plane.")
    normal: DirectionTriple = Field(description="Out of the obstacle, of any length.")
    motion: ObstacleMotion | None = Field(default=None, description="How it moves; default: never.")


class SphereObstacle(Spec):
    """A ball."""

    name: Name = Field(description="Name.")
    type: Literal["sphere"] = Field(description="Kind of obstacle.")
    center: LengthTriple = Field(description="Its centre.")
    radius: PositiveLength = Field(description="Its radius.")
    motion: ObstacleMotion | None = Field(default=None, description="How it moves; default: never.")


class CylinderObstacle(Spec):
    """A cylinder without ends; for one with ends take a capsule."""

    name: Name = Field(description="Name.")
    type: Literal["cylinder"] = Field(description="Kind of obstacle.")
    point: LengthTriple = Field(description="A point of its axis.")
    axis: DirectionTriple = Field(description="Direction of its axis.")
    radius: PositiveLength = Field(description="Its radius.")
    motion: ObstacleMotion | None = Field(default=None, description="How it moves; default: never.")


class CapsuleObstacle(Spec):
    """A cylinder with round ends: all points within a radius of a segment."""

    name: Name = Field(description="Name.")
    type: Literal["capsule"] = Field(description="Kind of obstacle.")
    start: LengthTriple = Field(description="One end of the segment.")
    end: LengthTriple = Field(description="The other end.")
    radius: PositiveLength = Field(description="The radius.")
    motion: ObstacleMotion | None = Field(default=None, description="How it moves; default: never.")

    @model_validator(mode="after")
    def _long(self) -> CapsuleObstacle:
        if self.start == self.end:
            raise problem("the ends of a capsule must differ; for a ball take a sphere")
        return self


class BoxObstacle(Spec):
    """A box with rounded edges."""

    name: Name = Field(description="Name.")
    type: Literal["box"] = Field(description="Kind of obstacle.")
    center: LengthTriple = Field(description="Its centre.")
    size: Sizes = Field(description="Its sides along x, y and z, before it is turned.")
    rounding: PositiveLength | None = Field(
        default=None,
        description="Radius of its edges and corners; default: a twentieth of its shortest side. Edges that "
        "were sharp would have no direction to push in.",
    )
    axis: DirectionTriple = Field(default=(0.0, 0.0, 1.0), description="Axis about which it is turned.")
    angle: Angle = Field(default=0.0, description="How far it is turned about its centre.")
    motion: ObstacleMotion | None = Field(default=None, description="How it moves; default: never.")

    @property
    def edge_radius(self) -> float:
        """Radius of its edges [m]."""
        return 0.05 * min(self.size) if self.rounding is None else self.rounding

    @model_validator(mode="after")
    def _solid(self) -> BoxObstacle:
        if min(self.size) <= 0.0:
            raise problem(f"the sides of a box must be greater than 0, got {list(self.size)}")
        if 2.0 * self.edge_radius >= min(self.size):
            raise problem(
                f"rounding must be less than half of the shortest side, {0.5 * min(self.size):g} m, "
                f"got {self.edge_radius:g} m"
            )
        return self


class MeshObstacle(Spec):
    """A rigid surface of triangles, touched from both sides."""

    model_config = exclusive(("generate", "mesh"))

    name: Name = Field(description="Name.")
    type: Literal["mesh"] = Field(description="Kind of obstacle.")
    mesh: SurfaceFile | None = Field(default=None, description="Surface from a file; this or `generate`.")
    generate: Surface | None = Field(default=None, description="Surface; this or `mesh`.")
    thickness: Annotated[float, Quantity("length", ge=0)] = Field(
        default=0.0, description="Of the surface, half of it on either side."
    )
    solid: bool = Field(
        default=False,
        description="Whether the surface is that of a solid: it must be closed then, and what is inside is "
        "told. It does not push out what starts inside.",
    )
    motion: ObstacleMotion | None = Field(default=None, description="How it moves; default: never.")

    @model_validator(mode="after")
    def _one(self) -> MeshObstacle:
        exactly_one(self, "generate", "mesh")
        return self


Obstacle: TypeAlias = Annotated[
    PlaneObstacle | SphereObstacle | CylinderObstacle | CapsuleObstacle | BoxObstacle | MeshObstacle,
    Field(discriminator="type"),
]
