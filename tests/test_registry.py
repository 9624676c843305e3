"""Every kind of thing that the scenario language offers is built, and used by a shipped scenario."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

import pytest
from cli_call import Call
from cli_call import call as call
from pydantic import BaseModel
from rare_decks import PICTURES, RARE, picture_deck

from dismech_cli.compose.compose import compose
from dismech_cli.compose.loads.table import BUILDERS
from dismech_cli.compose.numerics import DRIVERS, build_integrator
from dismech_cli.compose.observables.fields import FIELDS
from dismech_cli.compose.shells.bending import SHELL_BENDING
from dismech_cli.compose.shells.hinges import HINGES
from dismech_cli.compose.shells.membrane import MEMBRANES, TRIANGLES
from dismech_cli.output.writers import WRITERS
from dismech_cli.run.loop import End
from dismech_cli.run.observables.reduce import REDUCTIONS
from dismech_cli.scenario.checking.names import SURFACE_GROUPS
from dismech_cli.scenario.language import numerics
from dismech_cli.scenario.language.expect import Reduction
from dismech_cli.scenario.language.force import Force, Load
from dismech_cli.scenario.language.geometry import Shell
from dismech_cli.scenario.language.material import Material
from dismech_cli.scenario.language.output import FieldName, WriterName
from dismech_cli.scenario.language.scenario import Scenario
from dismech_cli.scenario.language.surface import Surface
from dismech_cli.scenario.load import load
from dismech_cli.scenario.text.profiles import NAMES
from dismech_cli.scenario.views.walk import walk
from dismech_cli.session.simulate import simulate
from dismech_cli.solve.integrators import INTEGRATORS
from dismech_cli.solve.linear.choice import LINEAR_SOLVERS
from dismech_cli.solve.linear.pardiso import pardiso_available
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
    files = [file for file in sorted(SCENARIOS.rglob("*.yaml")) if file.parent.name != "base"]
    classes, choices = zip(*(occurring(load(file).scenario) for file in files), strict=True)
    return frozenset().union(*classes), frozenset().union(*choices)


def occurring(scenario: Scenario) -> tuple[frozenset[type[BaseModel]], frozenset[Choice]]:
    """Classes and choices of a validated scenario."""
    specs = [value for _, value in walk(scenario) if isinstance(value, BaseModel)]
    return frozenset(map(type, specs)), frozenset(choice for spec in specs for choice in choices_of(spec))


def choices_of(spec: BaseModel) -> Iterator[Choice]:
    for name, choices in literals(type(spec)):
        value = getattr(spec, name)
        for chosen in value if isinstance(value, tuple | Mapping) else (value,):
            if chosen in choices:
                yield name, choices, chosen


def test_the_schema_is_walked() -> None:
    names = {kind.__name__ for kind in classes_offered()}
    assert {"Gravity", "Shell", "Newton", "SineLaw", "Tangential", "SphereSelection", "Tolerance"} <= names
    assert ("bending", get_args(Shell.model_fields["bending"].annotation), "averaged") in choices_offered()


def test_a_rare_class_is_one_that_no_scenario_uses() -> None:
    rare = set().union(*(one.classes for one in RARE.values()))
    assert {kind.__name__ for kind in classes_offered() - used()[0]} == rare


def test_a_rare_choice_is_one_that_no_scenario_makes() -> None:
    rare = set().union(
        *(one.choices for one in RARE.values()), *(one.render.items() for one in PICTURES.values())
    )
    assert {(name, choice) for name, _, choice in choices_offered() - used()[1]} == rare


@pytest.mark.parametrize("name", RARE)
def test_what_is_rare_works_too(tmp_path: Path, name: str) -> None:
    if name == "numba":
        pytest.importorskip("numba")
    if name == "pardiso" and not pardiso_available():
        pytest.skip("no MKL here")
    rare = RARE[name]
    for file, text in rare.files.items():
        (tmp_path / file).write_text(text, encoding="utf-8")
    scene = tmp_path / "scene.yaml"
    scene.write_text(json.dumps(rare.deck), encoding="utf-8")
    loaded = load(scene, profile=rare.profile)
    classes, choices = occurring(loaded.scenario)
    assert rare.classes <= {kind.__name__ for kind in classes}
    declared = {("profiles", loaded.profile)}
    assert rare.choices <= {(key, chosen) for key, _, chosen in choices} | declared
    if rare.steps is None:
        rare.ends(compose(loaded))
        return
    result = simulate(loaded)
    assert result.outcome.end is End.DONE
    rare.ends(result.composition)
    rare.steps(loaded, result)


@pytest.mark.parametrize("name", PICTURES)
def test_rare_pictures_are_drawn(call: Call, tmp_path: Path, name: str) -> None:
    picture = PICTURES[name]
    scene = tmp_path / "scene.yaml"
    scene.write_text(json.dumps(picture_deck(picture)), encoding="utf-8")
    _, choices = occurring(load(scene).scenario)
    assert set(picture.render.items()) <= {(key, chosen) for key, _, chosen in choices}
    assert call("run", scene, "--output", tmp_path / "out").code == 0
    assert call("render", tmp_path / "out").code == 0
    assert (tmp_path / "out" / "render" / picture.file).stat().st_size > 0


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
    "materials of triangles": (TRIANGLES, choices(Material, "model")),
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
