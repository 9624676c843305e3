"""Every kind of thing that the scenario language offers is built, and used by a shipped scenario."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

import pytest
from pydantic import BaseModel

from dismech_cli.compose.loads.table import BUILDERS
from dismech_cli.compose.numerics import DRIVERS, build_integrator
from dismech_cli.compose.observables.fields import FIELDS
from dismech_cli.compose.shells.bending import HINGES, SHELL_BENDING
from dismech_cli.compose.shells.membrane import MEMBRANES
from dismech_cli.output.writers import WRITERS
from dismech_cli.run.observables.reduce import REDUCTIONS
from dismech_cli.scenario.checking.names import SURFACE_GROUPS
from dismech_cli.scenario.language import numerics
from dismech_cli.scenario.language.expect import Reduction
from dismech_cli.scenario.language.force import Force, Load
from dismech_cli.scenario.language.geometry import Shell
from dismech_cli.scenario.language.output import FieldName, WriterName
from dismech_cli.scenario.language.scenario import Scenario
from dismech_cli.scenario.language.surface import Surface
from dismech_cli.scenario.load import load
from dismech_cli.scenario.text.profiles import NAMES
from dismech_cli.scenario.views.walk import walk
from dismech_cli.solve.integrators import INTEGRATORS
from dismech_cli.solve.linear.choice import LINEAR_SOLVERS
from dismech_cli.solve.tangents import TANGENTS

SCENARIOS = Path(__file__).parents[1] / "scenarios"

Choice = tuple[str, tuple[Any, ...], Any]
"""Key, everything that may stand there, and one of it."""


def parts(annotation: Any) -> Iterator[Any]:
    """The types that an annotation is made of: schema classes and literals."""
    if get_origin(annotation) is Literal or (
        isinstance(annotation, type) and issubclass(annotation, BaseModel)
    ):
        yield annotation
    else:
        for argument in get_args(annotation):
            yield from parts(argument)


def literals(kind: type[BaseModel]) -> Iterator[tuple[str, tuple[Any, ...]]]:
    """The keys of a schema class that leave a choice, and the choices."""
    for name, field in kind.model_fields.items():
        for part in parts(field.annotation):
            if get_origin(part) is Literal and len(get_args(part)) > 1:
                yield name, get_args(part)


@cache
def classes_offered() -> frozenset[type[BaseModel]]:
    """Every class of the schema."""
    found: set[type[BaseModel]] = set()
    todo: list[type[BaseModel]] = [Scenario]
    while todo:
        kind = todo.pop()
        if kind not in found:
            found.add(kind)
            for field in kind.model_fields.values():
                todo += [part for part in parts(field.annotation) if get_origin(part) is not Literal]
    return frozenset(found)


def choices_offered() -> set[Choice]:
    return {
        (name, choices, choice)
        for kind in classes_offered()
        for name, choices in literals(kind)
        for choice in choices
    }


@cache
def used() -> tuple[frozenset[type[BaseModel]], frozenset[Choice]]:
    """Classes and choices of the shipped scenarios as validated, defaults among them."""
    classes: set[type[BaseModel]] = set()
    choices: set[Choice] = set()
    for file in sorted(SCENARIOS.rglob("*.yaml")):
        if file.parent.name != "base":
            for _, value in walk(load(file).scenario):
                if isinstance(value, BaseModel):
                    classes.add(type(value))
                    choices |= set(choices_of(value))
    return frozenset(classes), frozenset(choices)


def choices_of(spec: BaseModel) -> Iterator[Choice]:
    for name, choices in literals(type(spec)):
        value = getattr(spec, name)
        for chosen in value if isinstance(value, tuple | Mapping) else (value,):
            if chosen in choices:
                yield name, choices, chosen


# What no shipped scenario uses, for each belongs to a machine, to taste or to a special case: the test
# file that does, and words in it. `auto` and other defaults count as used.
OTHER_CLASSES = {
    "RoundSection": ("compose/test_hybrids.py", '"radius"'),
    "Sawtooth": ("scenario/test_reference.py", "sawtooth"),
    "SawtoothLaw": ("scenario/test_reference.py", "sawtooth"),
    "Sine": ("scenario/test_reference.py", "sine"),
    "SineLaw": ("scenario/test_reference.py", "sine"),
    "TableFile": ("scenario/test_reference.py", "{table: {file: w.csv"),
    "VelocityFile": ("verification/test_vibration.py", '"velocity": {"file"'),
}
OTHER_CHOICES = {
    ("color_by", "axial_force"): ("render/test_parts.py", "color_by"),
    ("color_by", "director"): ("render/test_parts.py", "color_by"),
    ("color_by", "positions"): ("render/test_parts.py", "color_by"),
    ("color_by", "velocity"): ("render/test_parts.py", "color_by"),
    ("fields", "positions"): ("scenario/test_errors.py", "positions"),
    ("handedness", "left"): ("verification/test_helix_vibration.py", "left"),
    ("hinges", "equal"): ("verification/test_plate_linear.py", '"hinges", "pattern"'),
    ("interpolation", "cubic"): ("laws/test_laws.py", '"cubic"'),
    ("interpolation", "step"): ("laws/test_laws.py", '"step"'),
    ("kernels", "numba"): ("kernels/test_drivers.py", "NumbaDriver"),
    ("kernels", "numpy"): ("kernels/test_drivers.py", "NUMPY"),
    ("linear_solver", "banded"): ("solve/test_linear.py", "banded"),
    ("linear_solver", "dense"): ("solve/test_linear.py", "dense"),
    ("linear_solver", "pardiso"): ("solve/test_linear.py", "pardiso"),
    ("linear_solver", "superlu"): ("solve/test_linear.py", "superlu"),
    ("pattern", "unstructured"): ("verification/test_shell_published.py", "unstructured"),
    ("plane", "xy"): ("scenarios/test_rods.py", "plane=xy"),
    ("profiles", "accurate"): ("scenario/test_load.py", "accurate"),
    ("profiles", "draft"): ("scenario/test_load.py", "draft"),
    ("profiles", "normal"): ("scenario/test_load.py", "normal"),
    ("reduce", "first"): ("run/test_reduce.py", "first"),
    ("release", "bending"): ("compose/test_hybrids.py", '"bending"'),
    ("shape", "flat"): ("compose/test_shells.py", '"flat"'),
    ("video", "gif"): ("render/test_pictures.py", "gif"),
    ("view", "yz"): ("render/test_parts.py", '"yz"'),
}


def test_the_schema_is_walked() -> None:
    names = {kind.__name__ for kind in classes_offered()}
    assert {"Gravity", "Shell", "Newton", "SineLaw", "Tangential", "SphereSelection", "Tolerance"} <= names
    assert ("bending", get_args(Shell.model_fields["bending"].annotation), "averaged") in choices_offered()


def test_every_class_is_used_by_a_scenario() -> None:
    assert {kind.__name__ for kind in classes_offered() - used()[0]} == set(OTHER_CLASSES)


def test_every_choice_is_used_by_a_scenario() -> None:
    assert {(name, choice) for name, _, choice in choices_offered() - used()[1]} == set(OTHER_CHOICES)


@pytest.mark.parametrize(("file", "words"), sorted({*OTHER_CLASSES.values(), *OTHER_CHOICES.values()}))
def test_what_no_scenario_uses_is_tested(file: str, words: str) -> None:
    assert words in (Path(__file__).parent / file).read_text(encoding="utf-8")


# ---------------------------------------------------------------- registries


def members(union: Any) -> set[type[BaseModel]]:
    """The classes of a union."""
    return {part for part in parts(union) if get_origin(part) is not Literal}


def tags(union: Any, key: str) -> set[str]:
    """What tells the classes of a union apart."""
    return {tag for kind in members(union) for tag in get_args(kind.model_fields[key].annotation)}


def choices(kind: type[BaseModel], name: str) -> set[Any]:
    """What may stand under a key, beside leaving it to the program."""
    (found,) = (found for key, found in literals(kind) if key == name)
    return set(found) - {"auto"}


REGISTRIES = {
    "forces": (BUILDERS, members(Force)),
    "shell bending": (SHELL_BENDING, choices(Shell, "bending")),
    "hinges": (HINGES, choices(Shell, "hinges")),
    "membranes": (MEMBRANES, choices(Shell, "membrane")),
    "writers": (WRITERS, set(get_args(WriterName))),
    "fields": (FIELDS, set(get_args(FieldName)) - {"positions"}),
    "linear solvers": (LINEAR_SOLVERS, choices(numerics.Numerics, "linear_solver")),
    "kernels": (DRIVERS, choices(numerics.Numerics, "kernels")),
    "tangents": (TANGENTS, choices(numerics.Newton, "projection")),
    "integrators": ({i.name for i in INTEGRATORS}, tags(numerics.Integrator, "type")),
    "reductions": (REDUCTIONS, set(get_args(Reduction))),
    "surface groups": (SURFACE_GROUPS, tags(Surface, "shape")),
    "profiles": (NAMES, set(get_args(get_args(Scenario.model_fields["profiles"].annotation)[0]))),
}


@pytest.mark.parametrize("name", REGISTRIES)
def test_a_registry_holds_what_the_language_offers(name: str) -> None:
    registry, offered = REGISTRIES[name]
    assert offered
    assert set(registry) == offered


def test_a_tag_belongs_to_one_force() -> None:
    assert len(tags(Force, "type")) == len(members(Force))


@pytest.mark.parametrize("kind", sorted(members(Force), key=lambda kind: kind.__name__))
def test_a_force_says_what_it_acts_on(kind: type[Load]) -> None:
    named = {"rods", "shells", "shell"}.intersection(kind.model_fields)
    assert named == ({kind.acts_on} if kind.acts_on else set())


@pytest.mark.parametrize("spec", sorted(members(numerics.Integrator), key=lambda kind: kind.__name__))
def test_an_integrator_is_built_under_its_name(spec: Any) -> None:
    (name,) = get_args(spec.model_fields["type"].annotation)
    assert build_integrator(spec(type=name)).name == name
