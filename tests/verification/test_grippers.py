"""Rotated ends: nothing is strained by turning as a whole, and what is turned against something twists."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import Deck, attempt, given_section, line, rod_deck, scalar, solve
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation
from shell_decks import SHEET, shell_deck

from dismech_cli.errors import ScenarioError
from dismech_cli.run.loop import End
from dismech_cli.session.report import Report

SKEW = [0.3, -0.5, 0.8]
CENTRE = [0.2, 0.1, -0.4]
TURN = 2.0 * np.pi


def turned(angle: Any, axis: list[float] | None = None, center: list[float] | None = None) -> Deck:
    """A rotation; a number of turns grows with the load."""
    rotation: Deck = {"axis": axis or [1.0, 0.0, 0.0], "angle": angle}
    return rotation if center is None else rotation | {"center": center}


def clamp(where: Any, *rotations: Deck, **keys: Any) -> Deck:
    return {"type": "clamp", "where": where, "rotations": list(rotations)} | keys


def static(steps: int) -> Deck:
    return {"integrator": {"type": "static", "load_steps": steps}, "newton": {"tolerance": 1e-12}}


def strips(result: Report) -> list[Any]:
    return [frame.fields["director"] for frame in result.frames]


HELIX: Deck = {
    "shape": "helix",
    "origin": [0.0, 0.0, 0.0],
    "axis": [0.0, 0.0, 1.0],
    "radius": 0.2,
    "pitch": 0.3,
    "turns": 1.2,
    "handedness": "right",
    "nodes": 13,
}
UNEQUAL = given_section(bending_1=0.7, bending_2=1.9, torsion=0.4, axial=1e3)


@pytest.mark.parametrize("where", ["rod", {"nodes": {"of": "rod", "range": [0, 9]}}], ids=["all", "most"])
def test_a_rod_turned_as_a_whole_is_not_strained(tmp_path: Path, where: Any) -> None:
    """Three turns about a skew axis, then two about another: to 1e-12, held or dragged along."""
    rotations = [turned(3 * TURN, SKEW, CENTRE), turned(2 * TURN, [1.0, 1.0, 0.0])]
    deck = rod_deck(
        HELIX,
        UNEQUAL,
        dimension=3,
        motions=[clamp(where, *rotations, displacement=[0.3, 0.0, -0.7])],
        numerics=static(97),
        output={"fields": ["director", "curvature", "axial_strain", "twist"]},
    )
    result = solve(tmp_path, deck)
    first = result.frames[0].fields
    for frame in result.frames[1:]:
        for name in ("axial_strain", "curvature", "twist"):
            assert_allclose(
                frame.fields[name], first[name], rtol=0, atol=1e-11 if name != "axial_strain" else 1e-12
            )
        one = Rotation.from_rotvec(3 * TURN * frame.t * np.array(SKEW) / np.linalg.norm(SKEW))
        two = Rotation.from_rotvec(2 * TURN * frame.t * np.array([1.0, 1.0, 0.0]) / np.sqrt(2.0))
        assert_allclose(frame.fields["director"], (two * one).apply(first["director"]), rtol=0, atol=1e-10)
    energy = scalar(result, "elastic")
    assert_allclose(energy, 0.0, atol=1e-20)


@pytest.mark.parametrize("turns", [0.25, 3, -5])
@pytest.mark.parametrize("at", ["node", "edge"])
def test_torque_of_turns(tmp_path: Path, turns: float, at: str) -> None:
    """GJ phi / L, read from the energy: U = GJ phi^2 / 2 L. The frame keeps count of the turns."""
    deck = rod_deck(
        line(11),
        given_section(bending_1=1e4, torsion=0.3, axial=1e6),
        dimension=3,
        motions=[
            {"type": "clamp", "where": "rod.start", "at": at},
            clamp("rod.end", turned(turns * TURN), at=at),
        ],
        numerics=static(24),
    )
    result = solve(tmp_path, deck)
    # half an edge less at either end where edges are held
    length = 1.0 if at == "node" else 0.9
    expected = 0.5 * 0.3 * (turns * TURN * np.array([frame.t for frame in result.frames])) ** 2 / length
    assert_allclose(scalar(result, "elastic"), expected, rtol=1e-9, atol=1e-12)
    # rho of the external work: what the gripper puts in is stored, by the trapezoidal rule exactly
    assert_allclose(scalar(result, "external_work")[-1], expected[-1], rtol=1e-9)


@pytest.mark.parametrize("axis", [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
def test_force_and_moment_of_a_turned_end(tmp_path: Path, axis: list[float]) -> None:
    """A beam held at both ends, one turned across it by a small angle: 6 EI phi / L^2 and 4 EI phi / L.

    The moment is read from the work, U = M phi / 2; both converge at second order.
    """
    angle, stiffness = 1e-3, 0.7 if axis[1] else 1.9
    misses = []
    for nodes in (21, 41):
        deck = rod_deck(
            line(nodes),
            UNEQUAL,
            dimension=3,
            motions=[{"type": "clamp", "where": "rod.start"}, clamp("rod.end", turned(angle, axis))],
            numerics=static(2),
            output={"probes": {"force": {"reaction": "rod.end", "component": "magnitude"}}},
        )
        result = solve(tmp_path, deck)
        force, moment = scalar(result, "force")[-1], 2.0 * scalar(result, "elastic")[-1] / angle
        work = scalar(result, "external_work")[-1]
        assert work == pytest.approx(0.5 * moment * angle, rel=1e-5)
        misses.append(
            (abs(force / (6.0 * stiffness * angle) - 1.0), abs(moment / (4.0 * stiffness * angle) - 1.0))
        )
    assert max(misses[1]) < 2e-3
    assert (np.array(misses[1]) < 0.3 * np.array(misses[0])).all()


def test_rotation_and_twist_along_the_rod_are_one(tmp_path: Path) -> None:
    """A turn about the rod's axis is a twist of the clamp, in time as well."""
    numerics = {"integrator": {"type": "tr_bdf2"}, "dt": 0.01, "t_end": 0.5}
    law = {"expression": "7*t + 3*t**2"}
    frames = []
    for motion in (
        clamp("rod.start", turned(law)),
        {"type": "clamp", "where": "rod.start", "twist": law},
    ):
        deck = rod_deck(
            line(9),
            UNEQUAL,
            dimension=3,
            motions=[motion],
            forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -0.2]}],
            numerics=numerics,
            output={"fields": ["director"]},
        )
        frames.append(solve(tmp_path, deck).frames[-1])
    assert_allclose(frames[0].positions, frames[1].positions, rtol=0, atol=1e-9)
    assert_allclose(frames[0].fields["director"], frames[1].fields["director"], rtol=0, atol=1e-9)


