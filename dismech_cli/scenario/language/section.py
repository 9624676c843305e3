"""Cross-sections of rods."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import Field, model_validator

from ..values.spec import Spec, problem
from ..values.varying import (
    VaryingBendingStiffness,
    VaryingForce,
    VaryingInertiaPerLength,
    VaryingLength,
    VaryingMassPerLength,
    VaryingTorsionConstant,
)


class RoundSection(Spec):
    """A full circle."""

    type: Literal["round"] = Field(description="Kind of section.")
    radius: VaryingLength = Field(description="Radius.")


class TubeSection(Spec):
    """A circular tube."""

    type: Literal["tube"] = Field(description="Kind of section.")
    outer_radius: VaryingLength = Field(description="Outer radius.")
    inner_radius: VaryingLength = Field(description="Inner radius.")

    @model_validator(mode="after")
    def _hollow(self) -> TubeSection:
        inner, outer = self.inner_radius, self.outer_radius
        # where one varies, they are compared on the body
        if isinstance(inner, float) and isinstance(outer, float) and inner >= outer:
            raise problem(
                f"the inner radius of a tube must be less than the outer one, got {inner:g} m and {outer:g} m"
            )
        return self


class RectangularSection(Spec):
    """A full rectangle."""

    type: Literal["rectangular"] = Field(description="Kind of section.")
    thickness: VaryingLength = Field(description="Side along the material director m1.")
    width: VaryingLength = Field(description="Side along the material director m2.")
    torsion_constant: VaryingTorsionConstant | None = Field(
        default=None, description="St. Venant torsion constant; default: that of the rectangle."
    )


class GivenSection(Spec):
    """Stiffness and inertia given directly instead of following from material and shape."""

    type: Literal["given"] = Field(description="Kind of section.")
    axial_stiffness: VaryingForce = Field(description="EA.")
    bending_stiffness_1: VaryingBendingStiffness = Field(description="EI against `curvature_1`.")
    bending_stiffness_2: VaryingBendingStiffness = Field(description="EI against `curvature_2`.")
    torsional_stiffness: VaryingBendingStiffness = Field(description="GJ.")
    mass_per_length: VaryingMassPerLength = Field(description="Mass per length.")
    rotary_inertia_per_length: VaryingInertiaPerLength = Field(description="Polar rotary inertia per length.")
    radius: VaryingLength = Field(description="Radius for drawing and drag.")


Section: TypeAlias = Annotated[
    RoundSection | TubeSection | RectangularSection | GivenSection, Field(discriminator="type")
]
