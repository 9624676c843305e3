"""JSON Schema and Markdown reference of the scenario language, from the schema classes."""

from __future__ import annotations

from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from ...units import KINDS
from ..language.scenario import Scenario
from .expanded import with_expanded

_INTRODUCTION = """\
# Scenario reference

A scenario is one YAML or TOML file. This page lists every key; it is generated from
the schema itself.

- **Quantities**: a bare number is in the SI unit shown; text carries its own unit: `2 MPa`, `5 mm`,
  `1.2 g/cm^3`, `30 deg`, `1 %`, `0.1 N*s/m^2`.
- **Laws**: a value marked *law* may be a number or quantity, or one of the mappings under
  [Laws](#tablelaw): `{table: [[0, 0], [1 s, 5 mm]]}`, `{ramp: {from: 0, to: 5 mm, end: 1 s}}`,
  `{sine: {amplitude: 5 mm, frequency: 2 Hz}}`, `{sawtooth: {...}}`, `{expression: "sin(2*pi*t)"}`.
- **Varying values**: a value marked *may vary* may be a number or quantity, or vary over the body at rest
  by one of the mappings under [Varying values](#byexpression): `{expression: "0.002*(1 - 0.8*s)"}`,
  `{of: s, table: [[0, 2 mm], [1, 0.4 mm]]}`, `{value: 2 mm, groups: {tip: 1 mm}}`.
- **Parameters**: `parameters: {E: 2 MPa, radius: {default: 5 mm, min: 1 mm}}` declares numbers that any
  value may be computed from: `$E`, `"2*$radius"`, `"$E / 3"`, `"round($length / $edge) + 1"`; a text with
  `$` is a [formula](how-it-works.md#parameters-and-repeated-entries).
  `--set parameters.E='3 MPa'` changes one.
- **Repeated entries**: `repeat: {count: 7, rotate: {axis: [0, 0, 1], full: true}}` makes copies of an entry;
  `$i` counts them from 0, in formulas and in names such as `arm_$i`.
- **Selections**: `beam` (all nodes), `beam.start`, `beam.end`, `sheet.boundary` (the rims of a shell), a
  group of a mesh `beam.NAME`, or one of the mappings under [Selections](#groupselection).
- **Files** are named relative to the folder of the scenario and must lie in it, unless
  `--allow-outside` is given.
- **Precedence**: defaults < `include` < the file < profile < `--set KEY=VALUE`. Mappings merge key by
  key, lists and values replace; a mapping of another `type` or `shape` replaces as a whole.
- **Profiles**: `draft` takes 4 dt, a Newton tolerance of 1e-5, and `tr_bdf2` for an integrator without
  damping; `accurate` dt / 4 and 1e-10; `normal` the file as written. `profiles` in the file replaces them.
"""


class _Generator(GenerateJsonSchema):
    """Without the titles that pydantic makes up from field names."""

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False


def json_schema() -> dict[str, Any]:
    """JSON Schema (2020-12) of a scenario, for editors."""
    schema: dict[str, Any] = Scenario.model_json_schema(by_alias=True, schema_generator=_Generator)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **with_expanded(schema)}


def markdown_reference() -> str:
    """A page with one table of keys per mapping of the language."""
    schema = json_schema()
    parts = [_INTRODUCTION, _section("Scenario", schema)]
    parts += [_section(name, part) for name, part in _ordered(schema).items() if "properties" in part]
    parts.append(_units())
    return "\n".join(parts)


def _ordered(schema: dict[str, Any]) -> dict[str, Any]:
    """The definitions in the order in which the keys of the scenario lead to them."""
    definitions: dict[str, Any] = schema["$defs"]
    found: dict[str, Any] = {}

    def visit(node: Any) -> None:
        if isinstance(node, dict):
            reference = node.get("$ref", "")
            name = reference.rpartition("/")[2]
            if name and name not in found:
                found[name] = definitions[name]
                visit(definitions[name])
            for key, child in node.items():
                if key not in ("$defs", "discriminator", "default"):
                    visit(child)
        elif isinstance(node, list):
            for child in node:
                visit(child)

    visit(schema)
    return found


def _section(name: str, schema: dict[str, Any]) -> str:
    required = schema.get("required", [])
    rows = [
        f"| `{key}` | {_kind(part)} | {_default(key, part, required)} | {_meaning(part)} |"
        for key, part in schema["properties"].items()
    ]
    head = ["| key | value | default | meaning |", "|---|---|---|---|"]
    text = " ".join(schema.get("description", "").split())
    return "\n".join([f"## {name}", "", text, "", *head, *rows, ""])


def _default(key: str, part: dict[str, Any], required: list[str]) -> str:
    if key in required:
        return "required"
    value = part.get("default")
    match value:
        case None:
            return ""
        case dict() as given:
            return f"`type: {given['type']}`" if "type" in given else ""
        case list() as items:
            return f"`[{', '.join(map(str, items))}]`" if items else ""
        case bool():
            return f"`{str(value).lower()}`"
        case _:
            return f"`{value}`" if value != "" else ""


def _kind(part: dict[str, Any]) -> str:
    """What a key takes, in words."""
    if "x-unit" in part:
        law = "law of " if part.get("x-law") else ""
        varies = "" if part.get("x-law", True) else ", may vary"
        unit = "" if part["x-unit"] == "1" else f" [{part['x-unit']}]"
        return f"{law}{'number' if part['x-quantity'] == 'ratio' else part['x-quantity']}{unit}{varies}"
    if "$ref" in part:
        name = part["$ref"].rpartition("/")[2]
        return f"[{name}](#{name.lower()})"
    for key in ("oneOf", "anyOf"):
        if key in part:
            kinds = dict.fromkeys(_kind(item) for item in part[key] if item.get("type") != "null")
            return " or ".join(kinds)
    if "enum" in part or "const" in part:
        return ", ".join(f"`{_plain(value)}`" for value in part.get("enum", [part.get("const")]))
    match part.get("type"):
        case ["number", "string"]:
            return "number or quantity"
        case ["integer", "string"]:
            return "whole number"
        case "array":
            low, high = part.get("minItems"), part.get("maxItems")
            count = f"{low} x " if low == high and low else ""
            return f"list of {count}{_kind(part['items'])}"
        case "object":
            named = [*part.get("patternProperties", {}).values(), part.get("additionalProperties")]
            inner = [_kind(extra) for extra in named if isinstance(extra, dict)]
            return f"mapping of names to {inner[0]}" if inner else "mapping"
        case "string":
            return "text"
        case "integer":
            return "whole number"
        case "boolean":
            return "`true`, `false`"
        case kind:
            return str(kind or "anything")


def _plain(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def _meaning(part: dict[str, Any]) -> str:
    return str(part.get("description", "")).replace("|", "\\|")


def _units() -> str:
    rows = [f"| {name} | `{kind.unit}` |" for name, kind in KINDS.items()]
    return "\n".join(["## Quantities", "", "| quantity | SI unit |", "|---|---|", *rows, ""])