@pytest.mark.parametrize("integrator", ["tr_bdf2", "newmark"])
def test_two_grippers_carry_a_rod(tmp_path: Path, integrator: str) -> None:
    """Both ends on one rigid path: the rod follows, and their work closes the account in time."""
    path = [
        turned({"expression": "3*t**2"}, SKEW, CENTRE),
        turned({"expression": "sin(2*t)"}, [0.0, 1.0, 0.0], CENTRE),
    ]
    shift = [{"expression": "0.4*t**2"}, 0.0, {"expression": "0.1*t"}]
    motions = [clamp(end, *path, displacement=shift) for end in ("rod.start", "rod.end")]
    deck = rod_deck(HELIX, UNEQUAL, dimension=3, motions=motions, numerics=static(10))
    assert_allclose(scalar(solve(tmp_path, deck), "elastic"), 0.0, atol=1e-16)
    errors = []
    for dt in (0.004, 0.002):
        numerics = {
            "integrator": {"type": integrator},
            "dt": dt,
            "t_end": 0.8,
            "newton": {"tolerance": 1e-10},
        }
        result = solve(tmp_path, deck | {"numerics": numerics})
        errors.append(np.abs(scalar(result, "error")).max() / scalar(result, "kinetic").max())
        assert scalar(result, "external_work").max() > 0.1
    # second order, from a jerk at the start
    assert errors[1] < 4e-3
    assert errors[1] < 0.45 * errors[0]


