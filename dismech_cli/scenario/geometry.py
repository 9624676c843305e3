"""The bodies of a scene."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from annotated_types import Len
from pydantic import Field, Strict, model_validator

from .quantity import DirectionTriple, FileName, Name, PositiveLength, Quantity
from .section import RoundSection, Section
from .shape import Shape
from .spec import Spec, exactly_one

Curvature: TypeAlias = Annotated[float, Quantity("curvature")]
TwistRate: TypeAlias = Annotated[float, Quantity("twist rate")]
Curvatures: TypeAlias = Annotated[tuple[Curvature, ...], Len(1, 10_000_000), Strict(False)]
TwistRates: TypeAlias = Annotated[tuple[TwistRate, ...], Len(1, 10_000_000), Strict(False)]


class MeshFile(Spec):
    """A centreline read from a mesh file."""

    file: FileName = Field(description="Mesh file (.msh, .obj, .txt).")
    group: str | None = Field(
        default=None, min_length=1, description="Physical group of its lines; default: all lines."
    )


class NaturalStrain(Spec):
    """Strains of the unloaded rod, in place of those of its rest shape; a list has one value per joint."""

    stretch: Annotated[float, Quantity("ratio", gt=-1)] | None = Field(
        default=None, description="Axial strain relative to the generated length."
    )
    curvature_1: Curvature | Curvatures | None = Field(
        default=None, description="Curvature about director m1."
    )
    curvature_2: Curvature | Curvatures | None = Field(
        default=None, description="Curvature about director m2."
    )
    twist: TwistRate | TwistRates | None = Field(default=None, description="Twist per length.")


class Rod(Spec):
    """A slender rod, or a network of rods if its mesh branches."""

    type: Literal["rod"] = Field(description="Kind of body.")
    name: Name = Field(description="Its name, for selections and results.")
    material: str = Field(description="Name of its material.")
    radius: PositiveLength | None = Field(default=None, description="Short for a round `section`.")
    section: Section | None = Field(default=None, description="Cross-section; this or `radius`.")
    generate: Shape | None = Field(default=None, description="Centreline; this or `mesh`.")
    mesh: MeshFile | None = Field(default=None, description="Centreline from a file; this or `generate`.")
    director: DirectionTriple | None = Field(
        default=None,
        description="First material director of the first edge, made normal to it; default: chosen.",
    )
    bending: Literal["auto", "isotropic", "framed"] = Field(
        default="auto", description="Bending model; `auto` takes the cheapest that gives the same answer."
    )
    natural: NaturalStrain = Field(default=NaturalStrain(), description="Natural strains.")

    @model_validator(mode="after")
    def _sound(self) -> Rod:
        exactly_one(self, "radius", "section")
        exactly_one(self, "generate", "mesh")
        return self

    @property
    def cross_section(self) -> Section:
        """The section, of a ``radius`` too."""
        if self.section is not None:
            return self.section
        assert self.radius is not None
        return RoundSection(type="round", radius=self.radius)
