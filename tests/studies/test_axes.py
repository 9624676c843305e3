"""What a sweep varies, from the scenario and from the command line, counted before it is made."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from pydantic import ValidationError
from scenario_folder import SCENE, Folder, folder

from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.language.sweep import Sweep
from dismech_cli.studies.sweep.axes import latin_hypercube, rows, written
from dismech_cli.studies.sweep.given_axes import Given
from dismech_cli.studies.sweep.points import Base, points_of, shard

__all__ = ["folder"]


def axes(**data) -> Sweep:
    return Sweep.model_validate(data)


def test_a_grid_is_every_combination_and_the_last_axis_is_fastest():
    found = rows(axes(over={"a": [1, 2], "b": ["x", "y", "z"]}), Path())
    assert found == [(("a", str(a)), ("b", b)) for a in (1, 2) for b in "xyz"]


def test_blocks_multiply_and_zipped_lists_go_side_by_side():
    found = rows(axes(over={"a": [1, 2]}, zip={"b": [3, 4], "c": [5, 6]}), Path())
    assert found == [(("a", a), ("b", b), ("c", c)) for a in ("1", "2") for b, c in (("3", "5"), ("4", "6"))]


@pytest.mark.parametrize(
    ("span", "expected"),
    [
        ({"from": 1, "to": 2, "count": 3}, ["1", "1.5", "2"]),
        ({"from": 0.1, "to": 0.3, "count": 3}, ["0.1", "0.2", "0.3"]),
        ({"from": "1 kPa", "to": "1 MPa", "count": 2, "scale": "log"}, ["1 kPa", "1000 kPa"]),
        ({"from": "1 N", "to": "1 kN", "count": 3, "scale": "log"}, ["1 N", "31.6227766017 N", "1000 N"]),
        ({"from": -1e-3, "to": -10, "count": 5, "scale": "log"}, ["-0.001", "-0.01", "-0.1", "-1", "-10"]),
        ({"from": 11, "to": 41, "count": 4}, ["11", "21", "31", "41"]),
    ],
)  # fmt: skip
def test_a_span_holds_both_ends_in_the_unit_of_the_first(span, expected):
    assert [text for ((_, text),) in rows(axes(over={"a": span}), Path())] == expected


def test_each_slice_of_each_axis_of_a_hypercube_is_hit_once():
    count = 17
    points = latin_hypercube(count, 3, seed=5)
    assert_allclose(np.sort(np.floor(points * count), axis=0), np.arange(count)[:, None].repeat(3, 1), rtol=0)
    assert (points == latin_hypercube(count, 3, seed=5)).all()
    assert (points != latin_hypercube(count, 3, seed=6)).any()


def test_a_sampled_logarithm_is_even_in_factors():
    sample = {"count": 100, "over": {"a": {"from": 1, "to": 1e4, "scale": "log"}}}
    values = [float(text) for ((_, text),) in rows(axes(sample=sample), Path())]
    # a slice of a hundredth of four decades each
    assert_allclose(np.sort(np.floor(np.log10(values) * 25.0)), np.arange(100), rtol=0)


@pytest.mark.parametrize(
    "value", ["5 ms", "1e3", "yes", "a: b", "[x", 1e-5, 3, True, {"type": "tr_bdf2"}, [1, "a"]]
)
def test_a_value_reads_back_as_it_was(value):
    from dismech_cli.scenario.text.tree import Source
    from dismech_cli.scenario.text.yaml_text import parse_yaml

    read = parse_yaml(Source("", written(value))).plain()
    assert (list(read) if isinstance(read, tuple) else read) == value


def test_too_many_points_are_refused_before_they_are_made():
    huge = {"from": 0, "to": 1, "count": 10_000}
    with pytest.raises(ScenarioError, match=r"10000 x 10000 x 10000 = 1000000000000 points: at most 10000"):
        rows(axes(over={"a": huge, "b": huge, "c": huge}), Path())


@pytest.mark.parametrize(
    ("data", "told"),
    [
        ({}, "at least one of"),
        ({"over": {"a": []}}, "at least 1"),
        ({"over": {"a": {"from": "1 mm", "to": "2 MPa", "count": 2}}}, "measure different things"),
        ({"over": {"a": {"from": "1 mm", "to": 2, "count": 2}}}, "need a unit both"),
        ({"over": {"a": {"from": 0, "to": 2, "count": 2, "scale": "log"}}}, "two ends of one sign"),
        ({"over": {"a": {"from": 1, "to": 1, "count": 2}}}, "are the same"),
        ({"over": {"a": {"from": "x", "to": 1, "count": 2}}}, "expected a number or a quantity"),
        ({"zip": {"a": [1, 2], "b": [1]}}, "a has 2, b has 1"),
        ({"over": {"a": [1]}, "zip": {"a": [1]}}, "varied twice: a"),
    ],
)  # fmt: skip
def test_faults_of_the_section(data, told):
    with pytest.raises(ValidationError, match=told):
        axes(**data)


def test_a_fault_in_the_file_is_told_at_its_line(folder: Folder):
    text = SCENE + "sweep:\n  over:\n    numerics.dt: {from: 1 ms, to: 3 m, count: 2}\n"
    with pytest.raises(ScenarioError, match=r"scene.yaml:20:5: .*measure different things: ms and m"):
        folder.load(text)


def test_a_table_of_points(folder: Folder):
    folder.write("points.csv", "# made by hand\nnumerics.dt; numerics.t_end\n2 ms; 1\n\n'3 ms'; 2\n")
    found = rows(axes(csv="points.csv"), folder.path)
    assert found == [
        (("numerics.dt", "2 ms"), ("numerics.t_end", "1")),
        (("numerics.dt", "'3 ms'"), ("numerics.t_end", "2")),
    ]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("numerics.dt,numerics.t_end\n1,2\n3\n", r"points.csv:3: expected a value for each of numerics.dt"),
        ("numerics.dt\n", "a row for each point"),
        ("a\n" + "1\n" * 10_001, "10001 rows: at most 10000"),
    ],
)
def test_faults_of_a_table(folder: Folder, text, told):
    folder.write("points.csv", text)
    with pytest.raises(ScenarioError, match=told):
        rows(axes(csv="points.csv"), folder.path)


def test_the_command_line_says_the_same_as_the_section(tmp_path: Path):
    given = Given(
        over=["a=1 ms,2 ms", "b=1 kPa:1 MPa:4:log", "c={type: x},{type: y, z: [1, 2]}"],
        zip=["d=1,2", "e=3,4"],
        lhs=3,
        ranges=["f=0:1", "g=1 mm:2 mm:log"],
        seed=4,
    )
    section = axes(
        over={
            "a": ["1 ms", "2 ms"],
            "b": {"from": "1 kPa", "to": "1 MPa", "count": 4, "scale": "log"},
            "c": [{"type": "x"}, {"type": "y", "z": (1, 2)}],
        },
        zip={"d": [1, 2], "e": [3, 4]},
        sample={
            "count": 3,
            "over": {"f": {"from": "0", "to": "1"}, "g": {"from": "1 mm", "to": "2 mm", "scale": "log"}},
            "seed": 4,
        },
    )
    assert given.axes(tmp_path) == section
    assert Given().axes(tmp_path) is None


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"over": ["a"]}, "expected KEY=V1,V2"),
        ({"over": ["a=1", "a=2"]}, "a is given twice"),
        ({"over": ["a=1,,2"]}, "not valid YAML"),
        ({"over": ["a=1,~"]}, "with commas between"),
        ({"over": ["a=[1"]}, "--over 'a=\\[1'"),
        ({"over": ["a=1 mm:1 s:3"]}, "--over a: .*measure different things"),
        ({"lhs": 3}, "--lhs N and --range"),
        ({"ranges": ["a=1:2"]}, "--lhs N and --range"),
        ({"seed": 3}, "--seed is the seed"),
        ({"lhs": 2, "ranges": ["a=1"]}, "expected KEY=FROM:TO"),
    ],
)  # fmt: skip
def test_faults_of_the_command_line(tmp_path: Path, given, told):
    with pytest.raises(ScenarioError, match=told):
        Given(**given).axes(tmp_path)


@pytest.mark.parametrize("name", ["nowhere.csv", "/dev/zero", "."])
def test_what_is_no_table(folder: Folder, name):
    with pytest.raises(ScenarioError, match="expected a file"):
        rows(axes(csv=name), folder.path)


PARAMETRIC = "parameters: {E: {default: 2, unit: MPa}, unused: 1}\n" + SCENE.replace("2 MPa", "$E")


def points(folder: Folder, text: str = PARAMETRIC, **data):
    folder.write("scene.yaml", text)
    return points_of(Base(path=Path("scene.yaml")), axes(**data))


def test_a_span_of_a_parameter_keeps_its_unit(folder: Folder):
    """A bare number would be read in the unit of the parameter: 2e6 MPa."""
    found = points(folder, over={"parameters.E": {"from": "1 MPa", "to": "3 MPa", "count": 3}})
    assert [one.settings[0].value for one in found] == [1e6, 2e6, 3e6]
    assert {one.settings[0].unit for one in found} == {"Pa"}


def test_a_point_is_named_by_its_content(folder: Folder):
    (first,) = points(folder, over={"parameters.E": ["3 MPa"]})
    (same,) = points(folder, over={"materials.silicone.youngs_modulus": ["3000 kPa"]})
    (other,) = points(folder, over={"parameters.E": ["4 MPa"]})
    assert first.id == same.id != other.id


def test_a_point_is_another_when_a_file_that_it_names_changes(folder: Folder):
    text = PARAMETRIC.replace(
        "{type: gravity, acceleration: [0, 0, -9.81]}",
        "{type: gravity, acceleration: [0, 0, {table: {file: g.csv, time: 0, value: 1}}]}",
    )
    folder.write("g.csv", "0,0\n1,-9\n")
    before = points(folder, text, over={"parameters.E": ["3 MPa"]})
    (folder.path / "g.csv").write_text("0,0\n1,-8\n")
    from dismech_cli.studies.sweep.points import _digest

    _digest.cache_clear()  # a sweep is one process
    assert points(folder, text, over={"parameters.E": ["3 MPa"]}) != before


def test_the_section_is_no_part_of_what_is_run(folder: Folder):
    bare = folder.load(PARAMETRIC)
    swept = folder.load(PARAMETRIC + "sweep: {over: {parameters.E: [1, '2*$unused']}}\n")
    assert swept.text_hash == bare.text_hash
    # a formula is computed where the point sets it
    assert swept.scenario.sweep.over["parameters.E"] == (1, "2*$unused")


def test_what_nothing_uses_is_not_swept(folder: Folder):
    with pytest.raises(ScenarioError, match=r"two points are the same scenario: parameters\.unused=1 and"):
        points(folder, over={"parameters.unused": [1, 2]})


def test_every_point_is_read_before_any_runs(folder: Folder):
    with pytest.raises(ScenarioError) as error:
        points(folder, over={"geometry[0].generate.nodes": [11, 1, 21, 2.5], "numerics.dt": ["1 ms", "1 m"]})
    told = str(error.value)
    assert "must be at least 2, got 1" in told
    assert "expected a whole number, got 2.5" in told
    assert "got a length, '1 m'" in told


def test_a_key_is_not_both_set_and_varied(folder: Folder):
    folder.write("scene.yaml", PARAMETRIC)
    base = Base(path=Path("scene.yaml"), overrides=("numerics.dt=1 ms",))
    with pytest.raises(ScenarioError, match=r"--set numerics\.dt: it is varied"):
        points_of(base, axes(over={"numerics.dt": ["1 ms", "2 ms"]}))


def test_shards_are_disjoint_and_whole_and_keep_the_order(folder: Folder):
    found = points(folder, over={"parameters.E": list(range(1, 8))})
    parts = [shard(found, k, 3) for k in (1, 2, 3)]
    assert sorted(p.id for part in parts for p in part) == sorted(p.id for p in found)
    assert {len(part) for part in parts} == {2, 3}
    for part in parts:
        assert [found.index(p) for p in part] == sorted(found.index(p) for p in part)
