"""How far from perfect the shape of the bodies is."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from ..values.quantity import PositiveLength
from ..values.spec import Spec, problem


class Imperfection(Spec):
    """A small deviation of the shape, which lets what is perfectly straight, round or flat buckle.

    It has the shape of soft modes of the scene as it is held at the start, without its loads: eigenvectors
    of the stiffness against the mass, rigid motions left out. Where two are equally soft, as in the two
    planes of a round column, the first deviates along the first axis.
    """

    amplitude: PositiveLength = Field(description="Largest deviation of a node.")
    mode: Annotated[int, Field(ge=1, le=20)] | Literal["random"] = Field(
        default=1, description="Number of the mode from the softest on; `random` mixes the first ten."
    )
    seed: Annotated[int, Field(ge=0)] | None = Field(
        default=None, description="Of the random numbers, 0 by default; only with `random`."
    )
    stress_free: bool = Field(
        default=True,
        description="Whether the bodies are made in the imperfect shape. If not, they are only pushed into "
        "it when a run in time starts, and pull back; statics would forget that.",
    )

    @model_validator(mode="after")
    def _seeded(self) -> Imperfection:
        if self.seed is not None and self.mode != "random":
            raise problem("'seed' has a meaning with mode: random only")
        return self
