"""Which member of a union a key takes by default, so that ``--set`` can change a value inside it."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

from pydantic import BaseModel

from ..language.scenario import Scenario
from ..text.tree import KeyPath
from .known_keys import TAG_KEYS


@cache
def default_kinds() -> dict[KeyPath, dict[str, str]]:
    """Tag key and tag of the default at each key path that has one of several kinds."""
    return dict(_below(Scenario, ()))


def _below(spec: type[BaseModel], path: KeyPath) -> Iterator[tuple[KeyPath, dict[str, str]]]:
    for name, field in spec.model_fields.items():
        here = (*path, field.alias or name)
        match field.default, field.annotation:
            case BaseModel() as default, _:
                present = [key for key in TAG_KEYS if key in default.model_fields_set]
                tags = {str(key): str(getattr(default, key)) for key in present}
                if tags:
                    yield here, tags
                yield from _below(type(default), here)
            case _, type() as inner if issubclass(inner, BaseModel):
                yield from _below(inner, here)
            case _:
                pass
