"""Who set what: the origin of every value of a scenario."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...frozen import frozen
from ..language.scenario import Scenario
from ..text.parameters import KEY, Parameter
from ..text.tree import KeyPath, Node, Scalar, format_path
from .walk import leaves


@frozen
class Provenance:
    """A resolved value.

    Attributes:
        value: In SI units.
        unit: SI unit; empty if the value is no quantity.
        origin: ``scene.yaml:12:3``, ``base.yaml:3:1 (include)``, ``--set 'a=b'``, a profile, ``default``.
    """

    value: Any
    unit: str
    origin: str


def trace(scenario: Scenario, root: Node) -> Mapping[str, Provenance]:
    """The origin of each leaf of ``scenario``, by key path, from the tree that it was read from."""
    return {
        format_path(leaf.path): Provenance(leaf.value, leaf.unit, _origin(root, leaf.path))
        for leaf in leaves(scenario)
        if leaf.path[0] not in ("include", "profiles")
    }


def trace_parameters(parameters: Mapping[str, Parameter]) -> Mapping[str, Provenance]:
    """The origin of each parameter, by key path."""
    return {
        f"{KEY}.{name}": Provenance(one.amount.value, one.amount.unit, one.origin)
        for name, one in parameters.items()
    }


def as_json(parameters: Mapping[str, Parameter]) -> dict[str, dict[str, int | float | str]]:
    """Parameters for programs: value in SI, unit and origin by name."""
    return {
        name: {"value": one.amount.value, "unit": one.amount.unit, "origin": one.origin}
        for name, one in parameters.items()
    }


def _origin(root: Node, path: KeyPath) -> str:
    node = root
    for part in path:
        child = node.child(part)
        if child is None:
            # Text may be short for a mapping, as 'beam.start' is for {group: beam.start}.
            return node.origin if isinstance(node.value, Scalar) and node.value is not None else "default"
        node = child
    return node.origin if node.value is not None else "default"
