"""JSON Schema, Markdown reference and runtime laws made from the schema."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scenario_folder import SCENE, Folder, folder

from dismech_cli.csv_columns import read_columns
from dismech_cli.errors import ScenarioError
from dismech_cli.laws import laws
from dismech_cli.scenario.load import json_schema, markdown_reference
from dismech_cli.scenario.values.runtime_law import to_law

__all__ = ["folder"]


def _references(node: object) -> set[str]:
    if isinstance(node, dict):
        own = {node["$ref"]} if "$ref" in node else set()
        return own.union(*(_references(child) for child in node.values()))
    if isinstance(node, list):
        return set().union(*(_references(child) for child in node))
    return set()


def test_json_schema_is_closed_and_described() -> None:
    schema = json_schema()
    assert json.loads(json.dumps(schema)) == schema
    names = {reference.rpartition("/")[2] for reference in _references(schema)}
    assert names == set(schema["$defs"])
    assert schema["required"] == ["schema_version", "name", "materials", "geometry", "numerics"]
    assert "prefixItems" not in json.dumps(schema)  # editors stop at JSON Schema 7
    for name, part in schema["$defs"].items():
        assert part["additionalProperties"] is False, name
        assert part["description"], name
        for key, child in part["properties"].items():
            assert child.get("description"), f"{name}.{key}"


def test_json_schema_carries_bounds_and_units() -> None:
    modulus = json_schema()["$defs"]["Material"]["properties"]["youngs_modulus"]
    assert modulus["x-unit"] == "Pa"
    number, *laws = modulus["oneOf"]
    assert number["anyOf"] == [{"type": "number", "exclusiveMinimum": 0}, {"type": "string"}]
    assert [law["$ref"].rpartition("/")[2] for law in laws] == ["ByExpression", "ByTable", "ByGroup"]
    ratio = json_schema()["$defs"]["Material"]["properties"]["poisson_ratio"]
    assert ratio["anyOf"] == [{"type": "number", "exclusiveMinimum": -1, "maximum": 0.5}, {"type": "string"}]


def test_json_schema_takes_the_short_forms() -> None:
    definitions = json_schema()["$defs"]
    text, _ = definitions["Clamp"]["properties"]["where"]["anyOf"]
    assert text["type"] == "string"
    assert definitions["Expectation"]["properties"]["tolerance"]["anyOf"] == [
        {"type": "number"},
        {"type": "string"},
    ]


def test_committed_reference_is_up_to_date() -> None:
    page = Path(__file__).parents[2] / "docs" / "scenario.md"
    assert page.read_text(encoding="utf-8") == markdown_reference()


def test_every_kind_of_law_becomes_a_runtime_law(folder: Folder) -> None:
    folder.write("w.csv", "# drive\ntime, lift\n0, 0\n1, 2\n")
    specs = [
        "5 mm",
        "{table: [[0, 0], [1 s, 5 mm]], interpolation: cubic}",
        "{table: {file: w.csv, time: time, value: lift}}",
        "{table: {file: w.csv}, interpolation: step}",
        "{ramp: {from: 0, to: 5 mm, start: 1, end: 2}}",
        "{sine: {amplitude: 5 mm, frequency: 2 Hz, phase: 90 deg}}",
        "{sawtooth: {amplitude: 5 mm, frequency: 2 Hz, width: 50 %}}",
        "{expression: 5e-3*t}",
        "0",
    ]
    motions = "".join(
        f"  - {{type: pin, where: beam.end, displacement: [{', '.join(specs[i : i + 3])}]}}\n"
        for i in (0, 3, 6)
    )
    loaded = folder.load(SCENE.replace("motions:\n", "motions:\n" + motions))
    made = [
        to_law(spec, loaded.directory)
        for motion in loaded.scenario.motions[:3]
        for spec in motion.displacement or ()  # type: ignore[union-attr]
    ]
    assert made == [
        laws.Constant(0.005),
        laws.Table(times=(0.0, 1.0), values=(0.0, 0.005), interpolation="cubic"),
        laws.Table(times=(0.0, 1.0), values=(0.0, 2.0)),
        laws.Table(times=(0.0, 1.0), values=(0.0, 2.0), interpolation="step"),
        laws.Ramp(before=0.0, after=0.005, start=1.0, end=2.0),
        laws.Sine(amplitude=0.005, frequency=2.0, phase=np.pi / 2),
        laws.Sawtooth(amplitude=0.005, frequency=2.0, width=0.5),
        laws.Expression("5e-3*t"),
        laws.Constant(0.0),
    ]


def test_columns_by_name_and_number(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("# note\nx, y\n\n1, 2\n3, 4e1\n")
    y, x = read_columns(path, ("y", 0))
    assert_allclose(x, [1.0, 3.0])
    assert_allclose(y, [2.0, 40.0])


@pytest.mark.parametrize(
    ("text", "columns", "message"),
    [
        ("x,y\n1,2\n3,nan\n", ("y",), r"a\.csv:3: column y: expected a finite number, got 'nan'"),
        ("1,2\n3\n", (0, 1), r"a\.csv:2: column 1: expected a finite number, got 'nothing'"),
        ("x,y\n1,2\n", ("z",), r"has no column 'z'; there are x, y"),
        ("1,2\n", ("z",), r"its first line names no columns, but column 'z' is asked for"),
        ("1,2\n", (2,), r"has no column 2: there are 2, counted from 0"),
        ("", (0,), "holds no rows"),
        ("x,y\n", (0,), "holds no rows of numbers"),
    ],
)
def test_bad_columns(tmp_path: Path, text: str, columns: tuple[str | int, ...], message: str) -> None:
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(ScenarioError, match=message):
        read_columns(tmp_path / "a.csv", columns)
