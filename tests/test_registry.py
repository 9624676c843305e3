"""Every kind of thing that the scenario language offers is used by a shipped scenario."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from dismech_cli.scenario.load import json_schema

SCENARIOS = Path(__file__).parents[1] / "scenarios"
# What a scenario uses without naming it: `radius` is a round section, a shell's natural shape is its
# rest shape (tests/test_build_shell.py bends one that is naturally flat).
IMPLIED = {("type", "round"), ("shape", "rest"), ("shape", "flat")}


def kinds_offered() -> set[tuple[str, str]]:
    """The tags of all discriminated unions: ``("type", "gravity")``, ``("shape", "helix")``, ..."""
    found = set()
    for definition in json_schema()["$defs"].values():
        for key in ("type", "shape"):
            entry = definition.get("properties", {}).get(key, {})
            found |= {(key, value) for value in entry.get("enum", [entry.get("const")]) if value}
    return found


def kinds_used(node: Any) -> Iterator[tuple[str, str]]:
    """The tags that a scenario writes."""
    if isinstance(node, dict):
        yield from ((key, value) for key, value in node.items() if isinstance(value, str))
        for value in node.values():
            yield from kinds_used(value)
    elif isinstance(node, list):
        for value in node:
            yield from kinds_used(value)


def test_every_kind_is_used_by_a_scenario() -> None:
    offered = kinds_offered()
    assert len(offered) > 30, "the schema has lost its tags"
    used = {
        kind
        for file in SCENARIOS.rglob("*.yaml")
        for kind in kinds_used(yaml.safe_load(file.read_text(encoding="utf-8")))
    }
    assert offered - used - IMPLIED == set()
