"""Scenarios that are no files: the same scenario, and faults that are told as well."""

from __future__ import annotations

import json
from collections import OrderedDict
from pathlib import Path

import numpy as np
import pytest
import yaml
from cli_process import EXPECT, SWING

from dismech_cli import load, load_mapping, load_text
from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.text.tree import MAX_DEPTH

TEXT = SWING + EXPECT
TOML = """\
schema_version = 1
name = "fall"
geometry = []
numerics = {dt = "2 s", t_end = "1 kg"}
"""


@pytest.fixture
def deck() -> dict:
    return yaml.safe_load(TEXT)


def test_file_text_and_mapping_are_the_same_scenario(tmp_path, deck):
    (tmp_path / "swing.yaml").write_text(TEXT)
    file = load(tmp_path / "swing.yaml", profile="draft", overrides=["numerics.t_end=1 s"])
    for other in (
        load_text(TEXT, profile="draft", overrides=["numerics.t_end=1 s"]),
        load_mapping(deck, profile="draft", overrides=["numerics.t_end=1 s"]),
        load_text(json.dumps(deck), profile="draft", overrides=["numerics.t_end=1 s"]),
    ):
        assert other.scenario == file.scenario
        assert other.text_hash == file.text_hash
        assert other.directory == Path.cwd()


def test_values_of_python_are_values_of_a_scenario(deck):
    expected = load_mapping(deck).scenario
    rod = OrderedDict(deck["geometry"][0], radius=np.float32(0.0009765625))
    rod["generate"] = {
        "shape": "line",
        "from": np.zeros(3),
        "to": (np.float64(0.1), 0, 0),
        "nodes": np.int64(11),
    }
    given = load_mapping(deck | {"geometry": (rod,), "dimension": np.array(2)}).scenario
    assert given.geometry[0].generate == expected.geometry[0].generate
    assert given.geometry[0].radius == 2.0**-10
    assert given.dimension == 2


def test_files_start_in_the_directory(tmp_path, deck):
    (tmp_path / "g.csv").write_text("t,g\n0,0\n1,-9.81\n")
    (tmp_path / "base.yaml").write_text(TEXT)
    law = {"table": {"file": Path("g.csv")}}
    deck["forces"] = [{"type": "gravity", "acceleration": [0, 0, law]}]
    assert load_mapping(deck, directory=tmp_path).directory == tmp_path
    short = "include: [base.yaml]\nschema_version: 1\nname: short\nnumerics: {dt: 1 ms}\n"
    for loaded in (
        load_text(short, directory=tmp_path),
        load_mapping(yaml.safe_load(short), directory=tmp_path),
    ):
        assert (loaded.scenario.name, loaded.scenario.numerics.dt) == ("short", 1e-3)
        assert loaded.provenance["numerics.t_end"].origin == f"{tmp_path}/base.yaml:16:29 (include)"
    with pytest.raises(ScenarioError, match=r"<mapping>: .*cannot open 'g.csv'"):
        load_mapping(deck, directory=tmp_path / "elsewhere")
    (tmp_path / "sub").mkdir()
    deck["forces"][0]["acceleration"][2]["table"]["file"] = "../g.csv"
    with pytest.raises(ScenarioError, match="outside the folder"):
        load_mapping(deck, directory=tmp_path / "sub")
    assert load_mapping(deck, directory=tmp_path / "sub", allow_outside=True)


def test_a_text_is_told_by_line_and_column():
    with pytest.raises(ScenarioError) as caught:
        load_text(TEXT.replace("density", "densty").replace("1 mm", "1 kg"))
    first, second = (line for line in str(caught.value).splitlines() if line.startswith("<text>"))
    assert first.startswith("<text>:5:57: materials.silicone.densty: unknown key; did you mean 'density'?")
    assert second.startswith("<text>:10:13: geometry[0].radius: expected a length")
    with pytest.raises(ScenarioError, match=r"<text>:4:33: numerics.t_end: expected a time"):
        load_text(TOML, format="toml")
    with pytest.raises(ScenarioError, match="unknown format 'xml': a scenario is 'yaml' or 'toml'"):
        load_text(TOML, format="xml")


def test_a_mapping_is_told_by_key_path(deck):
    deck["materials"]["silicone"]["densty"] = deck["materials"]["silicone"].pop("density")
    deck["geometry"][0]["radius"] = "1 kg"
    with pytest.raises(ScenarioError) as caught:
        load_mapping(deck)
    assert str(caught.value).splitlines() == [
        "<mapping>: materials.silicone.densty: unknown key; did you mean 'density'?",
        "<mapping>: geometry[0].radius: expected a length such as '1 m', got a mass, '1 kg'",
    ]


def test_places_and_origins_of_a_mapping(deck):
    loaded = load_mapping(deck, overrides=["numerics.dt=1 ms"])
    assert loaded.provenance["geometry[0].radius"].origin == "<mapping>"
    assert loaded.provenance["numerics.dt"].origin == "--set 'numerics.dt=1 ms'"
    assert loaded.provenance["numerics.newton.max_iterations"].origin == "default"
    error = loaded.error("geometry[0].radius", "too thin")
    assert str(error) == "<mapping>: geometry[0].radius: too thin"


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (float("nan"), "geometry[0].radius: expected a finite number, got nan"),
        (np.array([1.0, np.inf]), "geometry[0].radius[1]: expected a finite number, got inf"),
        (2**70, "geometry[0].radius: integer too large"),
        ({1e-3}, "geometry[0].radius: expected a number, text, a list or a mapping, got set"),
        (b"1 mm", "geometry[0].radius: expected a number, text, a list or a mapping, got bytes"),
        (1 + 1j, "geometry[0].radius: expected a number, text, a list or a mapping, got complex"),
        ({3: 1.0}, "geometry[0].radius: a key must be text, got 3"),
    ],
)
def test_what_no_text_could_hold_is_refused(deck, value, message):
    deck["geometry"][0]["radius"] = value
    with pytest.raises(ScenarioError) as caught:
        load_mapping(deck)
    assert str(caught.value) == f"<mapping>: {message}"


def test_a_mapping_that_holds_itself_is_refused(deck):
    deck["geometry"][0]["generate"] = deck
    with pytest.raises(ScenarioError, match=f"nested deeper than {MAX_DEPTH} levels"):
        load_mapping(deck)
