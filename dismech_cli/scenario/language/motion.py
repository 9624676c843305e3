"""What is held or driven, and what moves at the start."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from annotated_types import Len
from pydantic import Field, Strict, Tag, field_validator

from ..values.law import AngleLaw, DisplacementLaws
from ..values.quantity import Column, DirectionTriple, FileName, LengthTriple, Time, VelocityTriple
from ..values.selection import SelectedEdges, SelectedNodes
from ..values.spec import Spec, problem, told_by_key


class AxisRotation(Spec):
    """Turns what is held about a line fixed in space, as a rigid body."""

    axis: DirectionTriple = Field(description="Direction of the line, of any length.")
    angle: AngleLaw = Field(description="Angle from rest, right-handed; zero at the start.")
    center: LengthTriple | None = Field(
        default=None,
        description="A point of the line; default: the mean rest position of the nodes selected.",
    )


Rotations: TypeAlias = Annotated[tuple[AxisRotation, ...], Len(1, 100), Strict(False)]
_DISPLACEMENT = (
    "Displacement from the rest position; expressions of t, of x, y, z of each node at rest [m] and of s, 0 "
    "to 1 along its rod."
)
_ROTATIONS = (
    "Rotations of all held nodes together, one after another, each about its own line in space; "
    "`displacement` comes after them."
)


class Clamp(Spec):
    """Holds nodes and the edges between them: position and direction.

    On a shell with mid-edge normals, those of the edges between held nodes: a rim is clamped by itself.
    With other bending a clamp needs two rows of nodes.
    """

    type: Literal["clamp"] = Field(description="Kind of motion.")
    where: SelectedNodes = Field(description="What is held.")
    at: Literal["node", "edge"] = Field(
        default="node",
        description="`edge` holds the whole edge next to a single node too, so its direction is fixed.",
    )
    displacement: DisplacementLaws | None = Field(default=None, description=_DISPLACEMENT)
    rotations: Rotations | None = Field(
        default=None,
        description=_ROTATIONS + " Held edges turn with them, sections and normals of shells too.",
    )
    twist: AngleLaw | None = Field(default=None, description="Rotation about the rod, before `rotations`.")
    release: Time | None = Field(default=None, description="Time at which it lets go; default: never.")


class Pin(Spec):
    """Holds positions; rotation stays free."""

    type: Literal["pin"] = Field(description="Kind of motion.")
    where: SelectedNodes = Field(description="What is held.")
    components: Annotated[tuple[Literal["x", "y", "z"], ...], Len(1, 3), Strict(False)] = Field(
        default=("x", "y", "z"), description="Components held."
    )
    displacement: DisplacementLaws | None = Field(default=None, description=_DISPLACEMENT)
    rotations: Rotations | None = Field(default=None, description=_ROTATIONS)
    release: Time | None = Field(default=None, description="Time at which it lets go; default: never.")

    @field_validator("components")
    @classmethod
    def _once(cls, components: tuple[str, ...]) -> tuple[str, ...]:
        if len(set(components)) < len(components):
            raise problem("each component at most once")
        return components


class Twist(Spec):
    """Turns edges about the rod; positions stay free."""

    type: Literal["twist"] = Field(description="Kind of motion.")
    where: SelectedEdges = Field(description="Edges: the end of a rod, or some of its edges.")
    angle: AngleLaw = Field(description="Rotation from rest.")
    release: Time | None = Field(default=None, description="Time at which it lets go; default: never.")


class Symmetry(Spec):
    """Makes a plane one of mirror symmetry for the shells in it, of which the scene has the part on one side.

    Nodes stay in the plane, and so do the mid-edge normals of the edges between them. Give such nodes the
    part's share of forces and masses: half of that of the whole in a plane, a quarter where two planes meet;
    reactions are those of the part. Bending other than `midedge` needs the whole structure.
    """

    type: Literal["symmetry"] = Field(description="Kind of motion.")
    where: SelectedNodes = Field(description="Nodes in the plane.")
    normal: Literal["x", "y", "z"] = Field(description="Axis across the plane.")

    @property
    def release(self) -> float | None:
        """Never: the mirror image stays."""
        return None


Motion: TypeAlias = Annotated[Clamp | Pin | Twist | Symmetry, Field(discriminator="type")]


class VelocityFile(Spec):
    """One velocity per selected node from a CSV file [m/s]."""

    file: FileName = Field(description="CSV file; its first line may name the columns.")
    columns: Annotated[tuple[Column, ...], Len(3, 3), Strict(False)] = Field(
        default=(0, 1, 2), description="Columns of the components, by name or number from 0."
    )


class InitialVelocity(Spec):
    """Velocity at t = 0."""

    where: SelectedNodes = Field(description="Nodes that move; the name of a rod means all of them.")
    velocity: Annotated[
        Annotated[VelocityTriple, Tag("<one>")] | Annotated[VelocityFile, Tag("<file>")],
        told_by_key("file", scalar="<one>"),
    ] = Field(description="The same for all, or one each from a file.")
