"""The JSON Schema for editors: as strict as JSON Schema can be, and open to files that are parts of others.

The schema of the language says that a quantity is a number or text and that a scenario has all its keys.
For editors, text is checked for its unit and sign, each law for the unit of its own field, and a file that
includes others, or has no name and so is there to be included, may leave keys out of its mappings; lists
replace those of included files and are whole.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from ..values.law_of import OF_FIELD
from .reference import json_schema
from .unit_text import NOT_NEGATIVE, POSITIVE, quantity_text

TITLE: Final = "dismech scenario"
"""By it the program knows a schema that it wrote."""
_WHOLE: Final = "Scenario"
_PART: Final = "Part."
_REF: Final = "#/$defs/"

Node = dict[str, Any]


def editor_schema() -> Node:
    """JSON Schema (2020-12) of a scenario file, whole or a part."""
    language = json_schema()
    definitions: Node = language.pop("$defs")
    head = {"$schema": language.pop("$schema")}
    definitions[_WHOLE] = language
    made = _Definitions(definitions)
    whole = made.told(language, None)
    part = {key: value for key, value in made.part(whole).items() if key != "title"}
    part["required"] = ["schema_version"]
    named_alone = {"required": ["name"], "not": {"required": ["include"]}}
    made.done[_WHOLE] = whole
    return {
        **head,
        "title": TITLE,
        **part,
        "if": named_alone,
        "then": {"$ref": f"{_REF}{_WHOLE}"},
        "$defs": made.used(part),
    }


class _Definitions:
    """Definitions of the schema as they are needed: of each law one per quantity, of each mapping a part."""

    def __init__(self, definitions: Node) -> None:
        self._definitions = definitions
        self.done: Node = {}

    def told(self, node: Node, quantity: str | None) -> Node:
        """A schema with its quantities told.

        Args:
            node: The schema.
            quantity: That of the law that it is in.
        """
        own = node.get("x-quantity")
        if OF_FIELD in node or (own is not None and "oneOf" not in node):
            number = next(part for part in node["anyOf"] if part.get("type") == "number")
            kept = {key: node[key] for key in node if key not in ("anyOf", OF_FIELD)}
            return self._text(own or quantity or "ratio", number, kept)
        if node.get("type") == "integer" or (node.get("type") == "string" and "pattern" in node):
            told_apart = ("description", "default")
            kept = {key: node[key] for key in told_apart if key in node}
            plain = {key: value for key, value in node.items() if key not in told_apart}
            return {"anyOf": [plain, self._formula()], **kept}
        law = own or quantity
        if "$ref" in node:
            return node | {"$ref": _REF + self._named(node["$ref"].rpartition("/")[2], law)}
        told: Node = _below(node, lambda part: self.told(part, law))
        if "patternProperties" in told:
            # names of repeated entries
            (named,) = told["patternProperties"].values()
            told["patternProperties"] |= {r"\$": named}
        return told

    def _named(self, name: str, law: str | None) -> str:
        """Name of a definition for a law, made if it is new."""
        full = name if law is None or not self._of_law(name) else f"{name}.{law.replace(' ', '_')}"
        if full not in self.done:
            self.done[full] = {}
            self.done[full] = self.told(self._definitions[name], law if full != name else None)
        return full

    def _of_law(self, name: str) -> bool:
        """Whether a definition has values of the field of its law."""
        return OF_FIELD in str(self._definitions[name]) or any(
            self._of_law(part) for part in _references(self._definitions[name])
        )

    def _text(self, quantity: str, number: Node, kept: Node) -> Node:
        """A number, or text with a unit; the signs of both are told."""
        name = f"text.{quantity.replace(' ', '_')}"
        self.done.setdefault(name, {"type": "string", "pattern": quantity_text(quantity)})
        text: Node = {"$ref": _REF + name}
        if number.get("exclusiveMinimum") == 0:
            text = {"allOf": [text, {"pattern": POSITIVE}]}
        elif number.get("minimum") == 0:
            text = {"allOf": [text, {"pattern": NOT_NEGATIVE}]}
        return {"anyOf": [number, text, self._formula()], **kept}

    def _formula(self) -> Node:
        """A text that is computed from parameters."""
        self.done.setdefault("text.formula", {"type": "string", "pattern": r"\$"})
        return {"$ref": f"{_REF}text.formula"}

    def part(self, node: Node) -> Node:
        """A schema of mappings that may lack keys; lists in it are whole."""
        if "$ref" in node:
            name = node["$ref"].rpartition("/")[2]
            if self.done[name].get("type") != "object":
                return node
            if _PART + name not in self.done:
                self.done[_PART + name] = {}
                self.done[_PART + name] = self.part(self.done[name])
            return node | {"$ref": f"{_REF}{_PART}{name}"}
        if node.get("type") == "array":
            return node
        left_out = ("required", "allOf", "discriminator", "oneOf")
        out = {key: value for key, value in node.items() if key not in left_out}
        alternatives = [*node.get("oneOf", []), *node.get("anyOf", [])]
        if alternatives:
            out["anyOf"] = [self.part(one) for one in alternatives]
        for key in ("properties", "patternProperties"):
            if key in node:
                out[key] = {name: self.part(one) for name, one in node[key].items()}
        if isinstance(node.get("additionalProperties"), dict):
            out["additionalProperties"] = self.part(node["additionalProperties"])
        return out

    def used(self, root: Node) -> Node:
        """The definitions that a schema leads to."""
        found: set[str] = set()
        todo = [_WHOLE, *_references(root)]
        while todo:
            name = todo.pop()
            if name not in found:
                found.add(name)
                todo += _references(self.done[name])
        return {name: self.done[name] for name in sorted(found)}


def _below(node: Any, change: Callable[[Node], Node]) -> Any:
    """A schema with everything in it changed."""
    kept = ("default", "discriminator", "required", "enum", "const")
    if isinstance(node, list):
        return [change(one) if isinstance(one, dict) else one for one in node]
    return {
        key: value
        if key in kept
        else {name: change(one) for name, one in value.items()}
        if key in ("properties", "patternProperties")
        else change(value)
        if isinstance(value, dict)
        else _below(value, change)
        if isinstance(value, list)
        else value
        for key, value in node.items()
    }


def _references(node: Any) -> list[str]:
    """Names of the definitions that a schema refers to."""
    if isinstance(node, list):
        return [name for one in node for name in _references(one)]
    if not isinstance(node, dict):
        return []
    own = [node["$ref"].rpartition("/")[2]] if isinstance(node.get("$ref"), str) else []
    return own + [name for key, one in node.items() if key != "discriminator" for name in _references(one)]
