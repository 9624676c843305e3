"""Two rods at an angle are the frame of beams that they are: second order at any angle."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import Deck, given_section, rod_deck, scalar, solve
from numpy.testing import assert_allclose
from scipy.linalg import expm

from dismech_cli.arrays import FloatArray

GJ = 0.8
AXIAL = 1e5
GAUSS = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)


def _space(dimension: int) -> Deck:
    return {"dimension": 3} if dimension == 3 else {"dimension": 2, "plane": "xy"}


def elbow(edges: int, turn: float, weld: bool, bending: tuple[float, float], **keys: Any) -> Deck:
    """Two rods of unit length, the second one turned; welded, or one rod with a kink."""
    second = [1.0 + np.cos(turn), np.sin(turn), 0.0]
    section = given_section(axial=AXIAL, bending_1=bending[0], bending_2=bending[1], torsion=GJ)
    points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], second]
    if weld:
        shapes = [
            {"shape": "line", "from": points[k], "to": points[k + 1], "nodes": edges + 1} for k in range(2)
        ]
    else:
        shapes = [{"shape": "polyline", "points": points, "nodes": 2 * edges + 1}]
    bodies = [
        {"type": "rod", "name": name, "material": "m", "generate": shape, "section": section}
        for name, shape in zip(("rod", "other"), shapes, strict=False)
    ]
    deck = rod_deck(
        shapes[0],
        geometry=bodies,
        joints=[{"type": "rigid", "nodes": ["rod.end", "other.start"]}] if weld else [],
        numerics={"integrator": {"type": "static", "load_steps": 1}, "newton": {"tolerance": 1e-12}},
        motions=[{"type": "clamp", "where": "rod.start"}],
        dimension=3,
    )
    deck |= keys
    return deck


def exact_work(turn: float, load: FloatArray, bending: tuple[float, float]) -> float:
    """Load times displacement of the tip by the theory of beams.

    Along x the first director is z, and stays so round a corner in the xy plane.
    """
    first, second = np.array([1.0, 0.0, 0.0]), np.array([np.cos(turn), np.sin(turn), 0.0])
    m1, work = np.array([0.0, 0.0, 1.0]), 0.0
    for start, tangent in ((np.zeros(3), first), (first, second)):
        m2 = np.cross(tangent, m1)
        for s in GAUSS:
            moment = np.cross(first + second - start - s * tangent, load)
            work += 0.5 * (moment @ tangent) ** 2 / GJ
            work += 0.5 * ((moment @ m2) ** 2 / bending[0] + (moment @ m1) ** 2 / bending[1])
        work += (load @ tangent) ** 2 / AXIAL
    return float(work)


def work_of(
    folder: Path, edges: int, turn: float, load: FloatArray, weld: bool, bending: tuple[float, float]
) -> float:
    tiny = 1e-6
    where = "other.end" if weld else "rod.end"
    deck = elbow(
        edges,
        turn,
        weld,
        bending,
        forces=[{"type": "point", "where": where, "force": (tiny * load).tolist()}],
    )
    frames = solve(folder, deck).frames
    moved = frames[-1].positions[-1] - frames[0].positions[-1]
    return float(load @ moved) / tiny


RIGHT, WIDE, SLIGHT = np.radians([90.0, 150.0, 10.0])
EQUAL, UNEQUAL = (1.0, 1.0), (1.0, 2.5)
ACROSS, OUT = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
# turn, load, stiffness, error of the work at 16 edges per rod
CASES = {
    "right": (RIGHT, np.array([-1.0, 0.0, 0.0]), EQUAL, 4.88e-4),
    "right-out": (RIGHT, OUT, EQUAL, 6.79e-4),
    "right-unequal": (RIGHT, np.array([0.3, 0.2, 1.0]), UNEQUAL, 6.87e-4),
    "wide": (WIDE, ACROSS, EQUAL, 2.44e-3),
    "wide-out": (WIDE, OUT, EQUAL, 1.51e-3),
    "slight": (SLIGHT, ACROSS, EQUAL, 4.9e-4),
}
KINKS = [name for name in CASES if name != "slight"]  # within one rod 10 degrees may be a curve


@pytest.mark.parametrize(
    ("name", "weld"), [*((name, True) for name in CASES), *((name, False) for name in KINKS)]
)
def test_work_converges_to_that_of_beams(tmp_path: Path, name: str, weld: bool) -> None:
    turn, load, bending, at_16 = CASES[name]
    exact = exact_work(turn, load, bending)
    errors = [work_of(tmp_path, n, turn, load, weld, bending) / exact - 1.0 for n in (8, 16, 32)]
    # the straight halves alone, discretized, make up all of it
    assert_allclose(errors[1], at_16, rtol=1e-2)
    assert (np.log2(np.array(errors[:2]) / errors[1:]) > 1.9).all()


@pytest.mark.parametrize("name", ["right", "wide", "slight"])
def test_a_plane_gives_what_space_gives(tmp_path: Path, name: str) -> None:
    turn, load, bending, _ = CASES[name]
    forces = [{"type": "point", "where": "other.end", "force": load.tolist()}]
    space, plane = (
        solve(tmp_path, elbow(8, turn, True, bending, forces=forces, **_space(dimension)))
        .frames[-1]
        .positions[-1]
        for dimension in (3, 2)
    )
    assert_allclose(plane, space, atol=1e-9)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize(
    ("turn", "load", "exact", "at_8"),
    [
        (RIGHT, [-1.0, 0.5, 0.0], [0.124706, 1.088083, 0.0], 1.63e-3),
        (WIDE, [0.0, -2.5, 0.0], [0.230820, -0.507904, 0.0], 4.4e-3),
    ],
)
def test_large_rotations_converge_to_the_elastica(
    tmp_path: Path, turn: float, load: list[float], exact: list[float], at_8: float, dimension: int
) -> None:
    errors = []
    for edges in (8, 16):
        deck = elbow(
            edges,
            turn,
            True,
            EQUAL,
            forces=[{"type": "point", "where": "other.end", "force": load}],
            numerics={"integrator": {"type": "static", "load_steps": 5}, "newton": {"tolerance": 1e-10}},
            **_space(dimension),
        )
        errors.append(float(np.linalg.norm(solve(tmp_path, deck).frames[-1].positions[-1] - exact)))
    assert errors[0] < 1.05 * at_8
    assert np.log2(errors[0] / errors[1]) > 1.9


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_rod_may_fold_back(tmp_path: Path, dimension: int) -> None:
    """By half a turn: a joint so bent has no curvature. The halves share no node."""
    x = np.concatenate((np.linspace(0.0, 1.0, 21), np.linspace(1.0, 0.46, 12)[1:]))
    nodes = "".join(f"{value}, 0, 0\n" for value in x)
    edges = "".join(f"{k}, {k + 1}\n" for k in range(1, len(x)))
    (tmp_path / "fold.txt").write_text(f"*Nodes\n{nodes}*Edges\n{edges}", encoding="utf-8")
    deck = rod_deck(
        {},
        rod={"mesh": {"file": "fold.txt"}},
        forces=[{"type": "point", "where": "rod.end", "force": [0.0, 0.3, 0.0]}],
        **_space(dimension),
    )
    del deck["geometry"][0]["generate"]
    moved = solve(tmp_path, deck).frames[-1].positions[-1]
    # by the theory of beams, with the tip beside 0.46 of the first half
    exact = 0.3 * (0.46**3 + 2.0 * 0.54**3) / 3.0
    assert_allclose(moved[1], exact, rtol=1e-2)


GROWN = [
    {"curvature_1": 0.6, "curvature_2": -0.5, "twist": 0.7},
    {"curvature_1": -0.4, "curvature_2": 0.8, "twist": 0.5},
]


def grown_end(forward: bool) -> FloatArray:
    """Tip of both rods grown by their natural strains, the angle between their frames kept.

    Frames (t, m1, m2) by rows turn by (twist, -curvature_2, curvature_1) along themselves.
    """
    way = 1.0 if forward else -1.0
    rest = [
        np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
        np.array([[0.0, way, 0.0], [0.0, 0.0, 1.0], [way, 0.0, 0.0]]),
    ]
    place, frame = np.zeros(3), rest[0]
    for natural, walk in zip(GROWN, (1.0, way), strict=True):
        k1, k2, tau = natural["curvature_1"], natural["curvature_2"], natural["twist"]
        turning = np.array([[0.0, k1, k2], [-k1, 0.0, tau], [-k2, -tau, 0.0]])
        moved = expm(walk * np.block([[np.zeros((1, 1)), np.eye(1, 3)], [np.zeros((3, 1)), turning]]))
        place, frame = place + moved[0, 1:] @ frame, moved[1:, 1:] @ frame
        frame = rest[1] @ rest[0].T @ frame
    return place


@pytest.mark.parametrize("forward", [True, False])
def test_rods_grow_on_both_sides_of_a_corner(tmp_path: Path, forward: bool) -> None:
    """Natural strains add to its angle, whichever way the rods are drawn."""
    errors = []
    for edges in (4, 8, 16):
        drives = [
            {"type": name, "rod": rod, "value": {"table": [[0.0, 0.0], [1.0, value]]}}
            for rod, natural in zip(("rod", "other"), GROWN, strict=True)
            for name, value in natural.items()
        ]
        deck = elbow(edges, RIGHT, True, (1.0, 1.7), actuation=drives)
        deck["numerics"]["integrator"]["load_steps"] = 5
        deck["output"] = {"probes": {"stored": {"energy": "elastic"}}}
        tip = -1
        if not forward:
            line = deck["geometry"][1]["generate"]
            line["from"], line["to"] = line["to"], line["from"]
            deck["joints"][0]["nodes"][1] = "other.end"
            tip = edges + 1
        result = solve(tmp_path, deck)
        assert scalar(result, "stored")[-1] < 1e-20
        errors.append(float(np.linalg.norm(result.frames[-1].positions[tip] - grown_end(forward))))
    assert errors[2] < 1e-3
    assert (np.log2(np.array(errors[:2]) / errors[1:]) > 1.9).all()


def test_given_strains_are_those_that_an_actuation_adds(tmp_path: Path) -> None:
    """One rod with a kink: the list counts the kink among its joints."""
    values = [0.1 * k for k in range(7)]
    bent = [{"table": [[0.0, 0.0], [1.0, value]]} for value in values]
    given, driven = elbow(4, RIGHT, False, EQUAL), elbow(4, RIGHT, False, EQUAL)
    driven["actuation"] = [
        {"type": "curvature_1", "rod": "rod", "joints": [k, k], "value": law} for k, law in enumerate(bent)
    ]
    given["geometry"][0]["natural"] = {"curvature_1": values}
    here, there = (solve(tmp_path, deck).frames[-1].positions for deck in (given, driven))
    assert_allclose(here, there, atol=1e-9)
    assert np.linalg.norm(here[-1] - [1.0, 1.0, 0.0]) > 0.1


def test_fields_at_a_corner(tmp_path: Path) -> None:
    """What bends it is reported, not its angle: the moment of beams there, and curvature M/EI."""
    forces = [{"type": "point", "where": "other.end", "force": [-1e-6, 0.0, 0.0]}]
    for dimension in (2, 3):
        deck = elbow(8, RIGHT, True, EQUAL, forces=forces, **_space(dimension))
        deck["output"] = {"fields": ["curvature", "bending_moment", "twist"][:dimension]}
        fields = solve(tmp_path, deck).frames[-1].fields
        assert_allclose(fields["bending_moment" if dimension == 3 else "curvature"][8], 1e-6, rtol=1e-3)
        if dimension == 3:
            assert_allclose(fields["curvature"][8], 1e-6, rtol=1e-3)
            assert_allclose(fields["twist"], 0.0, atol=1e-12)


def test_a_swinging_frame_keeps_its_energy(tmp_path: Path) -> None:
    """Its corner books as bending; midpoint keeps the account to its second order."""
    deck = elbow(
        6,
        RIGHT,
        True,
        UNEQUAL,
        forces=[{"type": "gravity", "acceleration": [0.5, -0.3, -1.0]}],
        numerics={"integrator": {"type": "implicit_midpoint"}, "t_end": 1.0, "dt": 5e-3},
        output={"every": 0.05},
    )
    result = solve(tmp_path, deck)
    kinetic, error = scalar(result, "kinetic"), scalar(result, "error")
    assert kinetic.max() > 1e-2
    assert np.abs(error).max() < 1e-3 * kinetic.max()
    assert {"elastic_bending", "elastic_twist", "elastic_stretch"} == {
        name for name in result.frames[-1].scalars if name.startswith("elastic_")
    }
