"""The keys that the language knows at a place of a scenario."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any, Final

from ..language.scenario import Scenario
from ..text.tree import KeyPath

TAG_KEYS: Final = ("type", "shape")
"""Keys by which the members of a union are told apart."""


@cache
def _schema() -> dict[str, Any]:
    return Scenario.model_json_schema(by_alias=True)


def known_keys(data: Any, path: KeyPath) -> list[str]:
    """Keys that the schema knows in the mapping at ``path`` of ``data``."""
    schemas, data = _at(data, path)
    return sorted({key for schema in _variants(schemas, data) for key in schema.get("properties", {})})


def meaning(data: Any, path: KeyPath) -> str:
    """What the key at ``path`` of ``data``, there or missing, is for; empty where the schema is silent."""
    schemas, data = _at(data, path[:-1])
    found = (below for schema in _variants(schemas, data) for below in _below(schema, path[-1]))
    return next((schema["description"] for schema in found if "description" in schema), "")


def kinds_with_key(data: Any, path: KeyPath, key: str) -> list[str]:
    """Tags of the kinds, at ``path`` of ``data``, that have a key; none where there are no kinds."""
    schemas, _ = _at(data, path)
    found = [
        schema["properties"] for schema in _variants(schemas, None) if key in schema.get("properties", {})
    ]
    return [
        properties[tag]["const"]
        for properties in found
        for tag in TAG_KEYS
        if "const" in properties.get(tag, {})
    ]


def places_with_key(data: Any, path: KeyPath, key: str) -> list[KeyPath]:
    """Where else a key is known: around ``path``, nearest first; else in sections of the scenario."""
    around = [path[:n] for n in reversed(range(len(path))) if key in known_keys(data, path[:n])]
    sections: list[KeyPath] = [(name,) for name in _schema()["properties"] if name not in path[:1]]
    return around or [section for section in sections if key in known_keys({section[0]: {}}, section)]


def _at(data: Any, path: KeyPath) -> tuple[list[dict[str, Any]], Any]:
    """The schemas and the value at ``path``."""
    schemas = [_schema()]
    for part in path:
        schemas = [below for schema in _variants(schemas, data) for below in _below(schema, part)]
        data = data[part]
    return schemas, data


def _variants(schemas: list[dict[str, Any]], data: Any) -> Iterator[dict[str, Any]]:
    """References and unions opened; members of another ``type`` than that of ``data`` left out."""
    for schema in schemas:
        if "$ref" in schema:
            yield from _variants([_schema()["$defs"][schema["$ref"].rpartition("/")[2]]], data)
            continue
        for key in ("oneOf", "anyOf"):
            yield from _variants(schema.get(key, []), data)
        if all(_fits(schema.get("properties", {}).get(key), data, key) for key in TAG_KEYS):
            yield schema


def _fits(tag: dict[str, Any] | None, data: Any, key: str) -> bool:
    if tag is None or not isinstance(data, Mapping) or key not in data:
        return True
    return bool(data[key] in tag.get("enum", [tag.get("const")]))


def _below(schema: dict[str, Any], part: str | int) -> list[dict[str, Any]]:
    if isinstance(part, int):
        return [schema["items"]] if "items" in schema else []
    if part in schema.get("properties", {}):
        return [schema["properties"][part]]
    named = [*schema.get("patternProperties", {}).values(), schema.get("additionalProperties")]
    return [extra for extra in named if isinstance(extra, dict)]
