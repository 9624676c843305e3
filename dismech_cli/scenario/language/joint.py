"""How bodies hang together."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import Field, model_validator

from ..values.quantity import PositiveLength
from ..values.selection import JoinedNode, JoinedPair
from ..values.spec import Spec, exactly_one, exclusive, problem
from .seam import Seam


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


Joint: TypeAlias = Annotated[RigidJoint | HingeJoint | Seam, Field(discriminator="type")]
