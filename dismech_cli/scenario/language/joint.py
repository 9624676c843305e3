"""How bodies hang together."""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeAlias

from annotated_types import Len
from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, Strict, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from ...frozen import frozen
from ..values.quantity import Name, PositiveLength
from ..values.selection import JoinedNode, JoinedPair
from ..values.spec import Spec, exactly_one, exclusive, problem
from .seam import Seam

BodyPair: TypeAlias = Annotated[tuple[Name, ...], Len(2, 2), Strict(False)]


class RigidJoint(Spec):
    """Welds two coinciding nodes: bending and twist pass through every pair of edges there.

    A node of a rod may be welded to a shell: the rod then turns with the triangles around it.
    """

    type: Literal["rigid"] = Field(description="Kind of joint.")
    nodes: JoinedPair = Field(description="The two nodes.")
    release: Literal["bending", "twist"] | None = Field(
        default=None, description="What does not pass after all; for both, take `hinge`."
    )
    footprint: PositiveLength | None = Field(
        default=None,
        description="Joint to a shell: the rod turns with the triangles whose middles are so near, and with "
        "those around the node; default: the radius of the rod. A weld to triangles larger than that "
        "softens as they shrink.",
    )


class HingeJoint(Spec):
    """Joins two coinciding nodes, or releases one: no bending or twist passes, or one of them alone.

    Nodes that a shell and another body take from one mesh file are joined so without being asked.
    """

    model_config = exclusive(("nodes", "where"))

    type: Literal["hinge"] = Field(description="Kind of joint.")
    nodes: JoinedPair | None = Field(default=None, description="The two nodes; this or `where`.")
    where: JoinedNode | None = Field(default=None, description="A node within a rod; this or `nodes`.")
    release: Literal["bending", "twist"] | None = Field(
        default=None, description="What alone does not pass at `where`; default: neither does."
    )

    @model_validator(mode="after")
    def _one(self) -> HingeJoint:
        exactly_one(self, "nodes", "where")
        if self.nodes is not None and self.release is not None:
            raise problem("'release' has a meaning with 'where'; two nodes take type: rigid with it")
        return self


class AutoJoint(Spec):
    """Joins bodies wherever a node of one lies on a node of another; `joints: auto` is short for it.

    Nodes that another joint names are left to it, and so are the two ends of one body.
    """

    type: Literal["auto"] = Field(description="Kind of joint.")
    between: BodyPair | None = Field(default=None, description="Two bodies; default: all, pair by pair.")
    tolerance: PositiveLength | None = Field(
        default=None,
        description="Greatest distance of two nodes that become one, at the place of the body listed first; "
        "default: a millionth of the shortest edge.",
    )
    join: Literal["rigid", "hinge"] | None = Field(
        default=None, description="How; default: rods rigidly to each other, shells by hinges."
    )


Joint: TypeAlias = Annotated[RigidJoint | HingeJoint | AutoJoint | Seam, Field(discriminator="type")]


@frozen
class _AutoToo:
    """Takes the word ``auto`` for a list of one joint, and tells editors so."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(_spelt_out, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return {"anyOf": [{"const": "auto"}, handler(schema)]}


def _spelt_out(value: Any) -> Any:
    return ({"type": "auto"},) if value == "auto" else value


Joints: TypeAlias = Annotated[tuple[Joint, ...], Strict(False), _AutoToo()]
