"""`dismech study` from the command line: what it finds, what it writes, what it refuses."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cli_call import Call, call
from decks import Deck, given_section, line, rod_deck

__all__ = ["call"]

# A cantilever let go, whose first swing takes a second.
DECK: Deck = rod_deck(
    line(9),
    given_section(axial=400.0, bending_1=0.5),
    motions=[{"type": "clamp", "where": "rod.start", "at": "node"}],
    forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -1.0]}],
    numerics={"dt": 0.02, "t_end": 0.6},
    output={"probes": {"tip": {"displacement": "rod.end", "component": "z"}}},
)
STEPS = ("--over", "numerics.dt=0.06 s:5")
MESH = ("--over", "geometry[0].generate.nodes=5:3")


def _scene(folder: Path, deck: Deck = DECK) -> Path:
    file = folder / "scene.yaml"
    file.write_text(json.dumps(deck), encoding="utf-8")
    return file


def _studied(call: Call, folder: Path, *options: str, deck: Deck = DECK) -> tuple[int, dict[str, Any]]:
    result = call("study", str(_scene(folder, deck)), "--json", "-q", "-o", str(folder / "out"), *options)
    return result.code, json.loads(result.stdout)


def test_the_answer_keeps_its_target(call: Call, tmp_path: Path) -> None:
    """Against a run that is 16 times finer in time and twice in the mesh."""
    code, found = _studied(call, tmp_path, *STEPS, *MESH, "--target", "3%")
    assert code == 0
    assert found["meets"]
    assert found["runs"] < found["combinations"]
    from dismech_cli import simulate

    fine = ["numerics.dt=1 ms", "geometry[0].generate.nodes=33"]
    ours, right = (simulate(tmp_path / "scene.yaml", overrides=one) for one in (found["set"], fine))
    # whatever steps were chosen, at their times
    tips = np.interp(ours.scalars["t"], right.scalars["t"], right.probes["tip"])
    assert np.abs(ours.probes["tip"] - tips).max() < 0.03 * np.ptp(right.probes["tip"])


def test_files_say_the_same(call: Call, tmp_path: Path) -> None:
    _, found = _studied(call, tmp_path, *STEPS, "--over", "numerics.integrator=tr_bdf2,implicit_euler")
    out = tmp_path / "out"
    assert json.loads((out / "study.json").read_text()) == found
    rows = list(csv.DictReader(io.StringIO((out / "study.csv").read_text())))
    assert len(rows) == len(found["points"])
    page = (out / "study.html").read_text()
    assert "<svg" in page
    assert "http://" not in page.replace("http://www.w3.org", "")
    assert len(page) < 1_000_000
    assert found["message"] in (out / "study.md").read_text()
    euler = [one for one in found["points"] if "implicit_euler" in one["settings"]["numerics.integrator"]]
    assert 0 < len(euler) < 5


def test_the_scenario_may_say_what_is_tried(call: Call, tmp_path: Path) -> None:
    study = {
        "quantities": {"end": {"probe": "tip", "norm": "last"}},
        "over": {"numerics.step.rtol": {"from": 1e-2, "levels": 4, "factor": 4}},
        "target": "5 %",
    }
    numerics = {"t_end": 0.6, "step": {"adaptive": True}}
    code, found = _studied(call, tmp_path, deck=DECK | {"study": study, "numerics": numerics})
    assert code == 0
    assert all("numerics.step.rtol" in one["settings"] for one in found["points"])
    assert found["quantities"]["end"]["norm"] == "last"


def test_statics_are_refined_too(call: Call, tmp_path: Path) -> None:
    """A linear cantilever under its weight sags by rho g l^4 / (8 EI): a known value."""
    deck = DECK | {
        "forces": [{"type": "gravity", "acceleration": [0.0, 0.0, -1e-3]}],
        "numerics": {"integrator": {"type": "static", "load_steps": 2}},
        "study": {
            "quantities": {"sag": {"probe": "tip", "norm": "last", "value": -2.5e-4}},
            "over": {"geometry[0].generate.nodes": {"from": 5, "levels": 4}},
            "target": "1 %",
        },
    }
    code, found = _studied(call, tmp_path, deck=deck)
    assert code == 0
    # m l^3 / 8 EI by n edges is 1 + O(1/n^2) of that
    assert found["points"][0]["error"] is not None


def test_an_unreachable_target_is_exit_4(call: Call, tmp_path: Path) -> None:
    code, found = _studied(call, tmp_path, "--over", "numerics.dt=0.06 s:3", "--target", "1e-6")
    assert code == 4
    assert not found["set"]
    assert found["message"].endswith("add a level; levels are added by --over 'numerics.dt=0.06 s:5'")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--target", "150%"], "expected a share between 0 and 100 %"),
        (["--over", "numerics.dt"], "expected KEY=FROM:LEVELS or KEY=A,B"),
        (["--over", "numerics.dt=1 ms:40"], "less than or equal to 12"),
        (["--over", "numerics.dt=1 ms:3", "--over", "numerics.step.rtol=1e-2:3"], "both refine time"),
        (["--over", "numerics.td=1 ms:3"], "numerics.td: unknown key"),
        (["--quantity", "top"], "no probe 'top' in output.probes"),
        (["--quantity", "tip:sum"], "--quantity"),
        (["--quantity", "shape:last"], "of the shape there is 'max' and 'rms', no 'last'"),
        (["--quantity", "shape", *MESH], "the shapes of different meshes cannot be compared: name probes"),
        (["--reference", "best"], "--reference"),
        (["--set", "numerics.dt=5 ms", "--over", "numerics.dt=10 ms:3"], "the study tries its values"),
    ],
)
def test_what_makes_no_sense_is_refused(call: Call, tmp_path: Path, options: list[str], message: str) -> None:
    result = call("study", str(_scene(tmp_path)), "-o", str(tmp_path / "out"), *options)
    assert result.code == 2
    assert message in result.stderr


def test_what_does_not_move_is_refused(call: Call, tmp_path: Path) -> None:
    deck = DECK | {"output": {"probes": {"root": {"displacement": "rod.start", "component": "z"}}}}
    result = call("study", str(_scene(tmp_path, deck)), "-o", str(tmp_path / "out"))
    assert result.code == 2
    assert "root does not change in the run" in result.stderr


def test_what_was_not_refined_is_told(call: Call, tmp_path: Path) -> None:
    """An error of steps alone is no error of the scene."""
    _, found = _studied(call, tmp_path, *STEPS, "--target", "5%")
    assert found["not_refined"] == ["mesh"]
    assert "mesh not known, none finer was tried" in found["message"]


def test_without_probes_the_shape_counts(call: Call, tmp_path: Path) -> None:
    """Root mean square over the nodes, against a run of 16 times the steps."""
    deck = {key: value for key, value in DECK.items() if key != "output"} | {"output": {"every": 0.06}}
    code, found = _studied(call, tmp_path, *STEPS, "--target", "3%", deck=deck)
    assert code == 0
    assert found["quantities"]["shape"]["probe"] == "shape"
    from dismech_cli import simulate

    fine, answer = (
        np.array([frame.positions for frame in simulate(deck, overrides=one).frames])
        for one in (["numerics.dt=1 ms"], [*found["set"], "output.every=0.06 s"])
    )
    if len(fine) == len(answer):
        size = np.sqrt(((fine - fine[0]) ** 2).sum(axis=2).mean(axis=1)).max()
        off = np.sqrt(((answer - fine) ** 2).sum(axis=2).mean(axis=1)).max()
        assert off < 0.03 * size


def test_errors_may_be_distances_from_the_finest_run(call: Call, tmp_path: Path) -> None:
    code, found = _studied(call, tmp_path, *STEPS, "--target", "3%", "--reference", "finest", "--all")
    assert code == 0
    assert found["reference"] == "finest"
    errors = {one["settings"]["numerics.dt"]: one["error"] for one in found["points"]}
    assert errors["0.00375 s"] is None
    from dismech_cli import simulate

    tips = [
        simulate(DECK, overrides=[f"numerics.dt={dt} s", "output.every=0.015 s"]).probes["tip"]
        for dt in (0.015, 0.00375)
    ]
    # ranges are those of the first run of the study
    assert errors["0.015 s"] == pytest.approx(abs(tips[0] - tips[1]).max() / np.ptp(tips[1]), rel=0.1)


def test_the_finest_run_meets_no_target(call: Call, tmp_path: Path) -> None:
    code, found = _studied(
        call, tmp_path, "--over", "numerics.dt=0.06 s:3", "--target", "1e-6", "--reference", "finest"
    )
    assert code == 4
    assert "only the finest run is left, from which errors are measured: add a level" in found["message"]


def test_memory_is_in_the_table(call: Call, tmp_path: Path) -> None:
    _, found = _studied(call, tmp_path, *STEPS)
    memory = [one["memory [MB]"] for one in found["points"]]
    # imports alone take tens of megabytes; where the system does not tell, there is none
    assert all(one is None or 20 < one < 4000 for one in memory)


def test_an_answer_that_is_doubtful_says_why(call: Call, tmp_path: Path) -> None:
    """A rod that its weight stretches by a quarter, beyond what its linear law is good for."""
    soft = given_section(axial=0.04, bending_1=0.5)
    down = [{"type": "gravity", "acceleration": [1.0, 0.0, 0.0]}]
    deck = DECK | rod_deck(line(9), soft, **{key: DECK[key] for key in ("motions", "numerics", "output")})
    over = ("--over", "numerics.dt=0.02 s:3", "--target", "50%", "--quantity", "shape")
    code, found = _studied(call, tmp_path, *over, deck=deck | {"forces": down})
    assert code == 0
    assert all(one["doubts"] for one in found["points"])
    assert f"that run is doubtful: {found['points'][0]['doubts'][0]}" in found["message"]
