"""The bodies of a scene."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from annotated_types import Len
from pydantic import Field, Strict, model_validator

from ..values.quantity import Angle, DirectionTriple, FileName, LengthTriple, Name, Quantity
from ..values.spec import Spec, exactly_one, exclusive, problem
from ..values.varying import VaryingLength
from .section import RoundSection, Section
from .shape import Shape
from .surface import Surface

Curvature: TypeAlias = Annotated[float, Quantity("curvature")]
TwistRate: TypeAlias = Annotated[float, Quantity("twist rate")]
Curvatures: TypeAlias = Annotated[tuple[Curvature, ...], Len(1, 10_000_000), Strict(False)]
TwistRates: TypeAlias = Annotated[tuple[TwistRate, ...], Len(1, 10_000_000), Strict(False)]


Scale: TypeAlias = Annotated[float, Quantity("ratio", gt=0)]
_SCALE = Field(default=1.0, description="Length of the file's unit in metres, such as 0.001 for millimetres.")


class Rotation(Spec):
    """A turn about an axis."""

    axis: DirectionTriple = Field(description="Direction of the axis; the turn is right-handed about it.")
    angle: Angle = Field(description="Angle of the turn.")
    about: LengthTriple = Field(default=(0.0, 0.0, 0.0), description="A point on the axis.")


_WELD = Field(
    default=0.0, description="Nodes of the file up to this distance from each other, once scaled, become one."
)
_ROTATE = Field(default=None, description="Turns the mesh, once scaled.")
_MOVE = Field(default=(0.0, 0.0, 0.0), description="Moves the mesh, once scaled and turned.")


Slits: TypeAlias = Literal["refuse", "open"]


class MeshFile(Spec):
    """A centreline read from a mesh file."""

    file: FileName = Field(description="Mesh file (.msh, .obj, .ply, .vtk, .vtu, .vtp, .txt).")
    group: str | None = Field(
        default=None, min_length=1, description="Physical group of its lines; default: all lines."
    )
    scale: Scale = _SCALE
    weld: Annotated[float, Quantity("length", ge=0)] = _WELD
    rotate: Rotation | None = _ROTATE
    move: LengthTriple = _MOVE
    slits: Slits = Field(
        default="refuse",
        description="Nodes of the file at one place: `refuse`, or `open` where they are the lips of slits "
        "in its shells.",
    )

    @model_validator(mode="after")
    def _sound(self) -> MeshFile:
        _weld_or_slits(self)
        return self


class NaturalStrain(Spec):
    """Strains of the unloaded rod, in place of those of its rest shape; a list has one value per joint."""

    stretch: Annotated[float, Quantity("ratio", gt=-1)] | None = Field(
        default=None, description="Axial strain relative to the generated length."
    )
    curvature_1: Curvature | Curvatures | None = Field(
        default=None, description="Curvature toward the material director m1, about m2."
    )
    curvature_2: Curvature | Curvatures | None = Field(
        default=None, description="Curvature toward the material director m2, about -m1."
    )
    twist: TwistRate | TwistRates | None = Field(default=None, description="Twist per length.")


class Rod(Spec):
    """A slender rod, or a network of rods if its mesh branches."""

    model_config = exclusive(("radius", "section"), ("generate", "mesh"))

    type: Literal["rod"] = Field(description="Kind of body.")
    name: Name = Field(description="Its name, for selections and results.")
    material: str = Field(description="Name of its material.")
    radius: VaryingLength | None = Field(default=None, description="Short for a round `section`.")
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
    natural: NaturalStrain = Field(default=NaturalStrain.unsaid(), description="Natural strains.")

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


def _weld_or_slits(source: MeshFile | SurfaceFile) -> None:
    if source.slits == "open" and source.weld > 0.0:
        raise problem("'weld' makes the lips of slits one again; take it or slits: open, not both")


class SurfaceFile(Spec):
    """A surface read from a mesh file; bodies of one file share the nodes they have in common."""

    file: FileName = Field(description="Mesh file (.msh, .obj, .stl, .ply, .off, .vtk, .vtu, .vtp, .txt).")
    group: str | None = Field(
        default=None, min_length=1, description="Physical group of its triangles; default: all triangles."
    )
    scale: Scale = _SCALE
    weld: Annotated[float, Quantity("length", ge=0)] = _WELD
    rotate: Rotation | None = _ROTATE
    move: LengthTriple = _MOVE
    flip: bool = Field(default=False, description="Turns the normals to the other side.")
    slits: Slits = Field(
        default="refuse",
        description="Nodes of the file at one place: `refuse`, or `open` leaves them apart, as the lips of "
        "slits of no width; these are the group `slits`, not part of `boundary`.",
    )
    branches: Literal["refuse", "weld", "hinge"] = Field(
        default="refuse",
        description="Three and more sheets at an edge: `refuse`; `weld` keeps their angles as a rigid edge "
        "between elastic sheets does; `hinge` lets each turn freely.",
    )

    @model_validator(mode="after")
    def _sound(self) -> SurfaceFile:
        _weld_or_slits(self)
        return self


class NaturalShape(Spec):
    """Shape in which a shell is free of bending."""

    shape: Literal["rest", "flat"] = Field(
        default="rest", description="`flat`: unbent when all its dihedral angles vanish."
    )


class Shell(Spec):
    """A thin elastic surface; its group `boundary` holds the nodes of its rims."""

    model_config = exclusive(("generate", "mesh"))

    type: Literal["shell"] = Field(description="Kind of body.")
    name: Name = Field(description="Its name, for selections and results.")
    material: str = Field(description="Name of its material.")
    thickness: VaryingLength = Field(description="Thickness.")
    generate: Surface | None = Field(default=None, description="Surface; this or `mesh`.")
    mesh: SurfaceFile | None = Field(default=None, description="Surface from a file; this or `generate`.")
    membrane: Literal["cst", "springs", "family"] = Field(
        default="cst",
        description="In-plane stretching: `cst` linear triangles, right for any Poisson ratio and mesh; "
        "`springs` along edges, cheaper, Poisson ratio 1/3 on equilateral triangles; `family` the springs "
        "of the DiSMech programs, for comparison with their data.",
    )
    bending: Literal["midedge", "hinge", "averaged"] = Field(
        default="midedge",
        description="`midedge` a free normal at every edge, converges on every mesh; `hinge` dihedral angles "
        "and `averaged` normals halfway between faces have no unknowns of their own, but are a plate on "
        "nearly equilateral triangles only.",
    )
    hinges: Literal["equal", "weighted"] | None = Field(
        default=None,
        description="Stiffness of hinges, for `bending: hinge`: `equal` (the default there), as between "
        "equilateral triangles, or `weighted` by length^2 over the area of both triangles, which is no plate "
        "on other nets either.",
    )
    natural: NaturalShape = Field(default=NaturalShape.unsaid(), description="Shape without bending.")

    @model_validator(mode="after")
    def _sound(self) -> Shell:
        exactly_one(self, "generate", "mesh")
        if self.hinges is not None and self.bending != "hinge":
            raise problem(f"'hinges' has a meaning with bending: hinge only, got {self.bending!r}")
        if self.mesh is not None and self.mesh.branches == "weld" and self.bending == "averaged":
            raise problem("bending: averaged knows no weld of branches; take 'midedge' or 'hinge'")
        if self.mesh is not None and self.mesh.branches != "refuse" and self.membrane == "family":
            raise problem("membrane: family would count the springs of branching edges once for each sheet")
        return self


Body: TypeAlias = Annotated[Rod | Shell, Field(discriminator="type")]
