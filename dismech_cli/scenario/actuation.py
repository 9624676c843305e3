"""Natural strains that change in time."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import Field

from .law import LawOf, LawSpec
from .quantity import Name
from .selection import IndexRange
from .spec import Spec

_ALONG = ("t", "s")


_JOINTS = Field(
    default=None, description="First and last joint (for stretch: edge), both included; default: all."
)


class StretchActuation(Spec):
    """Adds to the natural axial strain of the edges."""

    type: Literal["stretch"] = Field(description="Kind of strain.")
    rod: Name = Field(description="Name of the rod.")
    joints: IndexRange | None = _JOINTS
    value: Annotated[LawSpec, LawOf("ratio", _ALONG)] = Field(description="Added strain.")


class CurvatureActuation(Spec):
    """Adds to the natural curvature about a material director."""

    type: Literal["curvature_1", "curvature_2"] = Field(description="Kind of strain.")
    rod: Name = Field(description="Name of the rod.")
    joints: IndexRange | None = _JOINTS
    value: Annotated[LawSpec, LawOf("curvature", _ALONG)] = Field(description="Added curvature.")


class TwistActuation(Spec):
    """Adds to the natural twist."""

    type: Literal["twist"] = Field(description="Kind of strain.")
    rod: Name = Field(description="Name of the rod.")
    joints: IndexRange | None = _JOINTS
    value: Annotated[LawSpec, LawOf("twist rate", _ALONG)] = Field(description="Added twist per length.")


Actuation: TypeAlias = Annotated[
    StretchActuation | CurvatureActuation | TwistActuation, Field(discriminator="type")
]
