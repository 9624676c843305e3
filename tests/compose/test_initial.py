"""Runs that start from another state: from a run, a frame of it, or displaced."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import Deck, given_section, line, rod_deck, scalar
from numpy.testing import assert_allclose, assert_array_equal
from shell_decks import DOWN, SHEET, shell_deck

from dismech_cli import Limits, load, read, simulate
from dismech_cli.compose.initial.known import known_state
from dismech_cli.errors import ScenarioError
from dismech_cli.output.checkpoint import save
from dismech_cli.run.loop import End
from dismech_cli.scenario.language.initial import FromRun
from dismech_cli.session.narrator import Silent
from dismech_cli.session.pause import Pause
from dismech_cli.session.report import Report
from dismech_cli.session.resume import proceed

CURVED: Deck = {
    "shape": "helix",
    "origin": [0.0, 0.0, 0.0],
    "axis": [0.0, 0.0, 1.0],
    "radius": 0.2,
    "pitch": 0.3,
    "turns": 1.2,
    "handedness": "right",
    "nodes": 13,
}
UNEQUAL = given_section(bending_1=0.7, bending_2=1.9, torsion=0.4, axial=1e3, rotary_inertia=1e-2)
STATIC: Deck = {"integrator": {"type": "static", "load_steps": 4}, "newton": {"tolerance": 1e-11}}
ALL = Limits()
WEIGHT: Deck = {"type": "gravity", "acceleration": [0.0, 0.0, -1.5]}


def dynamic(t_end: float, dt: float = 0.01, integrator: str = "tr_bdf2") -> Deck:
    return {"integrator": {"type": integrator}, "dt": dt, "t_end": t_end, "newton": {"tolerance": 1e-11}}


def rod(**keys: Any) -> Deck:
    keys = {"motions": [{"type": "clamp", "where": "rod.start"}], "forces": [WEIGHT]} | keys
    return rod_deck(CURVED, UNEQUAL, dimension=3, **keys)


def ran(folder: Path, deck: Deck, out: str | None = None, limits: Limits = ALL) -> Report:
    file = folder / "scene.yaml"
    file.write_text(json.dumps(deck), encoding="utf-8")
    report = simulate(load(file), out=None if out is None else folder / out, limits=limits)
    assert report.outcome.end in (End.DONE, End.INTERRUPTED), report.message
    return report


def test_what_hangs_at_rest_stays_at_rest(tmp_path: Path) -> None:
    """Statics, then dynamics: the rest shape is kept, so the balance is too."""
    still = ran(tmp_path, rod(numerics=STATIC), "still")
    deck = rod(numerics=dynamic(0.3), initial={"run": "still"}, output={"every": 0.05})
    moving = ran(tmp_path, deck)
    first = moving.frames[0]
    assert_array_equal(first.positions, still.frames[-1].positions)
    assert_allclose(scalar(moving, "elastic")[0], scalar(still, "elastic")[-1], rtol=1e-12)
    for frame in moving.frames:
        assert_allclose(frame.positions, first.positions, rtol=0, atol=1e-8)
    assert scalar(moving, "kinetic").max() < 1e-14
    # rest shape and displacement are those of the scenario, not of the start
    assert_allclose(moving.composition.simulation.topology.rest_positions[-1], still.frames[0].positions[-1])


def test_shells_and_pulled_ends(tmp_path: Path) -> None:
    """Mid-edge normals and frames of a gripper that has turned are carried over, and it lets go."""
    turned: Deck = {
        "type": "clamp",
        "where": "sheet.right",
        "rotations": [{"axis": [1.0, 0.2, 0.0], "angle": {"ramp": {"from": 0, "to": 0.8, "end": 1}}}],
        "displacement": [-0.02, 0.0, 0.03],
    }
    left: Deck = {"type": "clamp", "where": "sheet.left"}
    deck = shell_deck(
        SHEET, body={"bending": "midedge"}, motions=[left, turned], forces=[DOWN], numerics=STATIC
    )
    still = ran(tmp_path, deck, "still")
    held = turned | {"rotations": [{"axis": [1.0, 0.2, 0.0], "angle": 0.8}]}
    again = deck | {"numerics": dynamic(0.02), "initial": {"run": "still"}, "motions": [left, held]}
    moving = ran(tmp_path, again)
    assert_allclose(moving.frames[-1].positions, still.frames[-1].positions, rtol=0, atol=1e-8)
    free = ran(tmp_path, again | {"motions": [left]})
    assert_array_equal(free.frames[0].positions, still.frames[-1].positions)
    assert_allclose(scalar(free, "elastic")[0], scalar(still, "elastic")[-1], rtol=1e-12)
    assert scalar(free, "kinetic")[-1] > 1e-6


@pytest.mark.parametrize("integrator", ["tr_bdf2", "newmark"])
def test_a_run_in_two_parts_is_one_run(tmp_path: Path, integrator: str) -> None:
    """From the end of the first, or from a frame of it by its directors: velocities go on."""
    output = {"every": 0.05, "fields": ["director"]}
    whole = ran(tmp_path, rod(numerics=dynamic(0.4, integrator=integrator), output=output), "whole")
    ran(tmp_path, rod(numerics=dynamic(0.2, integrator=integrator)), "half")
    for initial in ({"run": "half"}, {"run": "whole", "at": 0.2}, {"run": "whole", "frame": 4}):
        deck = rod(numerics=dynamic(0.2, integrator=integrator), initial=initial, output=output)
        second = ran(tmp_path, deck)
        # Newmark's accelerations ring on in one run and start consistent in the other
        atol = 1e-9 if integrator == "tr_bdf2" else 1e-4
        assert_allclose(second.frames[-1].positions, whole.frames[-1].positions, rtol=0, atol=atol)
        assert_allclose(second.frames[0].fields["director"], whole.frames[4].fields["director"], atol=1e-12)
        assert_allclose(scalar(second, "elastic")[0], scalar(whole, "elastic")[4], rtol=1e-9)
    deck = rod(numerics=dynamic(0.2), initial={"run": "half", "at_rest": True})
    assert_array_equal(ran(tmp_path, deck).frames[0].state["v"], 0.0)


def test_twist_of_many_turns_is_carried(tmp_path: Path) -> None:
    twist = {
        "type": "clamp",
        "where": "rod.end",
        "at": "edge",
        "twist": {"ramp": {"from": 0, "to": 20.0, "end": 1}},
    }
    stiff = given_section(bending_1=1e4, torsion=0.4, axial=1e6)
    start: Deck = {"type": "clamp", "where": "rod.start"}
    deck = rod_deck(
        line(9), stiff, dimension=3, motions=[start, twist], numerics=STATIC, output={"fields": ["director"]}
    )
    still = ran(tmp_path, deck, "still")
    energy = scalar(still, "elastic")[-1]
    # held edges are shorter by a half of one
    assert_allclose(energy, 0.5 * 0.4 * 20.0**2 / 0.9375, rtol=1e-9)
    for initial in ({"run": "still"}, {"run": "still", "at": 1.0}, {"run": "still", "frame": 4}):
        held = deck | {
            "motions": [start, twist | {"twist": 20.0}],
            "numerics": dynamic(0.02),
            "initial": initial,
        }
        assert_allclose(scalar(ran(tmp_path, held), "elastic"), energy, rtol=1e-9)
        # let go there
        loose = deck | {"motions": [start], "numerics": dynamic(0.02), "initial": initial}
        assert_allclose(scalar(ran(tmp_path, loose), "elastic")[0], energy, rtol=1e-9)


def test_a_resumed_run_needs_the_other_no_more(tmp_path: Path) -> None:
    """It keeps the state that it started from: resumed, it is the straight run, bit by bit."""
    ran(tmp_path, rod(numerics=STATIC), "still")
    deck = rod(numerics=dynamic(0.1), initial={"run": "still"}, forces=[], output={"every": 0.02})
    ran(tmp_path, deck, "straight")
    ran(tmp_path, deck, "stopped", Limits(until=0.05))
    shutil.rmtree(tmp_path / "still")
    proceed(tmp_path / "stopped", Pause(until=None, wall=None, checkpoint_every=60.0), Silent(), draw=False)
    with read(tmp_path / "straight") as one, read(tmp_path / "stopped") as two:
        assert len(one) == len(two) == 6
        for k in range(len(one)):
            assert_array_equal(one.state("q")[k], two.state("q")[k])
            assert_array_equal(one.state("v")[k], two.state("v")[k])
        digests = one.manifest.hashes
        assert digests[str(tmp_path / "still")] == two.manifest.hashes[str(tmp_path / "still")]
    # the copy stands for the run
    again = ran(tmp_path, deck | {"initial": {"run": "straight/inputs/initial-state.npz"}})
    with read(tmp_path / "straight") as one:
        assert_array_equal(again.frames[-1].state["q"], one.state("q")[5])


@pytest.mark.parametrize(
    ("deck", "initial", "message"),
    [
        (rod(), {"run": "nowhere"}, "initial.run: cannot open 'nowhere'"),
        (rod(), {"run": "."}, "is no run directory"),
        (rod(), {"run": "still", "at": 0.3}, "has no frame at 0.3; the nearest is at 0.25"),
        (rod(), {"run": "still", "frame": 9}, "has 5 frames, counted from 0"),
        (rod(), {"run": "still", "at": 0.25, "frame": 1}, "give 'at' or 'frame', not both"),
        (rod(), {"run": "still", "at": 0.25}, "its frames hold no directors of the rods"),
        (rod(), {"run": "still", "displacements": []}, "expected only one of"),
        (
            rod(rod={"name": "other"}, motions=[], forces=[WEIGHT]),
            {"run": "still"},
            "is a state of rod, but here are other",
        ),
        (
            rod(rod={"generate": CURVED | {"nodes": 14}}),
            {"run": "still"},
            "is a state of 13 nodes, but here are 14: take the same mesh",
        ),
        (
            rod(rod={"generate": CURVED | {"radius": 0.21}}),
            {"run": "still"},
            "is a state of another rest shape: node ",
        ),
        (
            rod(motions=[{"type": "clamp", "where": "rod.end"}]),
            {"run": "still"},
            "holds x of the wall of a clamp .* from where the run starts: it would leap there",
        ),
        (rod(), {"run": "stopped"}, "is not done but interrupted, at t = 0.05"),
    ],
)
def test_states_that_do_not_fit(tmp_path: Path, deck: Deck, initial: Deck, message: str) -> None:
    ran(tmp_path, rod(numerics=STATIC), "still")
    ran(tmp_path, rod(numerics=dynamic(0.1)), "stopped", Limits(until=0.05))
    with pytest.raises(ScenarioError, match=message):
        ran(tmp_path, deck | {"numerics": dynamic(0.1), "initial": initial})


def test_the_shipped_state_is_that_of_its_run(tmp_path: Path) -> None:
    shipped = Path(__file__).parents[2] / "scenarios"
    drawn = simulate(shipped / "drawn_rod.yaml")
    kept = known_state(shipped / "data" / "drawn_rod.npz", FromRun(run="data/drawn_rod.npz"))
    assert kept.t == 1.0
    assert_allclose(kept.q, drawn.frames[-1].state["q"], rtol=0, atol=1e-9)


def test_an_older_checkpoint_says_so(tmp_path: Path) -> None:
    save(tmp_path, {"state.q": np.zeros(3)}, {"numbers": {"state.t": 0.0}})
    with pytest.raises(ScenarioError, match="does not say what it is a state of: run the scenario again"):
        known_state(tmp_path / "checkpoint-000001.npz", FromRun(run="checkpoint-000001.npz"))


# ---------------------------------------------------------------- displacements


def test_a_plucked_beam(tmp_path: Path) -> None:
    """Released from its first mode: the energy of that shape, and a quarter of a period later none."""
    shape = {"expression": "1e-3*sin(pi*s)"}
    deck = rod_deck(
        line(61),
        motions=[
            {"type": "pin", "where": "rod.start"},
            {"type": "pin", "where": "rod.end", "components": ["z"]},
        ],
        initial={"displacements": [{"where": "rod", "displacement": [0.0, 0.0, shape]}]},
        numerics=dynamic(0.25 * 2.0 / np.pi, 0.25 * 2.0 / np.pi / 50),
        output={"every": 0.25 * 2.0 / np.pi},
    )
    result = ran(tmp_path, deck)
    # EI = m = L = 1: U = EI pi^4 a^2 / 4 L^3, period 2 / pi; the chord strains by 1e-6 of EA = 1e8
    bending = scalar(result, "elastic_bending")
    assert_allclose(bending[0], np.pi**4 * 1e-6 / 4.0, rtol=1e-3)


def test_displacements_from_a_file(tmp_path: Path) -> None:
    rows = np.zeros((9, 3))
    rows[:, 2] = np.linspace(0.0, 0.01, 9) ** 2
    np.savetxt(tmp_path / "d.csv", rows, delimiter=",")
    deck = rod_deck(
        line(9),
        motions=[],
        initial={"displacements": [{"where": "rod", "displacement": {"file": "d.csv"}}]},
        numerics=dynamic(0.02),
    )
    first = ran(tmp_path, deck, "kept").frames[0]
    assert_allclose(first.positions[:, 2], rows[:, 2], rtol=0, atol=1e-17)
    assert (tmp_path / "kept" / "inputs" / "d.csv").is_file()
    np.savetxt(tmp_path / "d.csv", rows[:5], delimiter=",")
    with pytest.raises(ScenarioError, match="the file has 5 rows for 9 selected nodes"):
        ran(tmp_path, deck)
    entry = {"where": "rod", "displacement": [0.0, 0.0, {"expression": "t"}]}
    with pytest.raises(ScenarioError, match="'t' has no meaning here"):
        ran(tmp_path, deck | {"initial": {"displacements": [entry]}})
    with pytest.raises(ScenarioError, match="out of the plane"):
        ran(tmp_path, deck | {"initial": {"displacements": [{"where": "rod", "displacement": [0, 1, 0]}]}})


def test_a_sheet_rolled_by_displacements(tmp_path: Path) -> None:
    """Onto a cylinder of radius 0.5: the energy of a plate so bent, whose normals follow its faces."""
    roll = [{"expression": "0.5*sin(2*x) - x"}, 0.0, {"expression": "0.5*(1 - cos(2*x))"}]
    deck = shell_deck(
        SHEET | {"divisions": 24},
        body={"bending": "midedge"},
        initial={"displacements": [{"where": "sheet", "displacement": roll}]},
    )
    result = ran(tmp_path, deck | {"numerics": dynamic(1e-4, 1e-4)})
    stiffness = 1e6 * 2e-3**3 / 12.0 / (1.0 - 0.3**2)
    assert_allclose(scalar(result, "elastic")[0], 0.5 * stiffness * 4.0 * 0.06, rtol=0.05)