def test_rotations_go_in_order_and_the_displacement_after_them(tmp_path: Path) -> None:
    quarter = 0.25 * TURN
    rotations = [
        turned(quarter, [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]),
        turned(quarter, [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
    ]
    deck = rod_deck(
        line(9, (1.0, 0.2, 0.1)),
        UNEQUAL,
        dimension=3,
        motions=[clamp("rod.start", *rotations, displacement=[0.5, 0.0, 0.0], at="edge")],
        numerics=static(8),
        output={"fields": ["director"]},
    )
    result = solve(tmp_path, deck)
    first, last = result.frames[0], result.frames[-1]
    # x to y to z: the tip (1, 0.2, 0.1) goes to (-0.2, 1, 0.1), then to (-0.2, -0.1, 1)
    assert_allclose(last.positions[-1], [0.3, -0.1, 1.0], atol=1e-9)
    assert_allclose(last.fields["director"], first.fields["director"][:, [1, 2, 0]] * [-1, -1, 1], atol=1e-9)


# a rim of hinges would be a hinge
@pytest.mark.parametrize(
    ("bending", "where"), [("midedge", "sheet.left"), ("midedge", "sheet"), ("hinge", "sheet")]
)
def test_a_shell_turned_as_a_whole_is_not_strained(tmp_path: Path, bending: str, where: str) -> None:
    deck = shell_deck(
        SHEET,
        body={"bending": bending},
        motions=[
            clamp(where, turned(2 * TURN, SKEW), turned(-3.0, [0.0, 1.0, 0.0]), displacement=[0.1, 0.0, 0.2])
        ],
        numerics=static(40),
    )
    result = solve(tmp_path, deck)
    last, first = result.frames[-1].positions, result.frames[0].positions
    assert_allclose(
        np.linalg.norm(last[:, None] - last, axis=2),
        np.linalg.norm(first[:, None] - first, axis=2),
        atol=1e-8,
    )
    assert np.abs(last - first).max() > 0.1
    assert_allclose(scalar(result, "elastic"), 0.0, atol=1e-14)


def test_a_pinned_ring_turns_in_its_plane(tmp_path: Path) -> None:
    """In a planar scene about its normal, y of the xz plane: x goes to -z."""
    deck = rod_deck(
        line(9),
        motions=[
            {
                "type": "pin",
                "where": "rod",
                "rotations": [turned(0.25 * TURN, [0.0, 2.0, 0.0], [0.0, 0.0, 0.0])],
            }
        ],
        numerics=static(4),
    )
    last = solve(tmp_path, deck).frames[-1].positions
    assert_allclose(last[:, 2], -np.linspace(0.0, 1.0, 9), atol=1e-15)
    assert_allclose(last[:, 0], 0.0, atol=1e-15)


def test_a_leap_is_refused(tmp_path: Path) -> None:
    deck = rod_deck(
        line(9), UNEQUAL, dimension=3, motions=[clamp("rod.start", turned(TURN))], numerics=static(2)
    )
    result = attempt(tmp_path, deck)
    assert result.outcome.end is End.FAILED
    assert "motions[0] turns by 3.14 rad in one step, from t = 0 to 0.5" in result.outcome.message
    assert "load_steps" in result.outcome.message


@pytest.mark.parametrize(
    ("dimension", "motion", "message"),
    [
        (2, clamp("rod.start", turned(1.0)), "turns out of the plane of the scene: take the axis along y"),
        (
            3,
            {"type": "pin", "where": "rod.start", "components": ["x", "z"], "rotations": [turned(1.0)]},
            "rotations move what is held in every direction; 'y' is free here",
        ),
        (3, clamp("rod.start", turned({"expression": "1 + t"})), "is 1 rad at the start"),
        (3, clamp("rod.start", turned(1.0, [0.0, 0.0, 0.0])), "a direction must not be zero"),
        (3, clamp("rod.start", turned("1 m")), "expected an angle"),
    ],
)
def test_rotations_that_are_refused(tmp_path: Path, dimension: int, motion: Deck, message: str) -> None:
    with pytest.raises(ScenarioError, match=message.replace("+", r"\+")):
        attempt(tmp_path, rod_deck(line(9), UNEQUAL, dimension=dimension, motions=[motion]))


# ---------------------------------------------------------------- displacements from place to place


def test_a_wave_travels_along_an_edge(tmp_path: Path) -> None:
    wave = {"expression": "0.01*smoothstep(10*t)*sin(20*y - 30*t)"}
    deck = shell_deck(
        SHEET,
        motions=[{"type": "pin", "where": "sheet.left", "displacement": [0.0, 0.0, wave]}],
        numerics={"integrator": {"type": "tr_bdf2"}, "dt": 0.01, "t_end": 0.2},
        output={"fields": ["velocity"]},
    )
    result = solve(tmp_path, deck)
    first, last = result.frames[0].positions, result.frames[-1].positions
    left = first[:, 0] == 0.0
    assert left.sum() > 3
    expected = 0.01 * np.sin(20 * first[left, 1] - 30 * 0.2)
    assert_allclose(last[left, 2], expected, rtol=0, atol=1e-15)
    # the speed of a held node is its mean over the last stage, less than a step
    speed = -0.3 * np.cos(20 * first[left, 1] - 30 * 0.197)
    assert_allclose(result.frames[-1].fields["velocity"][left, 2], speed, rtol=0, atol=0.3 * 30 * 0.003)


def test_displacement_along_a_rod(tmp_path: Path) -> None:
    """An affine map of all nodes, by s and by x: the one strain everywhere."""
    along = {"expression": "0.1*t*s"}
    across = {"expression": "0.2*t*x"}
    deck = rod_deck(
        line(9, (0.5, 0.0, 0.0)),
        motions=[{"type": "pin", "where": "rod", "displacement": [along, 0.0, across]}],
    )
    last = solve(tmp_path, deck).frames[-1].positions
    x = np.linspace(0.0, 0.5, 9)
    assert_allclose(last, np.stack((1.2 * x, 0 * x, 0.2 * x), axis=1), atol=1e-15)


def test_places_that_do_not_exist(tmp_path: Path) -> None:
    moved = [{"expression": "s*t"}, 0.0, 0.0]
    deck = shell_deck(SHEET, motions=[{"type": "pin", "where": "sheet.left", "displacement": moved}])
    with pytest.raises(ScenarioError, match=r"motions\[0\].displacement\[0\]: 's' goes along a rod"):
        attempt(tmp_path, deck)
    deck["motions"][0]["displacement"][0] = {"expression": "r*t"}
    deck["motions"][0]["displacement"][0] = {"expression": "t + 1/x"}
    with pytest.raises(
        ScenarioError, match=r"displacement\[0\]: the expression 't \+ 1/x' has no finite value"
    ):
        attempt(tmp_path, deck)
    deck["motions"][0]["displacement"][0] = {"expression": "r*t"}
    with pytest.raises(ScenarioError, match="'r' has no meaning here; known: 't', 's', 'x', 'y' or 'z'"):
        attempt(tmp_path, deck)
