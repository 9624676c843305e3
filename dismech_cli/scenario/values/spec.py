"""The base of every schema class, and unions told apart by the key that is present."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Self, cast

from pydantic import BaseModel, ConfigDict, Discriminator
from pydantic_core import PydanticCustomError


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
        # most classes are only parts of the scenario: compiled with it, not each by itself
        defer_build=True,
    )

    @classmethod
    def unsaid(cls, **known: Any) -> Self:
        """What it is if nothing is said: no class has to be compiled by itself for that.

        Args:
            **known: Values that are right, such as the word that tells it from others.
        """
        return cast("Self", cls.model_construct(**known))


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
