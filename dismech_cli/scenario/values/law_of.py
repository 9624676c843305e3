"""What a law of the scenario is a law of: the quantity of its values, which its numbers are read as."""

from __future__ import annotations

from contextvars import ContextVar
from typing import Annotated, Any, Final, TypeAlias

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from ...frozen import frozen
from ...units import KINDS
from ..text.tree import describe
from .quantity import Quantity, to_si
from .spec import problem
from .strain import kind_here


@frozen
class LawOf:
    """Marks a field as a law whose values are a physical quantity.

    Attributes:
        name: Key of :data:`.units.KINDS`.
        variables: Those that an expression may use: ``t``, ``s`` along a rod, places on shells; without
            ``t`` the value varies over a body, not in time.
    """

    name: str
    variables: tuple[str, ...] = ("t",)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_wrap_validator_function(self._validate, handler(source))

    def _validate(self, value: Any, inner: core_schema.ValidatorFunctionWrapHandler) -> Any:
        token = _FIELD.set(self)
        try:
            return inner(value)
        finally:
            _FIELD.reset(token)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return handler(schema["schema"]) | {
            "x-unit": KINDS[self.name].unit,
            "x-quantity": self.name,
            "x-law": "t" in self.variables,
        }


OF_FIELD: Final = "x-of-field"
"""Marks a value in the JSON Schema of a law whose quantity is that of the law's field."""

# The law models are shared by all quantities; the field being validated says which one is meant.
_FIELD: ContextVar[LawOf] = ContextVar("law field")
_PLAIN = LawOf("ratio")


@frozen
class _FieldQuantity:
    """Marks a number as a value of the law's field."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(_read, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return {"anyOf": [{"type": "number"}, {"type": "string"}], OF_FIELD: True}


def variables_here() -> tuple[str, ...]:
    """Variables that an expression in the field being validated may use."""
    return _FIELD.get(_PLAIN).variables


def _read(value: object) -> float:
    return to_si(value, kind_here(_FIELD.get(_PLAIN).name))


FieldValue: TypeAlias = Annotated[float, _FieldQuantity()]


@frozen
class _PositiveFieldQuantity(_FieldQuantity):
    """Marks a number above zero as a value of the law's field."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(_read_positive, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return {"anyOf": [{"type": "number", "exclusiveMinimum": 0}, {"type": "string"}], OF_FIELD: True}


def _read_positive(value: object) -> float:
    return Quantity(_FIELD.get(_PLAIN).name, gt=0).read(value)


PositiveFieldValue: TypeAlias = Annotated[float, _PositiveFieldQuantity()]


@frozen
class Pair:
    """Marks a pair as a time or a place and a value of the law's field.

    Attributes:
        first: Quantity of the first.
        or_else: What else the first may be, where another key says so; read before as a plain number.
    """

    first: str
    or_else: tuple[str, ...] = ()

    def read(self, pair: object) -> tuple[float, float]:
        """Both in SI units.

        Raises:
            PydanticCustomError: It is no pair of them.
        """
        kind = KINDS[self.first]
        if not isinstance(pair, tuple | list) or len(pair) != 2:
            raise problem(f"expected {kind.phrase} and a value, got {describe(pair)}")
        return to_si(pair[0], kind), self.value(pair[1])

    def value(self, value: object) -> float:
        """The second in SI units."""
        return _read(value)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self.read, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        text: dict[str, Any] = {"anyOf": [{"type": "number"}, {"type": "string"}]}
        firsts = [
            text | {"x-unit": KINDS[name].unit, "x-quantity": name} for name in (self.first, *self.or_else)
        ]
        items = {"anyOf": [*firsts, text | {OF_FIELD: True}]}
        return {"type": "array", "items": items, "minItems": 2, "maxItems": 2}


@frozen
class PositivePair(Pair):
    """Marks a pair whose value must be above zero."""

    def value(self, value: object) -> float:
        """The second in SI units."""
        return _read_positive(value)


Row: TypeAlias = Annotated[tuple[float, ...], Pair("time")]
PlaceRow: TypeAlias = Annotated[tuple[float, ...], PositivePair("length", ("ratio",))]
