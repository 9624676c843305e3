"""The schema for editors: it takes every shipped file, and refuses what the loader refuses for its form."""

from __future__ import annotations

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator
from scenario_folder import SCENE

from dismech_cli.errors import ScenarioError
from dismech_cli.quantities import QuantityError, parse_quantity
from dismech_cli.scenario.load import load, load_text
from dismech_cli.scenario.text.files import parse_source, read_source
from dismech_cli.scenario.text.tree import Source
from dismech_cli.scenario.text.yaml_text import parse_yaml
from dismech_cli.scenario.views.dump import resolved
from dismech_cli.scenario.views.editor import editor_schema
from dismech_cli.scenario.views.unit_text import NOT_NEGATIVE, POSITIVE, quantity_text
from dismech_cli.units import KINDS, UNITS

SCENARIOS = Path(__file__).parents[2] / "scenarios"
FILES = sorted(SCENARIOS.rglob("*.yaml"))


@cache
def validator() -> Draft202012Validator:
    schema = editor_schema()
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


def accepts(text: str) -> bool:
    return bool(validator().is_valid(lists(parse_yaml(Source("scene.yaml", text)).plain())))


def lists(data: Any) -> Any:
    """What an editor sees: the loader's lists are tuples."""
    return json.loads(json.dumps(data))


@pytest.mark.parametrize("file", FILES, ids=lambda file: str(file.relative_to(SCENARIOS)))
def test_shipped_files(file: Path) -> None:
    """Scenarios, those that include others, and the fragments that are included."""
    data = lists(parse_source(read_source(file, file.name), file.suffix).plain())
    errors = [f"{error.json_path}: {error.message[:200]}" for error in validator().iter_errors(data)]
    assert errors == []


def test_resolved_scenarios() -> None:
    """What a run keeps, every default filled in."""
    for name in ("parachute", "let_go", "grippers", "jellyfish", "snake"):
        data = lists(resolved(load(SCENARIOS / f"{name}.yaml").scenario))
        assert [error.message[:200] for error in validator().iter_errors(data)] == []


def test_the_scene_of_these_tests_is_right() -> None:
    load_text(SCENE)
    assert accepts(SCENE)
    # a part: nothing of it is missing, for what includes it has the rest
    assert accepts("schema_version: 1\nnumerics: {dt: 1 ms}\n")
    assert accepts("schema_version: 1\ninclude: [a.yaml]\nname: b\nexpect: {tip: {value: 3}}\n")


