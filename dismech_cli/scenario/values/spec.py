"""The base of every schema class, and unions told apart by the key that is present."""

from __future__ import annotations

from collections.abc import Mapping
from contextvars import ContextVar
from typing import Any, Final, Literal, Self, cast, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Discriminator, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

_compiled: ContextVar[type[Spec] | None] = ContextVar("_compiled", default=None)

# Marks what stands for a class that is compiled when a scenario has one.
_WHEN_MET: Final = "dismech_when_met"


class Spec(BaseModel):
    """A mapping of the scenario: frozen, no unknown keys, no silent conversions, finite numbers."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        strict=True,
        allow_inf_nan=False,
        validate_by_alias=True,
        validate_by_name=False,
        serialize_by_alias=True,
        # a scene has few of the parts of the language: each is compiled when one is met
        defer_build=True,
    )

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Of the class, while it is compiled; as a part of another, something that compiles it once met."""
        if _compiled.get() is cls:
            return handler(source)
        # by these words unions choose
        words = {
            name: core_schema.typed_dict_field(core_schema.literal_schema(list(get_args(one.annotation))))
            for name, one in cls.model_fields.items()
            if get_origin(one.annotation) is Literal
        }
        return core_schema.no_info_wrap_validator_function(
            lambda value, _: cls.model_validate(value),
            core_schema.typed_dict_schema(words),
            ref=f"{cls.__module__}.{cls.__qualname__}:{id(cls)}",
            serialization=core_schema.wrap_serializer_function_ser_schema(
                _written, schema=core_schema.any_schema()
            ),
            metadata={_WHEN_MET: True},
        )

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Of the class, as a part of another too."""
        if _WHEN_MET not in schema.get("metadata", {}):
            return handler(schema)
        cls.model_rebuild()
        return handler(cls.__pydantic_core_schema__)

    @classmethod
    def model_rebuild(cls, **how: Any) -> bool | None:
        """Compile the class, unless it is; the parts that it has are left for later."""
        before = _compiled.set(cls)
        try:
            return super().model_rebuild(**how)
        finally:
            _compiled.reset(before)

    @classmethod
    def unsaid(cls, **known: Any) -> Self:
        """What it is if nothing is said: no class has to be compiled by itself for that.

        Args:
            **known: Values that are right, such as the word that tells it from others.
        """
        return cast("Self", cls.model_construct(**known))


def _written(value: Any, write: core_schema.SerializerFunctionWrapHandler) -> Any:
    """A part of a scenario, even of a class that no scenario has had yet."""
    if isinstance(value, Spec):
        type(value).model_rebuild()
    return write(value)


def tag(key: str) -> str:
    """The tag of a union member that is told by its ``key``; no key can look like it."""
    return f"<{key}>"


def told_by_key(*keys: str, scalar: str | None = None) -> Discriminator:
    """A discriminator for mappings that hold exactly one of ``keys``.

    Args:
        keys: One per member, tagged ``tag(key)``.
        scalar: Tag of the member for anything that is not a mapping, if there is one.
    """

    def choose(value: Any) -> str | None:
        if isinstance(value, BaseModel):
            present = [key for key in keys if key in value.model_fields_set]
        elif isinstance(value, Mapping):
            present = [key for key in keys if key in value]
        else:
            return scalar
        return tag(present[0]) if len(present) == 1 else None

    # The keys travel in the message: a discriminator must be hashable, so it takes no context.
    return Discriminator(choose, custom_error_type="one_key", custom_error_message=" ".join(keys))


def problem(message: str) -> PydanticCustomError:
    """A validation error with a message of our own, braces and all."""
    return PydanticCustomError("scenario", "{message}", {"message": message})


def exactly_one(spec: BaseModel, *keys: str) -> None:
    """Refuse ``spec`` unless exactly one of the optional ``keys`` is given.

    Raises:
        PydanticCustomError: naming the keys.
    """
    given = [key for key in keys if getattr(spec, key) is not None]
    if len(given) != 1:
        what = "none" if not given else " and ".join(repr(key) for key in given)
        raise problem(f"expected exactly one of {', '.join(map(repr, keys))}; got {what}")


def exclusive(*pairs: tuple[str, ...]) -> ConfigDict:
    """The configuration of a class of whose keys exactly one of each tuple is given, for its JSON Schema."""
    rules: list[Any] = [{"oneOf": [{"required": [key]} for key in keys]} for keys in pairs]
    return ConfigDict(json_schema_extra={"allOf": rules})
