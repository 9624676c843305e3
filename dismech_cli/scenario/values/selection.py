"""Which nodes or edges a key acts on."""

from __future__ import annotations

from enum import Enum, auto
from typing import Annotated, Any, Final, TypeAlias

from annotated_types import Len
from pydantic import Field, GetJsonSchemaHandler, Strict, Tag, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from ...frozen import frozen
from .quantity import DirectionTriple, Index, LengthTriple, Name, PositiveLength
from .spec import Spec, exactly_one, exclusive, problem, tag, told_by_key

IndexRange: TypeAlias = Annotated[tuple[Index, ...], Len(2, 2), Strict(False)]
Indices: TypeAlias = Annotated[tuple[Index, ...], Len(1, 10_000_000), Strict(False)]


class Selects(Enum):
    """Marks a field by what its selections find."""

    NODES = auto()
    """Nodes, after joints made some of them one."""
    EDGES = auto()
    """Edges of rods."""
    JOINED = auto()
    """One node for a joint, of the bodies as they are before."""
    SEWN = auto()
    """Nodes for a seam, likewise."""


class IndexSet(Spec):
    """Nodes of a body or edges of a rod by number, from 0."""

    model_config = exclusive(("indices", "range"))

    of: Name = Field(description="Name of the body.")
    indices: Indices | None = Field(default=None, description="Numbers.")
    range: IndexRange | None = Field(default=None, description="First and last number, both included.")

    @model_validator(mode="after")
    def _one(self) -> IndexSet:
        exactly_one(self, "indices", "range")
        if self.range is not None and self.range[1] < self.range[0]:
            raise problem(f"a range goes from first to last, got {list(self.range)}")
        return self


class Box(Spec):
    """A box along the axes."""

    min: LengthTriple = Field(description="Lower corner.")
    max: LengthTriple = Field(description="Upper corner.")

    @model_validator(mode="after")
    def _ordered(self) -> Box:
        if any(low > high for low, high in zip(self.min, self.max, strict=True)):
            raise problem("the upper corner of a box must not lie below the lower one")
        return self


class Plane(Spec):
    """A slab about a plane."""

    point: LengthTriple = Field(description="A point of the plane.")
    normal: DirectionTriple = Field(description="Its normal, of any length.")
    within: PositiveLength = Field(description="Greatest distance from the plane.")


class Sphere(Spec):
    """A ball."""

    center: LengthTriple = Field(description="Its centre.")
    radius: PositiveLength = Field(description="Its radius.")


_GROUP: Final = r"^[A-Za-z_][A-Za-z0-9_-]{0,63}(\.\S.{0,99})?$"


class GroupSelection(Spec):
    """A named group; text is short for it.

    `beam` is all of a body, `beam.start` and `beam.end` are the ends of a rod, `sheet.boundary` the rims
    of a shell, `sheet.left` and the like the groups of a generated one, `beam.NAME` those of a mesh.
    """

    group: str = Field(pattern=_GROUP, description="Name of the group.")

    @model_validator(mode="before")
    @classmethod
    def _shorthand(cls, value: Any) -> Any:
        return {"group": value} if isinstance(value, str) else value


class NodeSelection(Spec):
    """Nodes of a body by number."""

    nodes: IndexSet = Field(description="Body and numbers.")


class EdgeSelection(Spec):
    """Edges of a rod by number."""

    edges: IndexSet = Field(description="Rod and numbers.")


class BoxSelection(Spec):
    """All nodes in a box."""

    box: Box = Field(description="The box.")


class PlaneSelection(Spec):
    """All nodes near a plane."""

    plane: Plane = Field(description="The plane.")


class SphereSelection(Spec):
    """All nodes in a sphere."""

    sphere: Sphere = Field(description="The sphere.")


class NearestSelection(Spec):
    """The node nearest to a point."""

    nearest: LengthTriple = Field(description="The point.")


@frozen
class TextToo:
    """Tells editors that text is taken as well, which is short for a mapping."""

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return {"anyOf": [{"type": "string", "pattern": _GROUP}, handler(schema)]}


Selection: TypeAlias = Annotated[
    Annotated[GroupSelection, Tag(tag("group"))]
    | Annotated[NodeSelection, Tag(tag("nodes"))]
    | Annotated[EdgeSelection, Tag(tag("edges"))]
    | Annotated[BoxSelection, Tag(tag("box"))]
    | Annotated[PlaneSelection, Tag(tag("plane"))]
    | Annotated[SphereSelection, Tag(tag("sphere"))]
    | Annotated[NearestSelection, Tag(tag("nearest"))],
    told_by_key("group", "nodes", "edges", "box", "plane", "sphere", "nearest", scalar=tag("group")),
    TextToo(),
]
"""A selection as written; a field says with one of the marked ones below what it is for."""

SelectedNodes: TypeAlias = Annotated[Selection, Selects.NODES]
SelectedEdges: TypeAlias = Annotated[Selection, Selects.EDGES]
JoinedNode: TypeAlias = Annotated[Selection, Selects.JOINED]
SeamNodes: TypeAlias = Annotated[Selection, Selects.SEWN]
TwoPlaces: TypeAlias = Annotated[tuple[SelectedNodes, ...], Len(2, 2), Strict(False)]
JoinedPair: TypeAlias = Annotated[tuple[JoinedNode, ...], Len(2, 2), Strict(False)]
