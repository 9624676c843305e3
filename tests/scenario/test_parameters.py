"""Parameters: formulas with units, bounds, origins, and what is refused."""

from __future__ import annotations

import json
import math

import pytest
from cli_call import Call
from cli_call import call as call
from numpy.testing import assert_allclose
from scenario_folder import SCENE, TOML, Folder, folder

from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.load import dump_resolved, load_mapping, load_text
from dismech_cli.scenario.text.amount import Amount
from dismech_cli.scenario.text.formula import FormulaError, evaluate
from dismech_cli.units import KINDS, Dimension

__all__ = ["folder"]

DECLARED = "parameters:\n  E: {default: 2, unit: MPa, min: 0.5, max: 10 MPa}\n  radius: 1 mm\n  n: 10\n"
USING = (
    SCENE.replace("2 MPa", "$E")
    .replace("radius: 1 mm", "radius: $radius")
    .replace("nodes: 11", "nodes: $n + 1")
)
TEXT = DECLARED + USING

NAMES = {
    "E": Amount(2e6, KINDS["pressure"].dimension),
    "r": Amount(0.005, Dimension(m=1)),
    "n": Amount(11),
    "i": Amount(3),
}


def names(name: str) -> Amount:
    if name not in NAMES:
        raise KeyError(f"unknown {name}")
    return NAMES[name]


@pytest.mark.parametrize(
    ("text", "value", "dimension"),
    [
        ("2*$r", 0.01, Dimension(m=1)),
        ("$E / 3", 2e6 / 3, KINDS["pressure"].dimension),
        ("$n + 1", 12, None),
        ("${n + 1}", 12, None),
        ("-$r**2", -2.5e-5, Dimension(m=2)),
        ("(2 m)**2 + 2 m**2", 6.0, Dimension(m=2)),
        ("1 / 2 mm", 500.0, Dimension(m=-1)),
        ("2 N/(m*s) * 1 s", 2.0, KINDS["force per length"].dimension),
        ("2 mm * pi + $r", 0.005 + 0.002 * math.pi, Dimension(m=1)),
        ("2 * min($r, 3 mm)", 0.006, Dimension(m=1)),
        ("sqrt($r * $r)", 0.005, Dimension(m=1)),
        ("$E * $r**2", 50.0, KINDS["force"].dimension),
        ("round($r / 1 mm) + 1", 6, None),
        ("cos(360 deg * $i / 6)", -1.0, Dimension()),
    ],
)
def test_formulas(text: str, value: float, dimension: Dimension | None) -> None:
    found = evaluate(text, names)
    assert found.dimension == dimension
    assert_allclose(found.value, value, rtol=4e-16)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("$r + 1", "cannot add a length and a number without a unit"),
        ("$E - $r", "cannot add a pressure and a length"),
        ("max($E, $r)", "cannot compare"),
        ("$x", "unknown x"),
        ("r", r"a parameter is written \$r"),
        ("3 Mpa * $r", "did you mean 'MPa'"),
        ("sqr($r)", "did you mean 'sqrt'"),
        ("sin($r)", "takes an angle"),
        ("round($r)", "takes a plain number"),
        ("9**9**9", "exponent"),
        ("1e300 * 1e300", "no number"),
        ("10**16 * " * 30 + "1", "no number"),
        ("$n / 0", "divides by zero"),
        ("sqrt(0 - $n)", "negative"),
        ("sqrt($r)", "has no unit"),
        ("(" * 60 + "1", "nested"),
        ("1 +", "too early"),
        ("($n", "not closed"),
        ("$n $n", "cannot read"),
        ("__import__('os')", "cannot read|unknown"),
        ("$n" + " + 1" * 400, "longer"),
    ],
)
def test_what_is_no_formula(text: str, reason: str) -> None:
    with pytest.raises(FormulaError, match=reason):
        evaluate(text, names)


def test_the_same_scenario_as_written_out() -> None:
    plain = load_text(SCENE)
    computed = load_text(TEXT)
    assert computed.scenario == plain.scenario
    assert computed.text_hash == plain.text_hash
    assert computed.warnings == plain.warnings
    assert (
        load_text(dump_resolved(computed.scenario, parameters=computed.parameters)).scenario == plain.scenario
    )


def test_values_come_from_settings(folder: Folder) -> None:
    def modulus(*overrides: str, profile: str | None = None) -> float:
        found = folder.load(TEXT + "profiles: {draft: {parameters: {E: 4}}}\n", *overrides, profile=profile)
        return float(found.provenance["materials.silicone.youngs_modulus"].value)

    assert modulus() == 2e6
    assert modulus("parameters.E=3 MPa") == modulus("parameters.E=3") == 3e6
    assert modulus(profile="draft") == 4e6
    assert modulus("parameters.E=5", profile="draft") == 5e6
    assert modulus("parameters.E.default=3") == 3e6


def test_includes_merge(folder: Folder) -> None:
    folder.write("base.yaml", DECLARED)
    found = folder.load("include: [base.yaml]\nparameters: {E: 3}\n" + USING)
    assert found.scenario.materials["silicone"].youngs_modulus == 3e6
    with pytest.raises(ScenarioError, match=r"at most 10 MPa|at most '10 MPa'"):
        folder.load("include: [base.yaml]\nparameters: {E: 30}\n" + USING)


def test_toml_and_mappings() -> None:
    text = TOML.replace('"2 MPa"', '"2*$E"').replace('"1 mm"', '"$r"')
    text = text.replace(
        "schema_version = 1\n", 'schema_version = 1\nparameters = { E = "1 MPa", r = "1 mm" }\n'
    )
    assert load_text(text, format="toml").scenario.materials["silicone"].youngs_modulus == 2e6
    data = load_text(SCENE).tree.plain() | {"parameters": {"r": 0.002}}
    data["geometry"] = [data["geometry"][0] | {"radius": "2*$r"}]
    assert load_mapping(data).scenario.geometry[0].radius == 0.004


