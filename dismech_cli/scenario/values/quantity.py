"""Field types of the schema: numbers with a dimension, vectors, names and files."""

from __future__ import annotations

from typing import Annotated, Any, Final, TypeAlias

from annotated_types import Len
from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, Strict
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from ...frozen import frozen
from ...quantities import QuantityError, parse_quantity
from ...units import KINDS, Kind
from ..text.tree import describe
from .spec import problem

LARGEST: Final = 1e30
"""Largest number of the language in SI units: the fourth power of a length, times a modulus, is finite."""

SMALLEST: Final = 1e-40
"""Smallest number, where it must be above zero: the fourth power of a length is above zero too."""


@frozen
class Quantity:
    """Marks a float field as a physical quantity: a bare number is SI, text carries a unit.

    Attributes:
        name: Key of :data:`.units.KINDS`.
        gt: The SI value must be greater.
        ge: The SI value must be at least this.
        lt: The SI value must be less.
        le: The SI value must be at most this.
    """

    name: str
    gt: float | None = None
    ge: float | None = None
    lt: float | None = None
    le: float | None = None

    @property
    def kind(self) -> Kind:
        """Phrase, unit and dimension."""
        return KINDS[self.name]

    def read(self, value: object) -> float:
        """The SI value of a number or a text.

        Raises:
            PydanticCustomError: if it is neither, of another dimension or out of bounds.
        """
        number = to_si(value, self.kind)
        for broken, words, bound in (
            (self.gt is not None and number <= self.gt, "greater than", self.gt),
            (self.ge is not None and number < self.ge, "at least", self.ge),
            (self.lt is not None and number >= self.lt, "less than", self.lt),
            (self.le is not None and number > self.le, "at most", self.le),
        ):
            if broken:
                raise problem(f"must be {words} {bound:g}, got {describe(value).strip(chr(39))}")
        if self.gt == 0 and number < SMALLEST:
            shown = describe(value).strip(chr(39))
            raise problem(f"too small to compute with: {shown}; at least {SMALLEST:g} in SI units")
        return number

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self.read, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        bounds = {
            "exclusiveMinimum": self.gt,
            "minimum": self.ge,
            "exclusiveMaximum": self.lt,
            "maximum": self.le,
        }
        number = {"type": "number"} | {key: bound for key, bound in bounds.items() if bound is not None}
        return {"anyOf": [number, {"type": "string"}], "x-unit": self.kind.unit, "x-quantity": self.name}


def to_si(value: object, kind: Kind) -> float:
    """The SI value of a number or of a text with a unit.

    Raises:
        PydanticCustomError: if it is neither or of another dimension.
    """
    match value:
        case bool():
            pass
        case int() | float():
            return _computable(float(value), value)
        case str():
            try:
                return _computable(parse_quantity(value, kind), value)
            except QuantityError as error:
                raise problem(str(error)) from None
        case _:
            pass
    raise problem(f"expected {kind.phrase}, got {describe(value)}")


def _computable(number: float, value: object) -> float:
    """The number, refused where its powers would leave the range of floating-point numbers."""
    if abs(number) > LARGEST:
        shown = describe(value).strip(chr(39))
        raise problem(f"too large to compute with: {shown}; at most {LARGEST:g} in SI units")
    return number


Ratio: TypeAlias = Annotated[float, Quantity("ratio")]
Length: TypeAlias = Annotated[float, Quantity("length")]
PositiveLength: TypeAlias = Annotated[float, Quantity("length", gt=0)]
Time: TypeAlias = Annotated[float, Quantity("time", ge=0)]
PositiveTime: TypeAlias = Annotated[float, Quantity("time", gt=0)]
Angle: TypeAlias = Annotated[float, Quantity("angle")]
Frequency: TypeAlias = Annotated[float, Quantity("frequency", gt=0)]

# Variable-length tuples with a length rule: editors understand their JSON Schema.
Triple: TypeAlias = Annotated[tuple[Ratio, ...], Len(3, 3), Strict(False)]
# Farther out, rounding leaves nothing of a robot's shape; that of meshes is the same.
Coordinate: TypeAlias = Annotated[float, Quantity("length", ge=-1e12, le=1e12)]
LengthTriple: TypeAlias = Annotated[tuple[Coordinate, ...], Len(3, 3), Strict(False)]
VelocityTriple: TypeAlias = Annotated[
    tuple[Annotated[float, Quantity("velocity")], ...], Len(3, 3), Strict(False)
]


@frozen
class Direction:
    """Marks a triple that must not be zero."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_after_validator_function(_nonzero, handler(source))


def _nonzero(value: tuple[float, ...]) -> tuple[float, ...]:
    if not any(value):
        raise problem("a direction must not be zero")
    return value


DirectionTriple: TypeAlias = Annotated[Triple, Direction()]


@frozen
class FileReference:
    """Marks a text field as the name of a file, relative to the folder of the scenario.

    Attributes:
        folder: Whether it may be a folder.
    """

    folder: bool = False


FileName: TypeAlias = Annotated[str, FileReference(), Field(min_length=1, max_length=1000)]
Name: TypeAlias = Annotated[str, Field(max_length=64, pattern=r"^[A-Za-z_][A-Za-z0-9_-]*$")]
TwoNames: TypeAlias = Annotated[tuple[Name, ...], Len(2, 2), Strict(False)]
Index: TypeAlias = Annotated[int, Field(ge=0)]
NodeCount: TypeAlias = Annotated[int, Field(ge=2, le=10_000_000)]
Column: TypeAlias = str | Index
