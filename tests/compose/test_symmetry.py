"""Planes of symmetry and loads along sides of shells, as a user writes them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.testing import assert_allclose
from shell_decks import DOWN, EULER, SHEET, STATIC, Deck, made, ran, refused, rod, shell_deck, write

from dismech_cli.mesh.generate.curved import cylinder
from dismech_cli.mesh.generate.sheets import Pattern
from dismech_cli.mesh.mesh import Mesh

__all__ = ["made", "ran", "refused", "write"]

STEPS: Deck = {"integrator": {"type": "static", "load_steps": 2}}
PATCH: Deck = {
    "shape": "cylinder",
    "origin": [0.0, 0.0, 0.0],
    "axis": [1.0, 0.0, 0.0],
    "start": [0.0, 0.0, 1.0],
    "radius": 0.1,
    "length": 0.15,
    "angle": "60 deg",
    "divisions": 5,
    "pattern": "right",
}


def mirrored(half: Mesh) -> Mesh:
    """Both halves, mirrored in z = 0; the second half's nodes follow those of the first."""
    inside = half.nodes[:, 2] > 0.0
    number = np.arange(len(half.nodes))
    number[inside] = len(half.nodes) + np.arange(inside.sum())
    nodes = np.concatenate((half.nodes, half.nodes[inside] * [1.0, 1.0, -1.0]))
    return Mesh(nodes=nodes, triangles=np.concatenate((half.triangles, number[half.triangles[:, [0, 2, 1]]])))


def text(mesh: Mesh) -> str:
    rows = [
        "*Nodes",
        *(", ".join(repr(float(x)) for x in node) for node in mesh.nodes),
        "*Triangles",
        *(", ".join(str(n + 1) for n in triangle) for triangle in mesh.triangles),
    ]
    return "\n".join(rows) + "\n"


def test_half_a_shell_is_half_of_the_whole(tmp_path: Path, ran: Any) -> None:
    """A curved panel under a large load: half of it in a plane of symmetry moves as in one piece."""
    half = cylinder(0.1, 0.1, np.pi / 2, 4, Pattern.RIGHT)
    (tmp_path / "half.txt").write_text(text(half))
    (tmp_path / "whole.txt").write_text(text(mirrored(half)))

    def bent(name: str, *motions: Deck) -> np.ndarray:
        deck = shell_deck(
            body={"mesh": {"file": f"{name}.txt"}},
            numerics=STEPS,
            motions=[{"type": "clamp", "where": foot}, *motions],
            forces=[{"type": "pressure", "shell": "sheet", "pressure": -5.0}],
        )
        del deck["geometry"][0]["generate"]
        return np.asarray(ran(deck).frames[-1].positions)

    foot = {"plane": {"point": [0, 0, 0], "normal": [0, 1, 0], "within": 1e-6}}
    middle = {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1], "within": 1e-6}}
    whole = bent("whole")
    part = bent("half", {"type": "symmetry", "where": middle, "normal": "z"})
    moved = np.abs(part - half.nodes).max()
    assert moved > 5e-3  # well over the thickness
    assert_allclose(part, whole[: len(part)], atol=1e-7 * moved)
    # held nodes alone would let the slope change
    loose = bent("half", {"type": "pin", "where": middle, "components": ["z"]})
    assert np.abs(loose - part).max() > 1e-3 * moved


def test_sides_that_meet_may_hold_a_corner_twice(made: Any, refused: Any) -> None:
    motions: list[Deck] = [
        {"type": "pin", "where": "sheet.left", "components": ["y", "z"]},
        {"type": "symmetry", "where": "sheet.right", "normal": "x"},
        {"type": "symmetry", "where": "sheet.bottom", "normal": "y"},
    ]
    model = made(shell_deck(PATCH | {"angle": "90 deg"}, motions=motions, numerics=STATIC)).simulation.model
    held = np.concatenate([motion.dofs for motion in model.motions])
    assert len(np.unique(held)) == len(held)
    moving = motions[0] | {"displacement": [0.0, 1e-3, 0.0]}
    assert "which motions[0] holds already" in refused(
        shell_deck(PATCH, motions=[moving, *motions[1:]], numerics=STATIC)
    )
    let_go = motions[0] | {"release": 0.01}
    assert "which motions[0] holds already" in refused(
        shell_deck(PATCH, motions=[let_go, *motions[1:]], numerics=EULER)
    )


