"""Seams between shells."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from annotated_types import Len
from pydantic import Field, Strict, model_validator

from ..values.quantity import Name, PositiveLength
from ..values.selection import SeamNodes
from ..values.spec import Spec, problem

Sewn: TypeAlias = Annotated[tuple[Name, ...], Len(2, 100), Strict(False)]


class Seam(Spec):
    """Joins shells along the sides of triangles that they have in common, node by node.

    Each node of a seam lies on the rim of one shell at least, so that sheets which lie on each other are
    joined around, not all over.
    """

    type: Literal["seam"] = Field(description="Kind of joint.")
    shells: Sewn = Field(description="Names of the shells.")
    bending: Literal["weld", "hinge"] = Field(
        description="`weld` keeps the angles between the shells as a rigid edge does; `hinge` passes no "
        "moment."
    )
    where: SeamNodes | None = Field(
        default=None, description="Only at these nodes; default: wherever the shells meet."
    )
    within: PositiveLength | None = Field(
        default=None,
        description="Distance up to which nodes are joined, at the place of the shell named first; default: "
        "a millionth of the shortest side.",
    )

    @model_validator(mode="after")
    def _different(self) -> Seam:
        if len(set(self.shells)) < len(self.shells):
            raise problem("a seam joins different shells; one is named twice")
        return self
