"""JSON Schema of what is taken out of a scenario before it is validated: parameters and ``repeat``."""

from __future__ import annotations

from typing import Any

from ..text import parameters, repeat

_REF = "#/$defs/"


def with_expanded(schema: dict[str, Any]) -> dict[str, Any]:
    """The schema of the language with the keys that the loader writes out, changed in place."""
    definitions, properties = schema["$defs"], schema["properties"]
    definitions["Parameter"] = _mapping(
        "A number that values are computed from.", parameters.SCHEMA, required=[]
    )
    definitions["Repeat"] = _mapping(
        "Copies of an entry; a whole number is short for `count`.", repeat.SCHEMA, required=["count"]
    )
    turn = _mapping(
        "Copies around an axis; exactly one of `angle` and `full`.", repeat.ROTATE_SCHEMA, required=["axis"]
    )
    definitions["RepeatTurn"] = turn | {"oneOf": [{"required": ["angle"]}, {"required": ["full"]}]}
    # files that include others, profiles and arguments lay bare values over declarations
    value: dict[str, Any] = {"anyOf": [{"type": ["number", "string"]}, {"$ref": f"{_REF}Parameter"}]}
    properties["parameters"] = properties["parameters"] | {"additionalProperties": value}
    places = [properties[key] for key in repeat.LISTS]
    places += [definitions["Output"]["properties"]["probes"], properties["expect"]]
    for name in dict.fromkeys(name for place in places for name in _entries(place)):
        definition = definitions[name]
        definition["properties"] = {**definition["properties"], "repeat": _repeat()}
    return schema


def _repeat() -> dict[str, Any]:
    number = {"type": "integer", "minimum": 1, "maximum": repeat.MAX_COPIES}
    return {"anyOf": [number, {"$ref": f"{_REF}Repeat"}], "description": "Copies of this entry."}


def _mapping(text: str, keys: Any, required: list[str]) -> dict[str, Any]:
    properties = {key: dict(schema) for key, schema in keys.items()}
    return {
        "type": "object",
        "description": text,
        "properties": properties,
        "required": required,
        "additionalProperties": False,
    }


def _entries(node: Any) -> list[str]:
    """Names of the mappings that may be items of a list or values of a mapping."""
    if isinstance(node, list):
        return [name for one in node for name in _entries(one)]
    if not isinstance(node, dict):
        return []
    if isinstance(node.get("$ref"), str):
        return [node["$ref"].rpartition("/")[2]]
    keys = ("items", "oneOf", "anyOf", "additionalProperties")
    found = [name for key in keys if key in node for name in _entries(node[key])]
    return found + _entries(list(node.get("patternProperties", {}).values()))