WRONG = {
    "unit of a modulus": ("2 MPa", "2 mm"),
    "unknown unit": ("2 MPa", "2 MPaa"),
    "no number": ("2 MPa", "stiff"),
    "unit of a density": ("1.2 g/cm^3", "1.2 g/cm^2"),
    "unit of a density, one factor": ("1.2 g/cm^3", "1.2 g"),
    "sign of a modulus": ("2 MPa", "-2 MPa"),
    "zero": ("radius: 1 mm", "radius: 0 mm"),
    "sign of a number": ("radius: 1 mm", "radius: -1"),
    "unit of a length": ("radius: 1 mm", "radius: 1 s"),
    "speed for a length": ("radius: 1 mm", "radius: 1 m/s"),
    "list for a number": ("radius: 1 mm", "radius: [1 mm]"),
    "unit in a vector": ("to: [100 mm, 0, 0]", "to: [100 ms, 0, 0]"),
    "two components": ("to: [100 mm, 0, 0]", "to: [100 mm, 0]"),
    "unit in a table of places": ("radius: 1 mm", "radius: {of: s, table: [[0, 1 mm], [1, 1 s]]}"),
    "unit of a place": ("radius: 1 mm", "radius: {of: x, table: [[0, 1 mm], [1 s, 1 mm]]}"),
    "unknown place": ("radius: 1 mm", "radius: {of: t, table: [[0, 1 mm], [1, 1 mm]]}"),
    "table without its place": ("radius: 1 mm", "radius: {table: [[0, 1 mm], [1, 1 mm]]}"),
    "unit of a group": ("radius: 1 mm", "radius: {value: 1 mm, groups: {beam.end: 1 s}}"),
    "sign of a group": ("radius: 1 mm", "radius: {value: 1 mm, groups: {beam.end: -1 mm}}"),
    "two ways to vary": ("radius: 1 mm", "radius: {expression: '0.001', groups: {beam.end: 1 mm}}"),
    "unit of a relaxation time": ("youngs_modulus: 2 MPa", "youngs_modulus: 2 MPa, relaxation_time: 1 mm"),
    "sign of a relaxation time": ("youngs_modulus: 2 MPa", "youngs_modulus: 2 MPa, relaxation_time: -1 s"),
    "unit of a law": ("[0, 0, -9.81]", "[0, 0, -9.81 m/s]"),
    "unit in a ramp": ("[0, 0, -9.81]", "[0, 0, {ramp: {from: 0, to: 5 mm, end: 1 s}}]"),
    "unit of a time in a ramp": ("[0, 0, -9.81]", "[0, 0, {ramp: {from: 0, to: 5, end: 1 mm}}]"),
    "unit in a table": ("[0, 0, -9.81]", "[0, 0, {table: [[0, 0], [1 s, 5 Pa]]}]"),
    "two laws at once": ("[0, 0, -9.81]", "[0, 0, {expression: t, sine: {amplitude: 1, frequency: 1}}]"),
    "radius and section": ("radius: 1 mm", "radius: 1 mm\n    section: {type: round, radius: 1 mm}"),
    "neither radius nor section": ("    radius: 1 mm\n", ""),
    "generate and mesh": ("    radius: 1 mm", "    radius: 1 mm\n    mesh: {file: a.txt}"),
    "statics with dt": ("  dt: 5 ms\n", "  integrator: {type: static}\n  dt: 5 ms\n"),
    "unknown key": ("    radius: 1 mm", "    radius: 1 mm\n    colour: red"),
    "unknown key at the top": ("numerics:", "numeric: 3\nnumerics:"),
    "misspelt key": ("youngs_modulus", "young_modulus"),
    "unknown type": ("type: clamp", "type: clmp"),
    "unknown choice": ("where: beam.start}", "where: beam.start, at: middle}"),
    "missing key": ("  silicone: {youngs_modulus: 2 MPa, ", "  silicone: {"),
    "missing body": ("materials:", "material:"),
    "node count": ("nodes: 11", "nodes: 1"),
    "node count as text": ("nodes: 11", "nodes: many"),
    "version": ("schema_version: 1", "schema_version: 2"),
    "name": ("name: cantilever", "name: ../cantilever"),
    "name of a body": ("name: beam", "name: 1 beam"),
    "two selections": ("where: beam.start", "where: {group: beam.start, nearest: [0, 0, 0]}"),
    "indices and range": (
        "where: beam.start",
        "where: {nodes: {of: beam, indices: [0], range: [0, 1]}}",
    ),
    "group of two words": ("where: beam.start", "where: beam start"),
    "time below zero": ("t_end: 2 s", "t_end: -2 s"),
    "time in metres": ("t_end: 2 s", "t_end: 2 m"),
    "no time": ("t_end: 2 s", "t_end: {}"),
    "run and displacements": ("numerics:", "initial: {run: a, displacements: []}\nnumerics:"),
    "at and frame": ("numerics:", "initial: {run: scene.yaml, at: 1 s, frame: 3}\nnumerics:"),
    "rotation without an angle": (
        "where: beam.start}",
        "where: beam.start, rotations: [{axis: [1, 0, 0]}]}",
    ),
    "rotation by a length": (
        "where: beam.start}",
        "where: beam.start, rotations: [{axis: [1, 0, 0], angle: 1 mm}]}",
    ),
}


VARYING = (
    "{expression: '0.001*(2 - s)'}",
    "{of: s, table: [[0, 1 mm], [50 %, 2e-3], [1, 0.5 mm]], interpolation: cubic}",
    "{of: x, table: [[-1 cm, 1 mm], [0.1, 2 mm]]}",
    "{value: 1 mm, groups: {end: 2 mm}}",
)


