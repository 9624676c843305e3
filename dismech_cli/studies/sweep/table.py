"""The table of a sweep, made anew from its points every time: nothing is ever appended to it."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from ...frozen import frozen
from ...output.durable import output_errors, staged, write_bytes
from ...output.jsonable import Json
from .task import Result

TIMES: Final = ("cpu", "wall")
"""Columns that differ between two sweeps of the same points."""

_COUNTERS: Final = ("steps", "iterations", "cuts", "frames")


@frozen
class Column:
    """A column of the table.

    Attributes:
        name: Its name.
        unit: SI unit; empty where there is none.
        values: A number or text for each point; None where there is no value.
        role: ``setting``, ``response`` or ``fact``.
    """

    name: str
    unit: str
    values: tuple[Json, ...]
    role: str

    @property
    def numbers(self) -> tuple[float, ...] | None:
        """Its values as numbers, NaN where there is none; None if some are text."""
        found = []
        for value in self.values:
            match value:
                case None:
                    found.append(float("nan"))
                case bool() | int() | float():
                    found.append(float(value))
                case "nan" | "inf" | "-inf":
                    found.append(float(value))
                case _:
                    return None
        return tuple(found)

    @property
    def title(self) -> str:
        """Name and unit."""
        return f"{self.name} [{self.unit}]" if self.unit not in ("", "1") else self.name


def columns(results: Sequence[Result]) -> list[Column]:
    """What points set, what they gave, and what it took."""

    def fact(name: str, values: Iterable[Json], unit: str = "") -> Column:
        return Column(name, unit, tuple(values), "fact")

    made = [fact("id", (one.id for one in results))]
    settings = [{str(entry["key"]): entry for entry in one.settings} for one in results]
    for key in _in_order(settings):
        unit = next(str(entries[key]["unit"]) for entries in settings if key in entries)
        values = tuple(entries[key]["value"] if key in entries else None for entries in settings)
        made.append(Column(key, unit, values, "setting"))
    made += [fact("status", (one.status for one in results))]
    made += [fact("exit_code", (one.exit_code for one in results))]
    for name in _in_order([one.units for one in results]):
        unit = next(one.units[name] for one in results if name in one.units)
        made.append(Column(f"probe.{name}", unit, tuple(one.probes.get(name) for one in results), "response"))
    expected = [{str(entry["name"]): entry for entry in one.expectations} for one in results]
    for name in _in_order(expected):
        unit = next(str(entries[name]["unit"]) for entries in expected if name in entries)
        found = [entries.get(name, {}) for entries in expected]
        made.append(Column(f"expect.{name}", unit, tuple(e.get("measured") for e in found), "response"))
        made.append(fact(f"expect.{name}.kept", (e.get("passed") for e in found)))
    made.append(fact("energy_error", (one.energy_error for one in results), "J"))
    if any(one.penetration is not None for one in results):
        made.append(Column("penetration", "1", tuple(one.penetration for one in results), "response"))
    made += [fact(name, (one.counters.get(name) for one in results)) for name in _COUNTERS]
    made += [fact("cpu", (one.cpu for one in results), "s"), fact("wall", (one.wall for one in results), "s")]
    return made


def _in_order(mappings: Iterable[Iterable[str]]) -> list[str]:
    return list(dict.fromkeys(key for one in mappings for key in one))


def write_csv(file: Path, table: Sequence[Column]) -> None:
    """Write the table as text.

    Raises:
        OutputError: If it cannot be written.
    """
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow([column.title for column in table])
    lines.writerows(zip(*(map(_cell, column.values) for column in table), strict=True))
    write_bytes(file, text.getvalue().encode())


def write_hdf5(file: Path, table: Sequence[Column]) -> None:
    """Write the table as one dataset per column, numbers as such, with its unit.

    Raises:
        OutputError: If it cannot be written.
    """
    import h5py

    with staged(file) as temporary, output_errors(file), h5py.File(temporary, "w") as target:
        for column in table:
            numbers = column.numbers
            if numbers is None:
                texts = ["" if value is None else str(value) for value in column.values]
                data = target.create_dataset(column.name, data=texts, dtype=h5py.string_dtype())
            else:
                data = target.create_dataset(column.name, data=np.array(numbers))
            data.attrs["units"] = column.unit
            data.attrs["role"] = column.role


def _cell(value: Json) -> str:
    match value:
        case None:
            return ""
        case bool():
            return "yes" if value else "no"
        case float():
            return repr(value)
        case _:
            return str(value)
