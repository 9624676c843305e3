"""``dismech calibrate``: what it recovers, what it says it cannot, and how it reads measurements."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from cli_call import call
from slope_cases import ALPHA, CLAMP, DOWN, STATIC, arm, scene

from dismech_cli import simulate
from dismech_cli.cli.result_schema import CALIBRATION, Calibration
from dismech_cli.scenario.load import load_mapping

__all__ = ["call"]

SCENES = Path(__file__).parents[2] / "scenarios"
E, RHO = "materials.rubber.youngs_modulus", "materials.rubber.density"
Deck = dict[str, Any]


def write(deck: Deck) -> str:
    path = Path("scene.yaml")
    path.write_text(json.dumps(deck))
    return str(path)


def fitted(done: Any, code: int = 0) -> dict[str, Any]:
    assert done.code == code, done.stderr
    result: dict[str, Any] = json.loads(done.stdout)
    assert isinstance(CALIBRATION.validate_python(result), Calibration)
    return result


def hanging(**keys: Any) -> Deck:
    """An arm that sags at rest."""
    return scene(dimension=2, geometry=[arm(11)], numerics=STATIC) | keys


def shape(deck: Deck, *overrides: str) -> np.ndarray:
    """Where its nodes come to rest or are at the end, shape (N, 3)."""
    return simulate(load_mapping(deck, overrides=list(overrides))).positions


def columns(path: str, names: list[str], rows: np.ndarray) -> None:
    lines = [",".join(names), *(",".join(f"{x:.12g}" for x in row) for row in rows)]
    Path(path).write_text("\n".join(lines))


@pytest.mark.slow
def test_two_values_of_a_swinging_arm_are_recovered(call):
    # of the shipped scene with its true bending: 1 MPa and 0.3 Pa s, 4 mm of noise
    true = "actuation[0].value.table=[[0, 0], [0.2, 4], [0.4, -3], [0.6, 5], [0.8, 0], [1, -4]]"
    two = "calibrate.fit=[{of: parameters.E, scale: log}, {of: parameters.drag, scale: log}]"
    start = ("parameters.E=2 MPa", "parameters.drag=0.6 Pa*s")
    sets = [word for text in (true, two, *start) for word in ("--set", text)]
    found = fitted(
        call("calibrate", SCENES / "measured_arm.yaml", *sets, "-o", "fit", "--no-dt-check", "--json", "-q")
    )
    for one, wanted in zip(found["parameters"], (1e6, 0.3), strict=True):
        assert abs(one["value"] - wanted) < 3.0 * one["deviation"]
        assert one["deviation"] < 0.02 * wanted
    # 776 samples: chi2/dof is 1 within 4 sqrt(2 / 776)
    assert found["chi2"] == pytest.approx(1.0, abs=0.2)
    assert found["data"][0]["samples"] == 776
    assert found["data"][0]["held_out_rms"] == pytest.approx(4.0, rel=0.2)
    assert found["runs"] <= 8
    # what is there is not run again
    again = fitted(
        call("calibrate", SCENES / "measured_arm.yaml", *sets, "-o", "fit", "--no-dt-check", "--json", "-q")
    )
    assert again["runs"] == 0
    assert again["parameters"] == found["parameters"]
    page = (Path("fit") / "report.html").read_text()
    assert page.count("<svg") + page.count("<img") == 1
    assert not re.findall(r"""(?:src|href)\s*=\s*["'](?!data:|#)|url\(\s*["']?(?!data:|#)|@import""", page)
    assert len(page.encode()) < 1_000_000
    assert "held out" in page
    assert (Path("fit") / "report.md").read_text().startswith("# Calibration of measured_arm.yaml")
    values = simulate("fit/fitted.yaml", overrides=["calibrate=null"]).composition
    stretch = values.simulation.model.terms[0]
    assert stretch.parameter("EA")[0] == pytest.approx(
        found["parameters"][0]["value"] * np.pi * 5e-3**2, rel=1e-9
    )


@pytest.mark.slow
def test_stiffness_drag_and_a_table_of_bends_are_recovered(call):
    """All eight values of the shipped scene, of data with noise of one percent of the range."""
    knots = "actuation[0].value.table=[[0, 1], [0.2, 1], [0.4, 1], [0.6, 1], [0.8, 1], [1, 1]]"
    start = ("parameters.E=2 MPa", "parameters.drag=0.5 Pa*s", knots)
    sets = [word for text in start for word in ("--set", text)]
    found = fitted(
        call("calibrate", SCENES / "measured_arm.yaml", *sets, "-o", "fit", "--no-dt-check", "--json", "-q")
    )
    wanted = (1e6, 0.3, 0.0, 4.0, -3.0, 5.0, 0.0, -4.0)
    for one, value in zip(found["parameters"], wanted, strict=True):
        assert abs(one["value"] - value) < 3.0 * one["deviation"], one
    for one in found["parameters"][:2]:
        assert one["deviation"] < 0.02 * one["value"]
    assert found["chi2"] == pytest.approx(1.0, abs=0.2)
    # by differences each evaluation would take a run, and two more for each of eight values
    assert found["evaluations"] * 9 >= 5 * found["runs"]


def test_the_natural_curvature_of_a_rod_that_rests_in_an_arc(call):
    # in balance EI (kappa - natural) is the moment of the weight beyond: both are known of the arc
    nodes, length, radius = 9, 0.3, 5e-3
    turn = 0.2 * np.pi
    angle = np.linspace(0.0, turn, nodes)
    r = length / turn
    points = r * np.column_stack([np.sin(angle), 1.0 - np.cos(angle)])
    columns("arc.csv", ["x", "z"], 1e3 * points[1:])
    deck = hanging(geometry=[arm(nodes, natural={"curvature_1": [0.0] * (nodes - 2)})])
    deck["materials"]["rubber"] = dict(deck["materials"]["rubber"], youngs_modulus=1e7)
    deck["calibrate"] = {
        "fit": [{"of": "geometry[0].natural.curvature_1[*]"}],
        "data": [
            {
                "file": "arc.csv",
                "unit": "mm",
                "deviation": 0.1,
                "markers": {"of": "arm", "nodes": list(range(1, nodes)), "columns": {"x": "x", "z": "z"}},
            }
        ],
    }
    found = fitted(call("calibrate", write(deck), "-o", "fit", "--json", "-q"))
    assert found["data"][0]["rms"] < 1e-3 * 1e3 * length
    s = np.linspace(0.0, length, nodes)[1:-1]
    weight = 1000.0 * 9.81 * np.pi * radius**2
    # of what lies beyond s: weight times the lever of its centroid
    beyond = r**2 * (np.cos(s / r) - np.cos(turn)) - r * np.sin(s / r) * (length - s)
    theory = 1.0 / r + weight * beyond / (1e7 * np.pi * radius**4 / 4.0)
    values = np.array([one["value"] for one in found["parameters"]])
    # a polygon against an arc: the square of an edge over the radius, and stretch; the wall has no curvature
    # to give, for which the first joints make up
    assert values[3:] == pytest.approx(theory[3:], rel=0.01)


def weighed(fit: list[Deck], **data: Any) -> Deck:
    deck = hanging(output={"probes": {"tip": {"position": "arm.end", "component": "z"}}})
    columns("tip.csv", ["t", "z"], np.array([[1.0, 1e3 * shape(deck)[-1, 2]]]))
    table = {"file": "tip.csv", "unit": "mm", "deviation": 0.1, "probes": {"tip": "z"}, "time": "t"} | data
    return deck | {"calibrate": {"fit": fit, "data": [table]}}


@pytest.mark.slow
def test_what_the_samples_do_not_see_is_said(call):
    # at rest the weight over the stiffness alone counts
    deck = weighed([{"of": E, "scale": "log"}, {"of": RHO, "scale": "log"}])
    done = call("calibrate", write(deck), "-o", "fit", "--set", f"{E}=1.2e6", "--json", "-q")
    found = fitted(done)
    assert len(found["unseen"]) == 1
    assert abs(np.dot(found["unseen"][0], [1.0, 1.0])) == pytest.approx(np.sqrt(2.0), rel=1e-3)
    assert f"do not see changes of {E}" in done.stderr


def test_bounds_and_what_was_known_are_flagged(call):
    deck = weighed([{"of": E, "scale": "log", "min": "1.1 MPa", "max": "2 MPa"}])
    done = call("calibrate", write(deck), "-o", "fit", "--set", f"{E}=1.5e6", "--json", "-q")
    assert fitted(done)["parameters"][0]["at_bound"]
    assert "stopped at a bound" in done.stderr
    deck = weighed([{"of": E, "scale": "log", "deviation": 0.05}])
    done = call("calibrate", write(deck), "-o", "prior", "--set", f"{E}=1.5e6", "--json", "-q")
    assert fitted(done)["parameters"][0]["moved_far"]
    assert "more than 3 deviations" in done.stderr


def test_gaps_units_and_hdf5(call):
    deck = scene(dimension=2, geometry=[arm(7)], motions=[CLAMP], forces=[DOWN], numerics=ALPHA)
    frames = simulate(load_mapping(deck | {"output": {"every": 0.015}})).frames[1:]
    t = np.array([frame.t for frame in frames])
    z = np.array([frame.positions[[3, 6], 2] for frame in frames])
    rows = np.column_stack((1e3 * t, 1e2 * z))
    columns("z.csv", ["t", "z_0", "z_1"], rows)
    text = Path("z.csv").read_text().split("\n")
    text[3] = ",".join([text[3].split(",")[0], "", "nan"])
    Path("z.csv").write_text("\n".join(text))
    with h5py.File("z.h5", "w") as h5:
        rows[2, 1:] = np.nan
        for k, name in enumerate(("t", "z_0", "z_1")):
            h5[name] = rows[:, k]
    results = []
    for file in ("z.csv", "z.h5"):
        table = {"file": file, "time": "t", "time_unit": "ms", "unit": "cm", "deviation": 0.1}
        table["markers"] = {"of": "arm", "arc": [0.15, 0.3], "columns": {"z": "z_{i}"}}
        whole = deck | {"calibrate": {"fit": [{"of": E, "scale": "log"}], "data": [table]}}
        arguments = ("--set", f"{E}=1.3e6", "--no-dt-check", "--json", "-q")
        results.append(fitted(call("calibrate", write(whole), "-o", file + ".fit", *arguments)))
    one, other = results
    assert one["data"][0]["samples"] == 2 * (len(t) - 1)
    assert one["parameters"][0]["value"] == pytest.approx(1e6, rel=1e-6)
    assert one["parameters"][0]["value"] == pytest.approx(other["parameters"][0]["value"], rel=1e-9)


def test_a_camera_is_found_with_the_value(call):
    deck = hanging()
    x = shape(deck)[1:, [0, 2]]
    turn, scale = 0.1, 2000.0
    a, b = x.T
    across = scale * (np.cos(turn) * a - np.sin(turn) * b) + 300.0
    down = -scale * (np.sin(turn) * a + np.cos(turn) * b) + 200.0
    columns("seen.csv", ["u", "v"], np.column_stack((across, down)))
    deck["calibrate"] = {
        "fit": [{"of": E, "scale": "log"}],
        "data": [
            {
                "file": "seen.csv",
                "unit": "1",
                "deviation": 0.5,
                "markers": {
                    "of": "arm",
                    "nodes": list(range(1, 11)),
                    "columns": {"x": "u", "z": "v"},
                    "camera": True,
                },
            }
        ],
    }
    found = fitted(call("calibrate", write(deck), "-o", "fit", "--set", f"{E}=1.5e6", "--json", "-q"))
    assert found["parameters"][0]["value"] == pytest.approx(1e6, rel=1e-4)
    camera = [scale * np.cos(turn), scale * np.sin(turn), 300.0, 200.0]
    assert found["cameras"][0] == pytest.approx(camera, rel=1e-3)


def test_a_marker_that_is_kept_out_is_predicted(call):
    deck = hanging()
    points = 1e3 * shape(deck)[1:, [0, 2]]
    points[-1] += [3.0, -4.0]  # 5 mm off, for all that the fit knows
    columns("seen.csv", ["x", "z"], points)
    markers = {"of": "arm", "nodes": list(range(1, 11)), "columns": {"x": "x", "z": "z"}, "first": 1}
    table = {"file": "seen.csv", "unit": "mm", "deviation": 1.0, "markers": markers | {"predicted": [10]}}
    deck["calibrate"] = {"fit": [{"of": E, "scale": "log"}], "data": [table]}
    sets = ("--set", f"{E}=1.5e6")
    found = fitted(call("calibrate", write(deck), "-o", "fit", *sets, "--json", "-q"))
    assert found["parameters"][0]["value"] == pytest.approx(1e6, rel=1e-6)
    (data,) = found["data"]
    assert data["samples"] == 18
    last = data["parts"][-1]
    assert last["name"] == "marker 10"
    assert last["mean"] is None
    assert last["held_out_mean"] == pytest.approx(5.0, rel=1e-4)
    assert data["held_out_rms"] == pytest.approx(np.sqrt(12.5), rel=1e-4)
    assert data["parts"][0]["mean"] < 1e-3
    told = call("calibrate", write(deck), "-o", "fit", *sets, "-q").stdout
    assert re.search(r"^marker 10 +5 mm +5 mm$", told, re.MULTILINE)
    markers["predicted"] = [11]
    deck["calibrate"]["data"][0]["markers"] = markers
    refused = call("calibrate", write(deck), "-o", "fit", "-q")
    assert refused.code == 2
    assert "markers are numbered from 1 to 10; there is no 11" in refused.stderr


def test_one_sample_far_off_counts_little_when_robust(call):
    deck = hanging()
    points = 1e3 * shape(deck)[1:, [0, 2]]
    points[5, 1] += 80.0
    columns("seen.csv", ["x", "z"], points)
    table = {"file": "seen.csv", "unit": "mm", "deviation": 1.0}
    table["markers"] = {"of": "arm", "nodes": list(range(1, 11)), "columns": {"x": "x", "z": "z"}}
    values = {}
    for robust in (False, True):
        deck["calibrate"] = {"fit": [{"of": E, "scale": "log"}], "data": [table], "robust": robust}
        done = call("calibrate", write(deck), "-o", f"fit{robust}", "--json", "-q")
        values[robust] = abs(np.log(fitted(done)["parameters"][0]["value"] / 1e6))
    assert values[True] < 0.2 * values[False]


def test_a_scene_with_contact_is_fitted_by_runs_and_said_so(call):
    deck = hanging()
    deck["obstacles"] = [{"type": "plane", "name": "floor", "point": [0, 0, -0.08], "normal": [0, 0, 1]}]
    deck["contact"] = {"pairs": [{"between": ["arm", "floor"]}]}
    columns("seen.csv", ["x", "z"], 1e3 * shape(deck)[1:, [0, 2]])
    table = {"file": "seen.csv", "unit": "mm", "deviation": 0.1}
    table["markers"] = {"of": "arm", "nodes": list(range(1, 11)), "columns": {"x": "x", "z": "z"}}
    deck["calibrate"] = {"fit": [{"of": E, "scale": "log"}], "data": [table]}
    done = call("calibrate", write(deck), "-o", "fit", "--set", f"{E}=1.3e6", "--json")
    assert "gradients by differences of runs here: the stiffness of contact changes" in done.stderr
    assert fitted(done)["parameters"][0]["value"] == pytest.approx(1e6, rel=1e-3)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"unit": "kg"}, None),
        ({"file": "nowhere.csv"}, "cannot open"),
        ({"probes": {"tpi": "z"}}, "did you mean 'tip'"),
        ({"probes": {"tip": "zz"}}, "has no column 'zz'"),
        ({"time_unit": "mm"}, "unit of time"),
        ({"before": 0.5}, "no sample"),
        ({"probes": None}, "exactly one of"),
    ],
)
def test_what_cannot_be_fitted_is_refused(call, change, words):
    deck = weighed([{"of": E}], **change)
    done = call("calibrate", write(deck), "-o", "fit", "--json", "-q")
    assert done.code == 2
    assert words is None or words in done.stderr


@pytest.mark.parametrize(
    ("fit", "words"),
    [
        ({"of": "materials.rubber.nothing"}, "no value of the scenario"),
        ({"of": E, "min": 2e6}, "not between its bounds"),
        ({"of": E, "max": "2 furlongs"}, "unknown unit"),
        ({"of": "forces[0].acceleration[2]", "scale": "log"}, "above zero"),
        ({"of": "geometry[0].generate.nodes"}, "whole number"),
    ],
)
def test_what_cannot_vary_is_refused_at_its_line(call, fit, words):
    done = call("calibrate", write(weighed([fit])), "-o", "fit", "-q")
    assert done.code == 2
    assert words in done.stderr
    assert "calibrate.fit[0]" in done.stderr


def test_a_scene_without_a_fit(call):
    done = call("calibrate", write(hanging()), "-q")
    assert done.code == 2
    assert "has no 'calibrate'" in done.stderr
