"""What `dismech sweep` varies: axes of values by key path, and how they are combined."""

from __future__ import annotations

import math
import re
from typing import Annotated, Any, Final, Literal, Self, TypeAlias

from annotated_types import Len
from pydantic import Discriminator, Field, Strict, Tag, WithJsonSchema, field_validator, model_validator

from ...quantities import QuantityError, read_quantity
from ..text.tree import describe
from ..values.quantity import FileName
from ..values.spec import Spec, problem

MAX_POINTS: Final = 10_000
"""Points of a sweep, at most."""

_AMOUNT: Final = re.compile(r"\s*([-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*", re.DOTALL)
# More would show how a binary fraction is written.
_DIGITS: Final = 12

Scale: TypeAlias = Literal["linear", "log"]
Value: TypeAlias = Any
End: TypeAlias = Annotated[Any, WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}]})]
Values: TypeAlias = Annotated[tuple[Value, ...], Len(1, MAX_POINTS), Strict(False)]


class Between(Spec):
    """The numbers between two: equal steps, or equal factors where `scale` is `log`."""

    from_: End = Field(alias="from", description="One end: a number, or a quantity such as `1 mm`.")
    to: End = Field(description="The other end, in the same unit or another of its kind.")
    scale: Scale = Field(default="linear", description="Whether steps or factors are equal.")

    @field_validator("from_", "to")
    @classmethod
    def _number(cls, value: Any) -> Any:
        amount(value)
        return value

    @model_validator(mode="after")
    def _an_interval(self) -> Self:
        low, high, _ = ends(self)
        if low == high:
            raise problem("'from' and 'to' are the same")
        if self.scale == "log" and low * high <= 0.0:
            raise problem("'scale: log' needs two ends of one sign")
        return self

    def at(self, share: float) -> str:
        """The value at a share of the way, 0 at `from` and 1 at `to`, as a scenario would write it."""
        low, high, unit = ends(self)
        if self.scale == "log":
            value = math.copysign(
                math.exp((1 - share) * math.log(abs(low)) + share * math.log(abs(high))), low
            )
        else:
            value = (1.0 - share) * low + share * high
        return f"{value:.{_DIGITS}g} {unit}".rstrip()


class Span(Between):
    """Values from one end to another, both included."""

    count: Annotated[int, Field(ge=2, le=MAX_POINTS)] = Field(description="How many.")


class Sample(Spec):
    """Points by chance, spread evenly: a Latin hypercube.

    Each value of `over` is drawn once from each of `count` parts of its interval.
    """

    count: Annotated[int, Field(ge=1, le=MAX_POINTS)] = Field(description="How many points.")
    over: Annotated[dict[str, Between], Field(min_length=1)] = Field(description="Interval by key path.")
    seed: Annotated[int, Field(ge=0)] = Field(default=0, description="The same seed gives the same points.")


def _form(value: Any) -> str:
    return "list" if isinstance(value, list | tuple) else "span"


Axis: TypeAlias = Annotated[
    Annotated[Values, Tag("list")] | Annotated[Span, Tag("span")], Discriminator(_form)
]


class Sweep(Spec):
    """Runs of one scenario with other values: every combination of `over`, `zip`, `csv` and `sample`.

    Keys are key paths as `--set` takes them, such as `parameters.E` or `geometry[0].radius`.
    """

    over: dict[str, Axis] = Field(default={}, description="A list of values, or a span, by key path.")
    zip: dict[str, Values] = Field(
        default={},
        description="Lists of one length, gone through side by side: all first values, all second.",
    )
    csv: FileName | None = Field(
        default=None, description="A table whose first line names key paths and whose rows are values."
    )
    sample: Sample | None = Field(default=None, description="A Latin hypercube.")

    @field_validator("zip")
    @classmethod
    def _one_length(cls, lists: dict[str, Values]) -> dict[str, Values]:
        lengths = {len(values) for values in lists.values()}
        if len(lengths) > 1:
            told = ", ".join(f"{key} has {len(values)}" for key, values in lists.items())
            raise problem(f"lists of one length are gone through side by side: {told}")
        return lists

    @model_validator(mode="after")
    def _something(self) -> Self:
        sampled = {} if self.sample is None else self.sample.over
        keys = [*self.over, *self.zip, *sampled]
        if not keys and self.csv is None:
            raise problem("expected at least one of 'over', 'zip', 'csv', 'sample'")
        twice = sorted({key for key in keys if keys.count(key) > 1})
        if twice:
            raise problem(f"varied twice: {', '.join(twice)}")
        return self


def amount(value: object) -> tuple[float, str]:
    """Number and unit of an end, as written.

    Raises:
        PydanticCustomError: It is neither a number nor a quantity.
    """
    match value:
        case bool():
            pass
        case int() | float():
            return float(value), ""
        case str() if found := _AMOUNT.fullmatch(value):
            try:
                read_quantity(value)
            except QuantityError as error:
                raise problem(str(error)) from None
            return float(found[1]), found[2]
        case _:
            pass
    raise problem(f"expected a number or a quantity such as '2 mm', got {describe(value)}")


def ends(interval: Between) -> tuple[float, float, str]:
    """Both ends as numbers in one unit, that of `from`.

    Raises:
        PydanticCustomError: They measure different things.
    """
    (low, unit), (high, other) = amount(interval.from_), amount(interval.to)
    if unit == other:
        return low, high, unit
    if not unit or not other:
        raise problem("'from' and 'to' need a unit both, or neither")
    (factor, one), (second, two) = read_quantity(f"1 {unit}"), read_quantity(f"1 {other}")
    if one != two:
        raise problem(f"'from' and 'to' measure different things: {unit} and {other}")
    return low, high * second / factor, unit