def test_symmetry_refuses_what_it_cannot_mean(refused: Any) -> None:
    tilted = {"type": "symmetry", "where": "sheet.top", "normal": "z"}
    message = refused(shell_deck(PATCH | {"axis": [1, 0, 0.5]}, motions=[tilted]))
    assert "a plane of symmetry is flat" in message
    flat = {"type": "symmetry", "where": "sheet.left", "normal": "x"}
    for bending in ("hinge", "averaged"):
        message = refused(shell_deck(SHEET, body={"bending": bending}, motions=[flat]))
        assert "symmetry needs mid-edge normals" in message
    deck = shell_deck(SHEET, motions=[flat | {"where": "rod.start"}])
    deck["geometry"].append(rod([0, 0, 1], [0, 0, 2]))
    assert "symmetry is for shells" in refused(deck)


def test_line_loads_follow_the_length_of_the_side(made: Any, refused: Any) -> None:
    load = {"type": "line", "where": "sheet.right", "force_per_length": [0.0, 1.0, -3.0]}
    for pattern in ("right", "unstructured"):
        built = made(shell_deck(SHEET | {"pattern": pattern}, forces=[load]))
        nodes = built.geometry.nodes
        side = nodes[:, 0] == 0.3
        y, z = (term.force[: 3 * len(nodes)].reshape(-1, 3) for term in built.simulation.model.terms[-2:])
        assert_allclose(z[~side], 0.0)
        # A constant load per length: resultant and moment about the origin are those of a line.
        assert_allclose([y[:, 1].sum(), z[:, 2].sum(), z[:, 2] @ nodes[:, 1]], [0.2, 0.2, 0.2 * 0.1])
    single = load | {"where": {"nearest": [0, 0, 0]}}
    assert "selects no edge of a shell" in refused(shell_deck(SHEET, forces=[single]))


def test_curved_shells_stand_where_they_are_put(made: Any) -> None:
    """A tube along x and a zone about y, from the scenario to the mesh."""
    tube = PATCH | {"origin": [1.0, 0.0, 0.0], "angle": "360 deg", "divisions": 6}
    nodes = made(shell_deck(tube)).geometry.nodes
    assert_allclose(np.hypot(nodes[:, 1], nodes[:, 2]), 0.1, rtol=1e-14)
    assert_allclose([nodes[:, 0].min(), nodes[:, 0].max()], [1.0, 1.15], rtol=1e-15)
    zone = {
        "shape": "sphere",
        "center": [0.0, 0.0, 1.0],
        "axis": [0.0, 1.0, 0.0],
        "start": [0.0, 1.0, 1.0],  # made normal to the axis: z
        "radius": 2.0,
        "polar": ["30 deg", "90 deg"],
        "angle": "90 deg",
        "divisions": 4,
    }
    built = made(shell_deck(zone, forces=[DOWN]))
    x = built.geometry.nodes - [0.0, 0.0, 1.0]
    assert_allclose(np.linalg.norm(x, axis=1), 2.0, rtol=1e-14)
    assert_allclose(x[built.geometry.node_groups["sheet.bottom"], 0], 0.0, atol=1e-14)
    # right-handed about y from z: the last meridian goes to x
    top = x[built.geometry.node_groups["sheet.top"]]
    assert_allclose(top[:, 2], 0.0, atol=1e-14)
    assert (top[:, 0] > 0.9).all()


def test_angles_of_curved_shells_are_checked(refused: Any) -> None:
    assert "6.28319" in refused(shell_deck(PATCH | {"angle": "361 deg"}))
    zone = {
        "shape": "sphere",
        "center": [0, 0, 0],
        "radius": 1,
        "polar": ["90 deg", "18 deg"],
        "divisions": 4,
    }
    assert "polar angles of a sphere must increase" in refused(shell_deck(zone))
    assert "must not be parallel" in refused(shell_deck(PATCH | {"start": [2.0, 0.0, 0.0]}))
