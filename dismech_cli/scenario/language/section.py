"""Cross-sections of rods."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import Field, model_validator

from ..values.quantity import PositiveLength, Quantity
from ..values.spec import Spec, problem


class RoundSection(Spec):
    """A full circle."""

    type: Literal["round"] = Field(description="Kind of section.")
    radius: PositiveLength = Field(description="Radius.")


class TubeSection(Spec):
    """A circular tube."""

    type: Literal["tube"] = Field(description="Kind of section.")
    outer_radius: PositiveLength = Field(description="Outer radius.")
    inner_radius: PositiveLength = Field(description="Inner radius.")

    @model_validator(mode="after")
    def _hollow(self) -> TubeSection:
        if self.inner_radius >= self.outer_radius:
            raise problem(
                f"the inner radius of a tube must be less than the outer one, "
                f"got {self.inner_radius:g} m and {self.outer_radius:g} m"
            )
        return self


class RectangularSection(Spec):
    """A full rectangle."""

    type: Literal["rectangular"] = Field(description="Kind of section.")
    thickness: PositiveLength = Field(description="Side along the material director m1.")
    width: PositiveLength = Field(description="Side along the material director m2.")
    torsion_constant: Annotated[float, Quantity("torsion constant", gt=0)] | None = Field(
        default=None, description="St. Venant torsion constant; default: that of the rectangle."
    )


class GivenSection(Spec):
    """Stiffness and inertia given directly instead of following from material and shape."""

    type: Literal["given"] = Field(description="Kind of section.")
    axial_stiffness: Annotated[float, Quantity("force", gt=0)] = Field(description="EA.")
    bending_stiffness_1: Annotated[float, Quantity("bending stiffness", gt=0)] = Field(
        description="EI against `curvature_1`."
    )
    bending_stiffness_2: Annotated[float, Quantity("bending stiffness", gt=0)] = Field(
        description="EI against `curvature_2`."
    )
    torsional_stiffness: Annotated[float, Quantity("bending stiffness", gt=0)] = Field(description="GJ.")
    mass_per_length: Annotated[float, Quantity("mass per length", gt=0)] = Field(
        description="Mass per length."
    )
    rotary_inertia_per_length: Annotated[float, Quantity("inertia per length", gt=0)] = Field(
        description="Polar rotary inertia per length."
    )
    radius: PositiveLength = Field(description="Radius for drawing and drag.")


Section: TypeAlias = Annotated[
    RoundSection | TubeSection | RectangularSection | GivenSection, Field(discriminator="type")
]