@pytest.mark.parametrize("radius", VARYING)
def test_values_that_vary(radius: str) -> None:
    text = SCENE.replace("radius: 1 mm", f"radius: {radius}")
    load_text(text)
    assert accepts(text)


@pytest.mark.parametrize("name", WRONG)
def test_wrong_scenarios(name: str) -> None:
    """What the loader refuses for its form, the schema refuses too."""
    old, new = WRONG[name]
    assert old in SCENE
    text = SCENE.replace(old, new)
    with pytest.raises(ScenarioError):
        load_text(text)
    assert not accepts(text)


# ---------------------------------------------------------------- text of quantities

GOOD = (
    "2", "-2.5e-3", " .5 ", "+3 mm", "1.2 g/cm^3", "1.2 g/cm3", "1.2 g cm^-3", "5 N*s/m^2", "5 N s/m²",
    "2 /m", "3 1/m", "30 deg", "30°", "1 %", "1 kN·m", "2 kg*m/s^2", "1 N/(m*s)", "1 lbf/in**2", "3 m^4",
    "9.81 m/s^2", "1 rad/s", "2 Pa s", "1 N*m/rad", "5 µm", "2 kg m^2/s^2", "4 1/s", "7 J/m^3",
)  # fmt: skip
BAD = ("", "mm", "2 mmm", "2,5 mm", "2 mm 3", "2 N/m s", "2 (m", "1e mm", "--2", "2 m^", "0x2", "nan", "2 m/")


@pytest.mark.parametrize("text", GOOD + BAD)
@pytest.mark.parametrize("name", KINDS)
def test_text_against_the_loader(name: str, text: str) -> None:
    """No good text of up to two factors is refused; no text of another dimension is taken."""
    try:
        parse_quantity(text, KINDS[name])
        good = True
    except QuantityError:
        good = False
    told = re.search(quantity_text(name), text) is not None
    factors = len(re.findall(r"[A-Za-zµ]+", text.replace("e-", "")))
    if good and (factors < 3 or name not in {"ratio", "length", "time", "angle", "mass"}):
        assert told
    if not good and factors < 3:
        assert not told


def test_every_unit_of_a_kind() -> None:
    for name, kind in KINDS.items():
        for unit, (_, dimension) in UNITS.items():
            fits = dimension in (kind.dimension, *kind.also)
            assert (re.search(quantity_text(name), f"2 {unit}") is not None) == fits, (name, unit)
        assert re.search(quantity_text(name), f"1 {kind.unit}") or kind.unit == "1"


@pytest.mark.parametrize(
    ("text", "sign"), [("-1 m", -1), ("0 m", 0), ("0.0e5", 0), ("+0.01 m", 1), ("1e-9", 1)]
)
def test_signs(text: str, sign: int) -> None:
    assert (re.search(POSITIVE, text) is not None) == (sign > 0)
    assert (re.search(NOT_NEGATIVE, text) is not None) == (sign >= 0)


# ---------------------------------------------------------------- parameters and repeated entries

REPEATED = """\
parameters: {E: {default: 2, unit: MPa, max: 3}, r: 1 mm, n: 10}
output: {probes: {tip_$i: {repeat: 3, displacement: arm_$i.end, component: z}}}
""" + (
    SCENE.replace("2 MPa", "$E")
    .replace("radius: 1 mm", "radius: 2*$r")
    .replace("nodes: 11", "nodes: $n + 1")
    .replace("name: beam", "name: arm_$i\n    repeat: {count: 3, rotate: {axis: [0, 0, 1], full: true}}")
    .replace("where: beam.start", "where: arm_$i.start, repeat: 3")
)


def test_formulas_and_repeated_entries() -> None:
    load_text(REPEATED)
    assert accepts(REPEATED)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("count: 3", "cont: 3"),
        ("unit: MPa", "units: MPa"),
        ("full: true", "full: true, angle: 1"),
        ("repeat: 3}", "repeat: 0}"),
        ("numerics:", "numerics:\n  repeat: 3"),
    ],
)
def test_wrong_repeats(old: str, new: str) -> None:
    assert old in REPEATED
    text = REPEATED.replace(old, new)
    with pytest.raises(ScenarioError):
        load_text(text)
    assert not accepts(text)
