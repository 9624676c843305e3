"""What a body is made of."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from ..values.quantity import Quantity, Time
from ..values.spec import Spec, problem
from ..values.varying import VaryingDensity, VaryingModulus


class Material(Spec):
    """An elastic material."""

    youngs_modulus: VaryingModulus = Field(description="Young's modulus.")
    poisson_ratio: Annotated[float, Quantity("ratio", gt=-1, le=0.5)] = Field(description="Poisson's ratio.")
    density: VaryingDensity = Field(description="Mass per volume.")
    model: Literal["st_venant_kirchhoff", "neo_hookean"] = Field(
        default="st_venant_kirchhoff",
        description="How it stretches: `st_venant_kirchhoff` stress proportional to strain, for strains up "
        "to about 20 %; `neo_hookean` incompressible rubber, up to stretches of about 3, thinner as it "
        "stretches. Bending and twisting keep the stiffness of the rest shape.",
    )

    relaxation_time: Time = Field(
        default=0.0,
        description="Material damping (Kelvin and Voigt): a strain that changes adds the stress of this time "
        "its rate, in stretching, bending and twisting alike; it damps a mode of angular frequency w by the "
        "ratio w/2 times it. Statics do not know it.",
    )

    @model_validator(mode="after")
    def _sound(self) -> Material:
        if self.model == "neo_hookean" and self.poisson_ratio != 0.5:
            raise problem(
                f"neo_hookean is incompressible: 'poisson_ratio' must be 0.5, got {self.poisson_ratio:g}"
            )
        return self