def test_laws_and_tables() -> None:
    declared = "parameters: {A: 3 mm, f: 2 Hz, g: 9.81 m/s^2, T: 1 s}\n"
    law = "[{expression: '$A*sin(2*pi*${f}*t)'}, {table: [[0, 0], [$T, 2*$g]]}, -$g]"
    found = load_text(declared + SCENE.replace("[0, 0, -9.81]", law)).scenario.forces[0].acceleration
    assert found[0].expression == "(0.003)*sin(2*pi*(2.0)*t)"
    assert found[1].table[1] == (1.0, 19.62)
    assert found[2] == -9.81


def test_draft_multiplies_a_computed_step() -> None:
    text = "parameters: {f: 2 Hz}\n" + SCENE.replace("dt: 5 ms", "dt: 1 / (100*$f)")
    assert load_text(text, profile="draft").scenario.numerics.dt == 0.02


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (["parameters.E=20"], ["at most", "10 MPa", "<text>:2:"]),
        (["parameters.E=0.1 MPa"], ["at least"]),
        (["parameters.E=3 mm"], ["expected a pressure", "<text>:2:", "got a length"]),
        (["parameters.radius=3 s"], ["expected a length", "<text>:3:11", "got a time"]),
        (["parameters.radiu=3"], ["unknown parameter", "did you mean 'radius'"]),
        (["parameters.radius=$n * $radius"], ["depend on each other: $radius -> $radius"]),
        (["parameters.radius=true"], ["a number or a quantity"]),
        (["geometry[0].radius=$E"], ["expected a length", "'$E' with E = 2e+06 Pa at <text>:2:"]),
        (["geometry[0].radius=$Radius"], ["geometry[0].radius", "did you mean 'radius'"]),
        (["geometry[0].radius=$i * 1 mm"], ["'repeat'"]),
        (["geometry[0].generate.nodes=$n / 4"], ["whole number, got 2.5", "n = 10"]),
        (["geometry[0].name=beam_$n"], ["takes no parameters"]),
        (["geometry[0].material=$radius"], ["no material|is text"]),
        (["parameters.E={defalt: 1}"], ["did you mean 'default'"]),
        (["parameters.E={default: 1, kind: presure}"], ["did you mean 'pressure'"]),
        (["parameters.sin=3"], ["unknown parameter"]),
        (["geometry[0].radius=$"], ["geometry[0].radius", "a dollar sign is written $$"]),
    ],
)
def test_what_is_refused(overrides: list[str], words: list[str]) -> None:
    with pytest.raises(ScenarioError) as error:
        load_text(TEXT, overrides=overrides)
    for word in words:
        assert any(one in str(error.value) for one in word.split("|")), str(error.value)


def test_names_with_a_meaning_are_refused() -> None:
    for name in ("i", "pi", "sin", "1x"):
        with pytest.raises(ScenarioError, match=r"take another name|not a usable name"):
            load_text(f"parameters: {{{name}: 3}}\n" + SCENE)


def test_formulas_are_no_text() -> None:
    text = "parameters: {A: 1 s}\n" + SCENE + "output: {render: {color_by: $A}}\n"
    with pytest.raises(ScenarioError):
        load_text(text)
    found = load_text("description: costs $5 or $$\n" + SCENE).scenario
    assert found.description == "costs $5 or $$"


def test_dollar_signs_stay(folder: Folder) -> None:
    folder.write("a$b.csv", "0,0,0\n1,0,0\n")
    shape = "{shape: line, from: [0, 0, 0], to: [100 mm, 0, 0], nodes: 11}"
    text = SCENE.replace(shape, "{shape: csv, file: a$$b.csv}")
    scene = folder.load(text).scenario
    assert scene.geometry[0].generate.file == "a$b.csv"
    assert folder.load(dump_resolved(scene)).scenario == scene
    with pytest.raises(ScenarioError, match=r"a dollar sign is written \$\$"):
        folder.load(text.replace("$$", "$"))


def test_all_parameters_by_one_argument() -> None:
    found = load_text(TEXT, overrides=["parameters={E: 3 MPa, radius: 1 mm, n: 10}"])
    assert found.scenario.materials["silicone"].youngs_modulus == 3e6


def test_unused_parameters_are_told() -> None:
    warnings = load_text("parameters: {a: 1, b: $a}\n" + SCENE).warnings
    assert any("<text>:1:20: parameters.b: no value uses" in warning for warning in warnings)
    assert not any("parameters.a" in warning for warning in warnings)


def test_programs_are_told(folder: Folder, call: Call) -> None:
    folder.write("a.yaml", TEXT)
    explained = json.loads(call("explain", "a.yaml", "--json").stdout)
    assert explained["parameters.radius"] == {"value": 0.001, "unit": "m", "origin": "a.yaml:3:11"}
    assert "$radius" in explained["geometry[0].radius"]["origin"]
    assert "a.yaml:3:11" in explained["geometry[0].radius"]["origin"]
    (checked,) = json.loads(call("check", "a.yaml", "--json").stdout)
    assert checked["parameters"]["E"]["value"] == 2e6
    short = ("--set", "numerics.t_end=10 ms", "-o", "out", "--json")
    ran = json.loads(call("run", "a.yaml", *short).stdout)
    assert ran["parameters"] == checked["parameters"]
    manifest = json.loads((folder.path / "out" / "manifest.json").read_text())
    assert manifest["parameters"] == checked["parameters"]
