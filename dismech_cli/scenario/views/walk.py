"""Walks over a validated scenario by key path."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any, get_args

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from ...frozen import frozen
from ...units import KINDS
from ..language.control import Ideal, Incremental, Plugin, Positional
from ..language.expect import Expectation, measured
from ..language.numerics import Static
from ..language.probe import Probe
from ..language.scenario import Scenario
from ..language.sensor import ProbeSensor
from ..text.tree import KeyPath
from ..values.law_of import LawOf, Pair
from ..values.quantity import FileReference, Quantity
from ..values.selection import Selection, Selects
from ..values.strain import ANY, KIND_OF, StrainQuantity
from ..values.varying import ByTable


def walk(value: Any, path: KeyPath = ()) -> Iterator[tuple[KeyPath, Any]]:
    """Every value below ``value`` and itself, depth first, with its key path."""
    yield path, value
    match value:
        case BaseModel():
            for name, field in type(value).model_fields.items():
                yield from walk(getattr(value, name), (*path, field.alias or name))
        case Mapping():
            for key, child in value.items():
                yield from walk(child, (*path, key))
        case tuple():
            for i, child in enumerate(value):
                yield from walk(child, (*path, i))
        case _:
            pass


def probes(scenario: Scenario) -> Iterator[tuple[KeyPath, Probe]]:
    """All probes, those of expectations too, with their key paths."""
    for name, probe in scenario.output.probes.items():
        yield ("output", "probes", name), probe
    for name, expectation in scenario.expect.items():
        yield ("expect", name, "probe"), expectation.probe
    for name, sensor in scenario.sensors.items():
        if isinstance(sensor, ProbeSensor):
            yield ("sensors", name, "probe"), sensor.probe
    integrator = scenario.numerics.integrator
    if isinstance(integrator, Static) and integrator.path is not None and integrator.path.until is not None:
        yield ("numerics", "integrator", "path", "until", "probe"), integrator.path.until.probe


@frozen
class Selected:
    """A selection of the scenario.

    Attributes:
        path: Key path.
        finds: What it finds.
        where: As written.
    """

    path: KeyPath
    finds: Selects
    where: Selection


def selections(value: Any, path: KeyPath = (), finds: Selects | None = None) -> Iterator[Selected]:
    """Every selection of a scenario, with what the mark of its field says that it finds."""
    match value:
        case BaseModel() if finds is not None:
            yield Selected(path, finds, value)  # type: ignore[arg-type]  # by its mark
        case BaseModel():
            for name, key, mark in _selecting(type(value)):
                yield from selections(getattr(value, name), (*path, key), mark)
        case Mapping():
            for key, child in value.items():
                yield from selections(child, (*path, key), finds)
        case tuple():
            for i, child in enumerate(value):
                yield from selections(child, (*path, i), finds)
        case _:
            pass


@cache
def _selecting(kind: type[BaseModel]) -> tuple[tuple[str, str, Selects | None], ...]:
    """Name, key and mark of each field of a schema class."""
    return tuple(
        (name, field.alias or name, next((m for m in _marks(field) if isinstance(m, Selects)), None))
        for name, field in kind.model_fields.items()
    )


@frozen
class Leaf:
    """A number, text, flag or empty collection of the scenario.

    Attributes:
        path: Key path.
        value: In SI units.
        unit: SI unit; empty if the value is no quantity.
        file: True if the value names a file.
        folder: True if it may name a folder instead.
    """

    path: KeyPath
    value: Any
    unit: str
    file: bool
    folder: bool = False


def leaves(value: Any, path: KeyPath = (), marks: tuple[Any, ...] = ()) -> Iterator[Leaf]:
    """The leaves of a scenario in the order of the schema; keys that are not set are left out.

    Args:
        value: A scenario, or a part of one.
        path: Its key path.
        marks: What annotates the field that it is in.
    """
    match value:
        case None:
            return
        case BaseModel():
            # Inside a law the quantity is that of the field that holds the law.
            law = tuple(mark for mark in marks if isinstance(mark, LawOf))
            for name, field in type(value).model_fields.items():
                here = (*path, field.alias or name)
                yield from leaves(getattr(value, name), here, _special(value, name) + _marks(field) + law)
        case Mapping() if value:
            for key, child in value.items():
                yield from leaves(child, (*path, key), marks)
        case tuple() if value:
            pair = next((mark for mark in marks if isinstance(mark, Pair)), None)
            first = (Quantity(pair.first), *marks) if pair and isinstance(value[0], float) else marks
            for i, child in enumerate(value):
                yield from leaves(child, (*path, i), first if i == 0 else marks)
        case _:
            unit = _unit(marks) if isinstance(value, float) else ""
            files = [mark for mark in marks if isinstance(mark, FileReference) and isinstance(value, str)]
            yield Leaf(path, value, unit, bool(files), any(mark.folder for mark in files))


def _special(value: BaseModel, name: str) -> tuple[Any, ...]:
    """The quantity of a field that depends on another one."""
    match value:
        case Expectation() if name == "value":
            return (Quantity(measured(value.probe, value.reduce)),)
        case Positional() | Ideal() | Incremental() | Plugin() if (
            name in ("target", "limits") and value.strain
        ):
            return (LawOf(KIND_OF[value.strain]),)
        case ByTable(of="s") if name == "table":
            return (Pair("ratio"),)
        case _:
            return ()


def _marks(field: FieldInfo) -> tuple[Any, ...]:
    """All annotations of a field, those inside unions and containers too, outermost first."""
    return (*field.metadata, *_inner(field.annotation))


def _inner(annotation: Any) -> tuple[Any, ...]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return ()
    found: tuple[Any, ...] = tuple(getattr(annotation, "__metadata__", ()))
    for argument in get_args(annotation):
        found += _inner(argument)
    return found


def _unit(marks: tuple[Any, ...]) -> str:
    told = next((mark.name for mark in marks if isinstance(mark, LawOf)), ANY)
    for mark in marks:
        if isinstance(mark, StrainQuantity) and told != ANY:
            return KINDS[told if mark.name == ANY else f"rate of {told}"].unit
        if isinstance(mark, Quantity | LawOf):
            return KINDS[mark.name].unit
    return ""
