"""What a scenario promises: probes with a value, a tolerance and a source."""

from __future__ import annotations

from decimal import Decimal, InvalidOperation
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Field, ValidationInfo, WithJsonSchema, field_serializer, field_validator

from ...quantities import QuantityError, read_quantity
from ...units import KINDS
from ..text.tree import describe
from ..values.quantity import Time, to_si
from ..values.spec import Spec, problem
from .probe import Probe, quantity_of

Reduction: TypeAlias = Literal["last", "first", "min", "max", "mean", "gain", "span", "period"]

_NUMBER_OR_TEXT = WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}]})


class Tolerance(Spec):
    """Greatest allowed deviation.

    Attributes:
        kind: ``relative`` to the expected value, or ``absolute`` in the unit of the probe.
        size: The deviation.
    """

    kind: Literal["relative", "absolute"]
    size: Annotated[float, Field(ge=0)]

    def allows(self, measured: float, expected: float) -> bool:
        """True if ``measured`` is near enough to ``expected``; never for NaN."""
        scale = abs(expected) if self.kind == "relative" else 1.0
        return abs(measured - expected) <= self.size * scale


class Expectation(Spec):
    """A number that the run must give, else it ends with exit code 4."""

    probe: Probe = Field(description="What is measured.")
    reduce: Reduction = Field(
        default="last",
        description="What becomes of its course over time: `gain` is last minus first, `span` max minus min, "
        "`period` the mean time between upward crossings of the mean.",
    )
    at: Time | None = Field(default=None, description="Time of measurement, in place of `reduce`.")
    after: Time | None = Field(default=None, description="Ignores what was before this time.")
    value: Annotated[float, _NUMBER_OR_TEXT] = Field(description="Expected value, in the unit of the probe.")
    tolerance: Annotated[Tolerance, _NUMBER_OR_TEXT] = Field(description="`1 %` of the value, or a quantity.")
    source: str = Field(min_length=1, description="Where the value comes from.")

    @field_validator("value", mode="before")
    @classmethod
    def _quantity(cls, value: object, info: ValidationInfo) -> Any:
        quantity = _measured(info)
        if quantity is None:
            return 0.0  # the probe is wrong and has been reported
        return to_si(value, KINDS[quantity])

    @field_validator("tolerance", mode="before")
    @classmethod
    def _deviation(cls, value: object, info: ValidationInfo) -> Any:
        if isinstance(value, Tolerance):
            return value
        quantity = _measured(info)
        if isinstance(value, str) and value.strip().endswith("%"):
            kind, size = "relative", _percent(value)
        elif quantity is None:
            kind, size = "absolute", 0.0
        else:
            kind, size = "absolute", to_si(value, KINDS[quantity])
        if size < 0:
            raise problem(f"a tolerance must not be negative, got {describe(value)}")
        return {"kind": kind, "size": size}

    @field_serializer("tolerance")
    def _written(self, tolerance: Tolerance) -> str | float:
        if tolerance.kind == "absolute":
            return tolerance.size
        return f"{Decimal(repr(tolerance.size)) * 100:f} %"


def _percent(text: str) -> float:
    """``'7 %'`` as exactly 0.07: a decimal shift, so that a written tolerance reads back unchanged."""
    try:
        read_quantity(text)
        return float(Decimal(text.strip().removesuffix("%").strip()) / 100)
    except (QuantityError, InvalidOperation) as error:
        raise problem(str(error) if isinstance(error, QuantityError) else f"cannot read '{text}'") from None


def _measured(info: ValidationInfo) -> str | None:
    """The quantity that an expectation compares, or None if its probe is unknown."""
    if "probe" not in info.data:
        return None
    return measured(info.data["probe"], info.data.get("reduce", "last"))


def measured(probe: Probe, reduction: Reduction) -> str:
    """What a reduced probe gives: a key of :data:`.units.KINDS`."""
    return "time" if reduction == "period" else quantity_of(probe)
