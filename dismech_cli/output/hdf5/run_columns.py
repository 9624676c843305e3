"""Columns of the groups ``/dismech/state`` and ``/dismech/scalars``: one row per frame."""

from __future__ import annotations

from collections.abc import Iterator

from ..frame import Topology
from .vtkhdf import ColumnPlan, Value


def plan_state(topology: Topology) -> Iterator[ColumnPlan]:
    """Yield the columns of the raw state arrays and of the scalars."""
    for name, (shape, unit) in topology.state.items():
        attributes = {"units": unit, "long_name": name.replace("_", " ")}
        yield f"dismech/state/{name}", 1, tuple(shape), "f8", attributes, _state_value(name)
    for name, unit in topology.scalars.items():
        attributes = {"units": unit, "long_name": name.replace("_", " ")}
        yield f"dismech/scalars/{name}", 1, (), "f8", attributes, _scalar_value(name)


def _state_value(name: str) -> Value:
    return lambda frame, row: frame.state[name]


def _scalar_value(name: str) -> Value:
    return lambda frame, row: frame.scalars[name]
