"""What a body is made of."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ..values.quantity import Quantity
from ..values.spec import Spec


class Material(Spec):
    """A linear elastic material."""

    youngs_modulus: Annotated[float, Quantity("pressure", gt=0)] = Field(description="Young's modulus.")
    poisson_ratio: Annotated[float, Quantity("ratio", gt=-1, le=0.5)] = Field(description="Poisson's ratio.")
    density: Annotated[float, Quantity("density", gt=0)] = Field(description="Mass per volume.")
