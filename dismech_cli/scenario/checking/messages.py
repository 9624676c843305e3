"""What pydantic found wrong, in plain words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from pydantic_core import ErrorDetails

from ...words import did_you_mean, hint, listed
from ..text.tree import KeyPath, describe
from .known_keys import kinds_with_key, known_keys, meaning, places_with_key

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


def is_wrong_type(detail: ErrorDetails) -> bool:
    """Whether a value is not even of the kind that is expected."""
    return detail["type"] in _EXPECTED


def message(detail: ErrorDetails, data: Any, path: KeyPath) -> str:
    """What is wrong with the value at a key path.

    Args:
        detail: Of pydantic.
        data: The whole scenario as written.
        path: Key path of the fault.
    """
    kind, given, context = detail["type"], detail["input"], detail.get("ctx", {})
    if kind == "scenario":
        return str(context["message"])
    if kind == "missing":
        return f"missing key{_meaning(data, path)}"
    if kind == "extra_forbidden":
        return _unknown_key(data, path[:-1], str(path[-1]))
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
        expected = f"{_EXPECTED[kind]}{_with_keys(kind, data, path)}"
        return f"expected {expected}, got {describe(given)}{_meaning(data, path)}"
    if kind in ("too_short", "too_long"):
        return _length(context, kind)
    if kind in _BOUNDS:
        words, key = _BOUNDS[kind]
        return f"must be {words} {context[key]}, got {describe(given)}"
    if kind == "string_pattern_mismatch":
        return _name(str(given))
    if kind == "string_too_short":
        return "must not be empty"
    if kind == "string_too_long":
        return (
            f"not a usable name: too long, at most {context['max_length']} characters, got {len(str(given))}"
        )
    return str(detail["msg"])


def _unknown_key(data: Any, path: KeyPath, key: str) -> str:
    """Where a key belongs that is not known in the mapping at ``path``, or what is known there."""
    if kinds := kinds_with_key(data, path, key):
        return f"unknown key here: it is one of {listed(kinds)}"
    known = known_keys(data, path)
    if near := hint(key, known):
        return f"unknown key{near}"
    places = places_with_key(data, path, key)
    elsewhere = f" here, a key {_within(places[0])}" if places else ""
    return f"unknown key{elsewhere}; known: {listed(known, 'and')}"


def _within(path: KeyPath) -> str:
    return f"of {'.'.join(map(str, path))!r}" if path else "of the scenario itself"


def _meaning(data: Any, path: KeyPath) -> str:
    """What the key is for, in brackets; nothing where the key itself says as much."""
    text = meaning(data, path).rstrip(".")
    if len(text.split()) <= len(str(path[-1]).split("_")):
        return ""
    return f" ({text[0].lower()}{text[1:]})"


def _with_keys(kind: str, data: Any, path: KeyPath) -> str:
    """What the mapping that is expected at ``path`` may have."""
    known = known_keys(data, path) if kind.startswith("model") else []
    return f" with {listed(known, 'and')}" if known else ""


def _name(given: str) -> str:
    """Why a text is no name: names become folders and columns, which every system and tool must take."""
    strange = next((c for c in given if not (c.isascii() and (c.isalnum() or c in "_-."))), None)
    culprit = "" if strange is None else f"{strange!r} is none of them: "
    allowed = "the letters a to z and A to Z, digits, '_' and '-'"
    return f"not a usable name: {describe(given)}; {culprit}use {allowed}"


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
