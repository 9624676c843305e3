"""Columns of the groups ``/dismech/state`` and ``/dismech/scalars``: one row per frame."""

from __future__ import annotations

from collections.abc import Iterator

from ..frame import Topology
from .vtkhdf import ColumnPlan, Value


def plan_state(topology: Topology) -> Iterator[ColumnPlan]:
    """Yield the columns of the raw state arrays and of the scalars."""
    for order, (name, (shape, unit)) in enumerate(topology.state.items()):
        attributes = _attributes(name, unit, order)
        yield f"dismech/state/{name}", 1, tuple(shape), "f8", attributes, _state_value(name)
    for order, (name, unit) in enumerate(topology.scalars.items()):
        attributes = _attributes(name, unit, order)
        yield f"dismech/scalars/{name}", 1, (), "f8", attributes, _scalar_value(name)


def _attributes(name: str, unit: str, order: int) -> dict[str, str | int]:
    """What describes a column; HDF5 lists names alphabetically, so that their order is told."""
    return {"units": unit, "long_name": name.replace("_", " "), "order": order}


def _state_value(name: str) -> Value:
    return lambda frame, row: frame.state[name]


def _scalar_value(name: str) -> Value:
    return lambda frame, row: frame.scalars[name]
