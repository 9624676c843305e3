"""Two runs compared: known differences, where and when they are, and what cannot be compared."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from cli_call import call
from cli_process import swing
from numpy.testing import assert_allclose

from dismech_cli.cli.result_schema import COMPARE
from dismech_cli.errors import ScenarioError
from dismech_cli.output.manifest import load_manifest
from dismech_cli.studies.compare.compare import compare
from dismech_cli.studies.compare.tolerances import Tolerance, tolerances

__all__ = ["call", "swing"]

SHORT = ("--set", "numerics.t_end=0.02 s", "--no-render", "-q")


@pytest.fixture
def runs(call, swing: Path) -> tuple[Path, Path]:
    """A run and its copy."""
    assert call("run", "swing.yaml", "-o", "a", *SHORT).code == 0
    shutil.copytree(swing / "a", swing / "b")
    return swing / "a", swing / "b"


def test_a_run_is_equal_to_itself(call, runs):
    done = call("compare", *runs, "--json")
    assert done.code == 0
    told = COMPARE.validate_python(json.loads(done.stdout))
    assert told.times == 11
    assert {one.name for one in told.differences} >= {"positions", "velocity", "kinetic", "tip"}
    assert {one.greatest for one in told.differences} == {0.0}


def test_a_moved_node_is_found_with_its_place_and_time(runs):
    a, b = runs
    with h5py.File(b / "run.vtkhdf", "r+") as file:
        points = file["VTKHDF/Points"]
        nodes = 11
        points[4 * nodes + 7] += np.array([3e-5, 0.0, 4e-5])
    found = {one.found.name: one for one in compare(a, b, ()).differences}
    moved = found.pop("positions").found
    assert_allclose(moved.greatest, 5e-5, rtol=1e-3)  # stored in single precision or better
    assert_allclose(moved.rms, 5e-5 / np.sqrt(11 * nodes), rtol=1e-3)
    assert_allclose(moved.scale, 0.1)
    assert_allclose(moved.t, 4 * 2e-3, rtol=1e-12)
    assert moved.place.startswith("beam, node 7, at rest (0.07, 0, 0)")
    assert all(one.within for one in found.values())
    assert compare(a, b, ("positions=1 um",)).code == 4
    assert compare(a, b, ("positions=51 um",)).code == 0
    assert compare(a, b, ("4e-4",)).code == 4
    assert compare(a, b, ("6e-4",)).code == 0


def test_a_number_that_is_none_is_a_difference(runs):
    a, b = runs
    with h5py.File(b / "run.vtkhdf", "r+") as file:
        file["VTKHDF/Points"][40] = np.nan
    compared = compare(a, b, ("1e9",))
    (over,) = (one for one in compared.differences if not one.within)
    assert over.found.name == "positions"
    assert over.found.greatest == np.inf
    shutil.rmtree(a)
    shutil.copytree(b, a)
    assert compare(a, b, ()).code == 0


def test_a_twist_that_no_position_shows_is_a_difference(call, runs, swing: Path):
    rod = ("--set", "dimension=3", "--set", "geometry[0].bending=framed", *SHORT)
    assert call("run", "swing.yaml", "-o", "c", *rod).code == 0
    shutil.copytree(swing / "c", swing / "d")
    with h5py.File(swing / "d" / "run.vtkhdf", "r+") as file:
        file["dismech/state/q"][-1, -1] += 0.5
        last = file["dismech/state/q"].shape[1] - 1
    (over,) = (one for one in compare(swing / "c", swing / "d", ("1e-9",)).differences if not one.within)
    assert (over.found.name, over.found.unit) == ("q", "m, rad")
    assert_allclose(over.found.greatest, 0.5)
    assert over.found.place == f"degree of freedom {last}"


def test_a_probe_of_one_name_that_measures_something_else_is_told(runs):
    a, b = runs
    table = (b / "scalars.csv").read_text()
    (b / "scalars.csv").write_text(table.replace("tip [m]", "tip [rad]"))
    compared = compare(a, b, ("1",))
    assert compared.code == 4
    assert "tip is in m in" in compared.faults[0]


def test_another_load_changes_what_it_should(call, runs, swing: Path):
    load = "forces[0].acceleration=[0, 0, -9.80]"
    assert call("run", "swing.yaml", "-o", "c", *SHORT, "--set", load).code == 0
    found = {one.found.name: one for one in compare(runs[0], swing / "c", ("2e-3",)).differences}
    # free fall for a start: proportional to gravity
    assert_allclose(found["tip"].relative, 0.01 / 9.81, rtol=0.05)
    assert found["tip"].found.place == ""
    assert compare(runs[0], swing / "c", ("5e-4",)).code == 4


def test_a_run_that_ended_elsewhere_is_different_whatever_is_allowed(call, runs, swing: Path):
    assert call("run", "swing.yaml", "-o", "c", *SHORT, "--until", "0.01 s").code == 0
    done = call("compare", runs[0], swing / "c", "--tol", "1e9", "--json")
    assert done.code == 4
    assert "ends at t = 0.02 s" in done.stderr
    assert "6 times are shared by 11 and 6 frames" in done.stderr
    assert len(COMPARE.validate_python(json.loads(done.stdout)).errors) == 2


def test_runs_that_do_not_correspond_are_refused(call, runs, swing: Path):
    assert call("run", "swing.yaml", "-o", "c", *SHORT, "--set", "geometry[0].generate.nodes=12").code == 0
    done = call("compare", runs[0], swing / "c")
    assert done.code == 2
    assert "11 and 12 nodes" in done.stderr
    (runs[1] / "scalars.csv").write_text("t [s],tip [m]\n1,2\n")
    (runs[1] / "run.vtkhdf").unlink()
    done = call("compare", *runs)
    assert done.code == 2
    assert "share no time" in done.stderr


def test_without_frames_scalars_are_compared(runs):
    a, b = runs
    (b / "run.vtkhdf").unlink()
    compared = compare(a, b, ())
    assert compared.code == 0
    assert "scalars alone" in compared.notes[0]
    assert "positions" not in {one.found.name for one in compared.differences}


UNITS = {"positions": "m", "tip": "m", "ratio": "1"}


def test_later_tolerances_win():
    given = tolerances(["1e-3", "tip=1 um", "positions=2 %"], UNITS)
    assert given == {
        "ratio": Tolerance(1e-3),
        "tip": Tolerance(1e-6, "absolute"),
        "positions": Tolerance(0.02),
    }


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("tipp=1", "did you mean 'tip'"),
        ("tip=1 s", "expected a length"),
        ("1 mm", "expected"),
        ("-1", "must not be negative"),
        ("tip=-1 mm", "must not be negative"),
    ],
)
def test_what_is_no_tolerance(text, told):
    with pytest.raises(ScenarioError, match=told):
        tolerances([text], UNITS)


def test_other_kernels_are_told(runs):
    """They explain last digits that differ; the runs are none the less the same."""
    a, b = runs
    assert compare(a, b, ()).notes == ()
    manifest = load_manifest(b)
    assert manifest.kernels == "numpy"
    replace(manifest, kernels="numba").save(b)
    compared = compare(a, b, ())
    (note,) = compared.notes
    assert "kernels by numpy in" in note
    assert compared.code == 0
