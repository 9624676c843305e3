"""How statics follow a path of equilibria through limit points."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, ValidationInfo, WithJsonSchema, field_validator

from ...units import KINDS
from ..values.quantity import Quantity, to_si
from ..values.spec import Spec
from .probe import Probe, quantity_of

_NUMBER_OR_TEXT = WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}]})


class Until(Spec):
    """The end of a path: where a probe of the shape passes a value."""

    probe: Probe = Field(
        description="Displacement, position, distance, mean position, twist, turn or load factor."
    )
    value: Annotated[float, _NUMBER_OR_TEXT] = Field(description="The value, in the unit of the probe.")

    @field_validator("value", mode="before")
    @classmethod
    def _quantity(cls, value: object, info: ValidationInfo) -> Any:
        if "probe" not in info.data:
            return 0.0  # the probe is wrong and has been reported
        return to_si(value, KINDS[quantity_of(info.data["probe"])])


class LoadPath(Spec):
    """A path of equilibria by arc length: the load factor is an unknown, and may fall as well as rise.

    Loads, displacements and actuation written as constants are multiplied by the load factor, beyond 1 too;
    in a law `t` is the load factor. The time of frames is the length of the path: one unit is a tenth of the
    robot's size (root mean square), half a turn of its angles, or the whole `load_factor`.
    """

    load_factor: Annotated[float, Quantity("ratio", gt=0)] = Field(
        default=1.0, description="Where the path ends, unless `until` says where."
    )
    until: Until | None = Field(default=None, description="Where the path ends instead.")
    steps: Annotated[int, Field(ge=1, le=1_000_000)] = Field(
        default=500, description="Most steps; a path that has not come to its end by then says so."
    )
    first: Annotated[float, Quantity("ratio", gt=0, le=10)] = Field(
        default=0.02, description="Length of the first step; then as Newton's method finds its way."
    )
    largest: Annotated[float, Quantity("ratio", gt=0, le=10)] = Field(
        default=0.25, description="Greatest length of a step."
    )
