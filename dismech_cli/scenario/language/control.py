"""Controllers of natural strains: what they follow, and by which law."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeAlias

from annotated_types import Len
from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    Strict,
    Tag,
    ValidatorFunctionWrapHandler,
    model_validator,
)

from ..values.law import (
    PLACES,
    ExpressionLaw,
    RampLaw,
    SawtoothLaw,
    SineLaw,
    TableLaw,
)
from ..values.law_of import FieldValue, LawOf
from ..values.quantity import FileName, FileReference, Name, PositiveTime, Quantity, Time
from ..values.spec import Spec, problem, tag, told_by_key
from ..values.strain import ANY, ANY_RATE, Strain, StrainQuantity, read_within
from .shape_file import ShapeFile

_Share: TypeAlias = Annotated[float, Quantity("ratio", ge=0, le=1)]
_Gain: TypeAlias = Annotated[float, Quantity("ratio", ge=0)]


class ShapeTarget(Spec):
    """The strains of a shape."""

    shape: ShapeFile = Field(description="Where the nodes of the driven body lie in it.")


class EachFile(Spec):
    """A table of a strain in SI units: a column of times, then one for each driven joint, edge, hinge or
    triangle in their order."""  # noqa: D205, D209

    file: FileName = Field(description="CSV file; its first line may name the columns.")
    interpolation: Literal["linear", "cubic"] = Field(
        default="cubic", description="Between rows; the first and the last are held outside."
    )


class EachTarget(Spec):
    """A course over time for each driven joint, edge, hinge or triangle."""

    each: EachFile = Field(description="Where it is.")


class RunTarget(Spec):
    """What the same body did in another run: its strains in the frames of that, cubic in time."""

    run: Annotated[str, FileReference(folder=True), Field(min_length=1, max_length=1000)] = Field(
        description="Folder of the run, relative to this file."
    )


Target: TypeAlias = Annotated[
    Annotated[
        Annotated[FieldValue, Tag("<constant>")]
        | Annotated[TableLaw, Tag(tag("table"))]
        | Annotated[RampLaw, Tag(tag("ramp"))]
        | Annotated[SineLaw, Tag(tag("sine"))]
        | Annotated[SawtoothLaw, Tag(tag("sawtooth"))]
        | Annotated[ExpressionLaw, Tag(tag("expression"))]
        | Annotated[ShapeTarget, Tag(tag("shape"))]
        | Annotated[EachTarget, Tag(tag("each"))]
        | Annotated[RunTarget, Tag(tag("run"))],
        told_by_key(
            "table", "ramp", "sine", "sawtooth", "expression", "shape", "each", "run", scalar="<constant>"
        ),
    ],
    LawOf(ANY, ("t", "s", *PLACES)),
]


class Gains(Spec):
    """Gains of u = feed_forward r + F(p (setpoint_weight r - y) + I - d dy/dt), dI/dt = i (r - y)."""

    p: _Gain = Field(default=0.0, description="Of the error.")
    i: Annotated[float, Quantity("frequency", ge=0)] = Field(default=0.0, description="Of its sum over time.")
    d: Time = Field(default=0.0, description="Against the rate of what is measured.")
    setpoint_weight: _Share = Field(default=1.0, description="Share of the target in the error of `p`.")

    @model_validator(mode="after")
    def _some(self) -> Gains:
        if self.p == 0.0 and self.i == 0.0:
            raise problem("gains without p and i close no loop; give one of them")
        return self


class ControlLimits(Spec):
    """What an actuator can do; each joint, edge, hinge or triangle for itself."""

    magnitude: Annotated[float, StrainQuantity(ANY, gt=0)] | None = Field(
        default=None, description="Greatest command, either way."
    )
    rate: Annotated[float, StrainQuantity(ANY_RATE, gt=0)] | None = Field(
        default=None, description="Greatest rate of the command."
    )


_STRAIN = Field(
    default=None, description="The strain that it commands; that of its actuation, which says so."
)
_SENSOR = Field(
    default=None,
    description="Sensor of the strain that it commands, at the same places; default: one without noise and "
    "delay.",
)
_TARGET = Field(
    description="What the strain shall be: a law, the strains of a shape ([ShapeTarget](#shapetarget)), a "
    "course for each place ([EachTarget](#eachtarget)) or what another run did ([RunTarget](#runtarget))."
)
_LIMITS = Field(default=ControlLimits.unsaid(), description="What the actuator can do.")
_PERIOD = Field(
    description="Time between samples; where it is no multiple of dt, steps end at the samples all the same."
)
_START = Field(default=0.0, description="Time of the first sample; there is no command before.")
_HOLD: Any = Field(
    default="ramp",
    description="`ramp`: a command is reached at the next sample, straight from the last; `step`: at once.",
)
Hold: TypeAlias = Literal["ramp", "step"]


class Positional(Spec):
    """A PI(D) controller at every joint, edge, hinge or triangle, once per period."""

    type: Literal["pi"] = Field(description="Kind of controller.")
    strain: Strain | None = _STRAIN
    feedback: Literal["sampled"] = Field(default="sampled", description="How the loop is closed.")
    sensor: Name | None = _SENSOR
    target: Target = _TARGET
    feed_forward: _Gain = Field(default=1.0, description="Share of the target that is commanded at once.")
    gains: Gains = Field(description="Gains.")
    smoothing: Annotated[float, Quantity("length", ge=0)] = Field(
        default=0.0,
        description="Length over which what is fed back is smoothed along the body; the target is not.",
    )
    limits: ControlLimits = _LIMITS
    period: PositiveTime = _PERIOD
    start: Time = _START
    hold: Hold = _HOLD

    @model_validator(mode="wrap")
    @classmethod
    def _own_strain(cls, value: Any, inner: ValidatorFunctionWrapHandler) -> Positional:
        return read_within("strain", value, inner)  # type: ignore[no-any-return]


class IdealGains(Spec):
    """Gains of u = feed_forward r + p (setpoint_weight r - y) + I, dI/dt = i (r - y), at every instant."""

    p: _Gain = Field(description="Of the error.")
    i: Annotated[float, Quantity("frequency", ge=0)] = Field(default=0.0, description="Of its sum over time.")
    setpoint_weight: _Share = Field(default=1.0, description="Share of the target in the error of `p`.")


class Ideal(Spec):
    """A PI controller inside the balance of forces: as if joints were that much stiffer, about the target."""

    type: Literal["pi"] = Field(description="Kind of controller.")
    strain: Strain | None = _STRAIN
    feedback: Literal["ideal"] = Field(description="How the loop is closed.")
    target: Target = _TARGET
    feed_forward: _Gain = Field(default=1.0, description="Share of the target that is commanded at once.")
    gains: IdealGains = Field(description="Gains.")

    @model_validator(mode="wrap")
    @classmethod
    def _own_strain(cls, value: Any, inner: ValidatorFunctionWrapHandler) -> Ideal:
        return read_within("strain", value, inner)  # type: ignore[no-any-return]


class IncrementalGains(Spec):
    """Gains of u += p e + i I once per period, with e = r - y and dI/dt = e: p acts as an integrator."""

    p: _Gain = Field(description="Of the error, once per period.")
    i: Annotated[float, Quantity("frequency", ge=0)] = Field(
        default=0.0, description="Of its sum over time, once per period."
    )


class Incremental(Spec):
    """The law of other codes, for comparison with their data: gains act on the command once per period."""

    type: Literal["incremental"] = Field(description="Kind of controller.")
    strain: Strain | None = _STRAIN
    sensor: Name | None = _SENSOR
    target: Target = _TARGET
    gains: IncrementalGains = Field(description="Gains.")
    leak: Annotated[float, Quantity("ratio", ge=0, le=0.5)] = Field(
        default=0.0,
        description="Share of the difference to each neighbour that a command loses at every sample.",
    )
    limits: ControlLimits = _LIMITS
    period: PositiveTime = _PERIOD
    start: Time = _START
    hold: Hold = _HOLD

    @model_validator(mode="wrap")
    @classmethod
    def _own_strain(cls, value: Any, inner: ValidatorFunctionWrapHandler) -> Incremental:
        return read_within("strain", value, inner)  # type: ignore[no-any-return]


def _class_name(value: str) -> str:
    file, _, name = value.partition(":")
    if not (file.isidentifier() and name.isidentifier()):
        raise problem(f"expected FILE:CLASS, the file without its .py, such as my:Follow; got {value!r}")
    return value


class Plugin(Spec):
    """A controller written in Python; the file is named on the command line alone, with `--plugin`."""

    type: Literal["plugin"] = Field(description="Kind of controller.")
    strain: Strain | None = _STRAIN
    name: Annotated[str, AfterValidator(_class_name)] = Field(
        max_length=200, description="`FILE:CLASS`, the file without its `.py`."
    )
    sensors: Annotated[tuple[Name, ...], Len(0, 1000), Strict(False)] = Field(
        default=(), description="What it reads, one after the other; it gets nothing else."
    )
    target: Target | None = Field(default=None, description="What it is told to reach, if anything.")
    settings: Mapping[str, Any] = Field(default={}, description="Keyword arguments of the class.")
    limits: ControlLimits = _LIMITS
    period: PositiveTime = _PERIOD
    start: Time = _START
    hold: Hold = _HOLD

    @model_validator(mode="wrap")
    @classmethod
    def _own_strain(cls, value: Any, inner: ValidatorFunctionWrapHandler) -> Plugin:
        return read_within("strain", value, inner)  # type: ignore[no-any-return]


Sampled: TypeAlias = Positional | Incremental | Plugin


def _with_feedback(value: Any) -> Any:
    """Sampled unless it says otherwise: told apart before anything has defaults."""
    if isinstance(value, Mapping) and value.get("type") == "pi" and "feedback" not in value:
        return {**value, "feedback": "sampled"}
    return value


Controller: TypeAlias = Annotated[
    Annotated[Positional | Ideal, Field(discriminator="feedback")] | Incremental | Plugin,
    Field(discriminator="type"),
    BeforeValidator(_with_feedback),
]
