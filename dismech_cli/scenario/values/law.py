"""Laws of time in the scenario."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any, Final, Literal, TypeAlias

from annotated_types import Len
from pydantic import Field, Strict, Tag, field_validator, model_validator

from ...laws.expression import VARIABLES, ExpressionError, compile_expression
from ...words import listed
from .law_of import FieldValue, LawOf, Row, variables_here
from .quantity import Angle, Column, FileName, Frequency, Quantity, Time
from .spec import Spec, problem, tag, told_by_key

PLACES: Final = ("x", "y", "z", "r")
"""Variables of laws that differ from place to place [m]; most take where a node or hinge is at rest."""


class TableFile(Spec):
    """A table in a CSV file, in SI units; the first line may name the columns."""

    file: FileName = Field(description="CSV file.")
    time: Column = Field(default=0, description="Column of the times, by name or number from 0.")
    value: Column = Field(default=1, description="Column of the values, by name or number from 0.")


class TableLaw(Spec):
    """Values at given times, held before the first and after the last."""

    table: Annotated[
        Annotated[tuple[Row, ...], Len(1, 1_000_000), Strict(False), Tag("<rows>")]
        | Annotated[TableFile, Tag("<file>")],
        told_by_key("file", scalar="<rows>"),
    ] = Field(description="Rows of time and value, or a file.")
    interpolation: Literal["linear", "step", "cubic"] = Field(
        default="linear",
        description="`step` holds each value until the next time; `cubic` is a natural spline.",
    )

    @field_validator("table", mode="after")
    @classmethod
    def _ascending(cls, table: tuple[tuple[float, ...], ...] | TableFile) -> Any:
        if isinstance(table, tuple):
            for (before, *_), (after, *_) in pairwise(table):
                if after <= before:
                    raise problem(f"the times of a table must increase, but {after:g} follows {before:g}")
        return table


class Ramp(Spec):
    """From one value to another between two times, held outside."""

    before: FieldValue = Field(alias="from", description="Value until `start`.")
    after: FieldValue = Field(alias="to", description="Value from `end` on.")
    start: Time = Field(default=0.0, description="Time at which the ramp starts.")
    end: Time = Field(description="Time at which the ramp ends.")

    @model_validator(mode="after")
    def _forward(self) -> Ramp:
        if self.end <= self.start:
            raise problem(
                f"a ramp must end after its start, but it goes from {self.start:g} s to {self.end:g} s"
            )
        return self


class RampLaw(Spec):
    """A ramp."""

    ramp: Ramp = Field(description="The ramp.")


class Sine(Spec):
    """offset + amplitude sin(2 pi frequency t + phase)."""

    amplitude: FieldValue = Field(description="Half of the swing.")
    frequency: Frequency = Field(description="Cycles per second.")
    phase: Angle = Field(default=0.0, description="Phase at t = 0.")
    offset: FieldValue = Field(default=0.0, description="Mean value.")


class SineLaw(Spec):
    """A sinusoid."""

    sine: Sine = Field(description="The sinusoid.")


class Sawtooth(Spec):
    """offset + amplitude w(2 pi frequency t + phase), w rising from -1 to 1 and falling back."""

    amplitude: FieldValue = Field(description="Half of the swing.")
    frequency: Frequency = Field(description="Cycles per second.")
    phase: Angle = Field(default=0.0, description="Phase at t = 0.")
    offset: FieldValue = Field(default=0.0, description="Mean value.")
    width: Annotated[float, Quantity("ratio", ge=0, le=1)] = Field(
        default=1.0, description="Rising part of the period; 0.5 is a triangle."
    )


class SawtoothLaw(Spec):
    """A sawtooth."""

    sawtooth: Sawtooth = Field(description="The sawtooth.")


class ExpressionLaw(Spec):
    """Arithmetic in SI units: numbers, t, pi, e, + - * / **, sin cos tan tanh exp log sqrt abs min
    max clip floor sawtooth square step smoothstep; under `actuation` also s, 0 to 1 along the rod or
    through the hinges, and for hinges and triangles x, y, z and r = sqrt(x^2 + y^2) of their middle
    at rest; in a `displacement` x, y, z of the node at rest, and s along its rod; in a
    `fluid_velocity` x, y, z where the body is now."""  # noqa: D205, D209

    expression: str = Field(description="The text.")

    @field_validator("expression", mode="after")
    @classmethod
    def _parses(cls, text: str) -> str:
        try:
            compiled = compile_expression(text, (*VARIABLES, *PLACES))
        except ExpressionError as error:
            raise problem(f"{error.reason} (at column {error.column} of the expression)") from None
        foreign = sorted(compiled.variables.difference(variables_here()))
        if foreign:
            raise problem(f"{listed(foreign)} has no meaning here; known: {listed(variables_here())}")
        return text


LawSpec: TypeAlias = Annotated[
    Annotated[FieldValue, Tag("<constant>")]
    | Annotated[TableLaw, Tag(tag("table"))]
    | Annotated[RampLaw, Tag(tag("ramp"))]
    | Annotated[SineLaw, Tag(tag("sine"))]
    | Annotated[SawtoothLaw, Tag(tag("sawtooth"))]
    | Annotated[ExpressionLaw, Tag(tag("expression"))],
    told_by_key("table", "ramp", "sine", "sawtooth", "expression", scalar="<constant>"),
]

DisplacementLaw: TypeAlias = Annotated[LawSpec, LawOf("length", ("t", "s", "x", "y", "z"))]
AngleLaw: TypeAlias = Annotated[LawSpec, LawOf("angle")]
ForceLaw: TypeAlias = Annotated[LawSpec, LawOf("force")]
MomentLaw: TypeAlias = Annotated[LawSpec, LawOf("moment")]
PressureLaw: TypeAlias = Annotated[LawSpec, LawOf("pressure")]
AccelerationLaw: TypeAlias = Annotated[LawSpec, LawOf("acceleration")]
ForcePerLengthLaw: TypeAlias = Annotated[LawSpec, LawOf("force per length")]
MomentPerLengthLaw: TypeAlias = Annotated[LawSpec, LawOf("moment per length")]

PlaceLaw: TypeAlias = Annotated[LawSpec, LawOf("length", ("s", "x", "y", "z"))]
FlowLaw: TypeAlias = Annotated[LawSpec, LawOf("velocity", ("t", "x", "y", "z"))]

DisplacementLaws: TypeAlias = Annotated[tuple[DisplacementLaw, ...], Len(3, 3), Strict(False)]
ForceLaws: TypeAlias = Annotated[tuple[ForceLaw, ...], Len(3, 3), Strict(False)]
MomentLaws: TypeAlias = Annotated[tuple[MomentLaw, ...], Len(3, 3), Strict(False)]
AccelerationLaws: TypeAlias = Annotated[tuple[AccelerationLaw, ...], Len(3, 3), Strict(False)]
ForcePerLengthLaws: TypeAlias = Annotated[tuple[ForcePerLengthLaw, ...], Len(3, 3), Strict(False)]
MomentPerLengthLaws: TypeAlias = Annotated[tuple[MomentPerLengthLaw, ...], Len(3, 3), Strict(False)]
FluidVelocity: TypeAlias = Annotated[tuple[FlowLaw, ...], Len(3, 3), Strict(False)]
PlaceLaws: TypeAlias = Annotated[tuple[PlaceLaw, ...], Len(3, 3), Strict(False)]
