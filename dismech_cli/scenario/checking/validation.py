"""The tree of a scenario to a :class:`Scenario`, every fault at its place and in plain words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any, Final

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from ...words import did_you_mean, hint, listed
from ..language.scenario import SCHEMA_VERSION, Scenario
from ..text.problems import Problem, ProblemsError
from ..text.tree import KeyPath, Mark, Node, describe

_TAG_KEYS: Final = ("type", "shape")
_BOUNDS: Final = {
    "greater_than": ("greater than", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("less than", "lt"),
    "less_than_equal": ("at most", "le"),
}
_EXPECTED: Final = {
    "float_type": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "bool_type": "true or false",
    "string_type": "text",
    "model_type": "a mapping",
    "model_attributes_type": "a mapping",
    "dict_type": "a mapping",
    "tuple_type": "a list",
    "list_type": "a list",
    "finite_number": "a finite number",
}


def validate(root: Node) -> Scenario:
    """The scenario of a merged tree.

    Raises:
        ProblemsError: with every fault of the schema.
    """
    check_version(root)
    data = root.plain()
    try:
        return Scenario.model_validate(data)
    except ValidationError as error:
        details = error.errors(include_url=False)
    faults = [(*_locate(root, detail["loc"]), detail) for detail in details]
    misspelt = {
        (path[:-1], near)
        for path, _, detail in faults
        if detail["type"] == "extra_forbidden"
        and (near := did_you_mean(str(path[-1]), _keys(data, path[:-1])))
    }
    raise ProblemsError(
        [
            Problem(_mark(node, detail), path, _message(detail, data, path))
            for path, node, detail in faults
            # A misspelt key is one fault, not an unknown and a missing one.
            if not (detail["type"] == "missing" and (path[:-1], path[-1]) in misspelt) and not _echo(detail)
        ]
    )


def check_version(root: Node) -> None:
    """Refuse a scenario of another schema version before anything else is said about it.

    Raises:
        ProblemsError: saying whether the file or the program is too old.
    """
    node = root.child("schema_version")
    if node is None or isinstance(node.value, bool) or not isinstance(node.value, int):
        return
    if node.value > SCHEMA_VERSION:
        advice = "newer than this program, which reads"
    elif node.value < SCHEMA_VERSION:
        advice = "no longer read: this program reads"
    else:
        return
    message = f"schema version {node.value} is {advice} version {SCHEMA_VERSION}"
    raise ProblemsError([Problem(node.mark, ("schema_version",), message)])


def place(root: Node, path: KeyPath) -> tuple[KeyPath, Node]:
    """The node nearest to a key path, and the path as the text has it.

    Text may be short for a mapping, as ``beam.start`` is for ``{group: beam.start}``: then the
    path ends at the text. The path of a key that is not there stays whole.
    """
    node = root
    for i, part in enumerate(path):
        child = node.child(part)
        if child is None:
            return (path, node) if isinstance(node.value, Mapping | tuple) else (path[:i], node)
        node = child
    return path, node


def point(node: Node) -> Mark:
    """Where a message about ``node`` points: a scalar itself, else the key of the collection."""
    return node.place if isinstance(node.value, Mapping | tuple) else node.mark


def _locate(root: Node, loc: tuple[str | int, ...]) -> tuple[KeyPath, Node]:
    """The key path of a pydantic location without the tags of unions, and the nearest node."""
    node, tagged = root, False
    path: KeyPath = ()
    for i, part in enumerate(loc):
        if part == "[key]" or (isinstance(part, str) and part.startswith("<")):
            continue
        if isinstance(part, str) and not tagged and any(_is(node, key, part) for key in _TAG_KEYS):
            tagged = True
            continue
        child = node.child(part)
        if child is not None:
            node, path, tagged = child, (*path, part), False
        elif i == len(loc) - 1:
            return (*path, part), node
    return path, node


def _mark(node: Node, detail: ErrorDetails) -> Mark:
    if detail["type"] in ("missing", "extra_forbidden") or detail["loc"][-1] == "[key]":
        return node.place
    if detail["type"] == "union_tag_invalid":
        tag = node.child(str(detail["ctx"]["discriminator"]).strip("'"))
        return tag.mark if tag else point(node)
    return point(node)


def _echo(detail: ErrorDetails) -> bool:
    """True for a list that pydantic calls too short only because its items are wrong."""
    if detail["type"] != "too_short" or not isinstance(detail["input"], tuple):
        return False
    return len(detail["input"]) >= int(detail["ctx"]["min_length"])


def _is(node: Node, key: str, tag: str) -> bool:
    child = node.child(key)
    return child is not None and child.value == tag


def _message(detail: ErrorDetails, data: Any, path: KeyPath) -> str:
    kind, given, context = detail["type"], detail["input"], detail.get("ctx", {})
    if kind == "scenario":
        return str(context["message"])
    if kind == "missing":
        return "missing key"
    if kind == "extra_forbidden":
        known = _keys(data, path[:-1])
        return f"unknown key{hint(str(path[-1]), known) or '; known: ' + listed(known, 'and')}"
    if kind == "literal_error":
        return f"expected {context['expected']}, got {describe(given)}{_hint(given, context['expected'])}"
    if kind == "union_tag_invalid":
        tag = str(context["tag"])
        return f"expected {context['expected_tags']}, got {tag!r}{_hint(tag, context['expected_tags'])}"
    if kind == "union_tag_not_found":
        if not isinstance(given, Mapping):
            return f"expected a mapping, got {describe(given)}"
        return f"missing key {str(context['discriminator']).strip(chr(39))!r}"
    if kind == "one_key":
        return _one_key(given, detail["msg"].split())
    if kind in _EXPECTED:
        return f"expected {_EXPECTED[kind]}, got {describe(given)}"
    if kind in ("too_short", "too_long"):
        return _length(context, kind)
    if kind in _BOUNDS:
        words, key = _BOUNDS[kind]
        return f"must be {words} {context[key]}, got {describe(given)}"
    if kind == "string_pattern_mismatch":
        return f"not a usable name: {describe(given)}; use letters, digits, '_' and '-'"
    if kind in ("string_too_short", "string_too_long"):
        return "must not be empty" if kind == "string_too_short" else "text too long"
    return str(detail["msg"])


def _length(context: Mapping[str, Any], kind: str) -> str:
    low, actual = context.get("min_length"), context.get("actual_length")
    bound = f"at least {low}" if kind == "too_short" else f"at most {context.get('max_length')}"
    return f"expected {bound} items, got {actual if actual is not None else 'more'}"


def _one_key(given: Any, keys: list[str]) -> str:
    names = ", ".join(keys)
    if not isinstance(given, Mapping):
        return f"expected a mapping with one of {names}; got {describe(given)}"
    present = [key for key in keys if key in given]
    if len(present) > 1:
        return f"expected only one of {' and '.join(map(repr, present))}"
    near = next((hint(str(key), keys) for key in given if did_you_mean(str(key), keys)), "")
    return f"expected one of {names}; got {', '.join(map(str, given)) or 'nothing'}{near}"


def _hint(given: object, expected: str) -> str:
    choices = [choice.strip(" '") for choice in expected.replace(" or ", ",").split(",")]
    return hint(given, choices) if isinstance(given, str) else ""


@cache
def _schema() -> dict[str, Any]:
    return Scenario.model_json_schema(by_alias=True)


def _keys(data: Any, path: KeyPath) -> list[str]:
    """Keys that the schema knows in the mapping at ``path`` of ``data``."""
    schemas = [_schema()]
    for part in path:
        schemas = [below for schema in _variants(schemas, data) for below in _below(schema, part)]
        data = data[part]
    return sorted({key for schema in _variants(schemas, data) for key in schema.get("properties", {})})


def _variants(schemas: list[dict[str, Any]], data: Any) -> Iterator[dict[str, Any]]:
    """References and unions opened; members of another ``type`` than that of ``data`` left out."""
    for schema in schemas:
        if "$ref" in schema:
            yield from _variants([_schema()["$defs"][schema["$ref"].rpartition("/")[2]]], data)
            continue
        for key in ("oneOf", "anyOf"):
            yield from _variants(schema.get(key, []), data)
        if all(_fits(schema.get("properties", {}).get(key), data, key) for key in _TAG_KEYS):
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
