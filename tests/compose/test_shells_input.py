"""Shells from YAML text: how they are placed, and what is planned, doubted and refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from shell_decks import BELL, EULER, MIXED, SHEET, STATIC, Deck, made, refused, shell_deck, write

from dismech_cli import load
from dismech_cli.compose.structure.doubts import unevenness
from dismech_cli.mesh.generate.sheets import Pattern, sheet
from dismech_cli.mesh.measure import edge_lengths
from dismech_cli.mesh.topology.shells import shell_edges

__all__ = ["made", "refused", "write"]


@pytest.mark.parametrize(
    ("normal", "apex"), [([0, 0, 1], [1, 2, 3.1]), ([0, 0, -2], [1, 2, 2.9]), ([3, 0, 4], [1.06, 2, 3.08])]
)
def test_hemispheres_point_along_their_axis(made: Any, normal: list[float], apex: list[float]) -> None:
    surface = BELL | {"center": [1.0, 2.0, 3.0], "axis": [float(x) for x in normal]}
    geometry = made(shell_deck(surface)).geometry
    assert_allclose(geometry.nodes[geometry.node_groups["sheet.apex"]], [apex], atol=1e-15)
    assert_allclose(np.linalg.norm(geometry.nodes - [1.0, 2.0, 3.0], axis=1), 0.1, rtol=1e-14)
    x = geometry.nodes[geometry.triangles]
    outward = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    assert ((x.mean(axis=1) - [1.0, 2.0, 3.0]) * outward).sum(axis=1).min() > 0.0


def test_sheets_span_their_axes(made: Any) -> None:
    surface = SHEET | {"origin": [1.0, 0.0, 0.0], "axes": [[0.0, 2.0, 0.0], [0.0, 1.0, 1.0]]}
    geometry = made(shell_deck(surface)).geometry
    right, top = (geometry.nodes[geometry.node_groups[f"sheet.{side}"]] for side in ("right", "top"))
    assert_allclose(right[:, 1], 0.3, atol=1e-15)
    assert_allclose(top[:, 2], 0.2, atol=1e-15)
    assert_allclose(geometry.nodes[:, 0], 1.0, rtol=1e-15)


def test_flat_shapes_and_their_groups(made: Any) -> None:
    disc = {"shape": "disc", "center": [0, 0, 0.5], "radius": 0.1, "rings": 3, "normal": [0, 1, 0]}
    ring = {"shape": "annulus", "center": [0, 0, 0], "inner_radius": 0.1, "outer_radius": 0.2, "rings": 2}
    geometry = made(shell_deck(disc)).geometry
    assert_allclose(np.ptp(geometry.nodes, axis=0)[1], 0.0, atol=1e-16)
    assert_array_equal(geometry.node_groups["sheet.boundary"], geometry.node_groups["sheet.rim"])
    geometry = made(shell_deck(ring)).geometry
    both = np.union1d(geometry.node_groups["sheet.inner"], geometry.node_groups["sheet.outer"])
    assert_array_equal(geometry.node_groups["sheet.boundary"], both)
    assert_allclose(geometry.areas.sum(), np.pi * 0.03, rtol=0.05)


def test_plan_says_what_shells_need(made: Any) -> None:
    free, hinged = (made(shell_deck(body={"bending": b})) for b in ("midedge", "hinge"))
    assert "no rods" in str(free.plan)
    assert "one angle per edge of 48 triangles" in str(free.plan)
    assert "no mid-edge normals on shell 'sheet'" in str(hinged.plan)
    assert free.simulation.model.dofs.n_normals > 0
    assert hinged.simulation.model.dofs.n_normals == 0


@pytest.mark.parametrize("pattern", ["equilateral", "right", "alternating"])
def test_weighted_hinges_follow_their_shape(made: Any, pattern: str) -> None:
    """Length^2 over both areas, next to what one constant gives; the same between equilateral triangles."""
    bending = {"bending": "hinge"}
    scenes = [
        made(shell_deck(SHEET | {"pattern": pattern}, body=bending | {"hinges": hinges}))
        for hinges in ("equal", "weighted")
    ]
    equal, weighted = (
        next(t for t in scene.simulation.model.terms if t.name == "sheet.bending").parameter("k")
        for scene in scenes
    )
    geometry = scenes[0].geometry
    topology = shell_edges(geometry.triangles)
    length = edge_lengths(geometry.nodes, topology.hinges[:, :2])
    pair = geometry.areas[topology.hinge_faces].sum(axis=1)
    assert_allclose(weighted / equal, length**2 / pair * np.sqrt(3.0) / 2.0, rtol=1e-12)


def test_uneven_meshes_are_doubtful_for_hinges_only(made: Any) -> None:
    for pattern, bending, count in (
        ("right", "hinge", 1),
        ("right", "averaged", 1),
        ("right", "midedge", 0),
        ("equilateral", "hinge", 0),
    ):
        built = made(shell_deck(SHEET | {"pattern": pattern}, body={"bending": bending}))
        assert len(built.plan.warnings) == count
        for warning in built.plan.warnings:
            assert "scene.yaml:" in warning
            assert "geometry[0].bending: the corners of 'sheet' are 21 degrees off those of" in warning
    right = sheet(1.0, 1.0, 4, Pattern.RIGHT)
    assert_allclose(unevenness(right.nodes, right.triangles), np.sqrt(450.0), rtol=1e-12)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"dimension": 2}, "geometry[0].type: a shell needs a scene of dimension 3"),
        (
            {"motions": [{"type": "clamp", "where": "sheet.leftt"}]},
            "motions[0].where: a generated sheet has the groups 'left', 'right',",
        ),
        (
            {"motions": [{"type": "clamp", "where": "shet"}]},
            "motions[0].where: no body is named 'shet'; did you mean 'sheet'?",
        ),
        (
            {"motions": [{"type": "clamp", "where": "sheet.left", "twist": 1.0}]},
            "motions[0].twist: turns no edge of a rod: none is held",
        ),
        (
            {"forces": [{"type": "pressure", "shell": "shet", "pressure": 1.0}]},
            "forces[0].shell: no shell is named 'shet'; did you mean 'sheet'?",
        ),
        ({"forces": [{"type": "viscous", "coefficient": 1.0}]}, "forces[0].type: acts on rods, but"),
        (
            {"forces": [{"type": "moment", "where": "sheet.left", "moment": [0.0, 1.0, 0.0]}]},
            "which no rod has: a moment acts on rods",
        ),
        (
            {"actuation": [{"type": "dihedral", "shell": "rod", "value": 1.0}]},
            "actuation[0].shell: no shell is named 'rod'",
        ),
        (
            {"actuation": [{"type": "dihedral", "shell": "sheet", "hinges": "sheet.left", "value": 1.0}]},
            "actuation[0]: finds no hinge of shell 'sheet', which has 62",
        ),
        (
            {"forces": [{"type": "pressure", "shell": "sheet", "pressure": {"expression": "x"}}]},
            "'x' has no meaning here; known: 't'",
        ),
        ({"output": {"fields": ["twist"]}}, "output.fields[0]: 'twist' is a field of rods, but"),
        (
            {"motions": [{"type": "clamp", "where": {"edges": {"of": "sheet", "indices": [0]}}}]},
            "motions[0].where.edges.of: no rod is named 'sheet'",
        ),
        (
            {"masses": [{"where": "sheet.left", "mass": 0.0}]},
            "masses[0].mass: must be greater than 0, got 0.0",
        ),
    ],
)
def test_refused(refused: Any, keys: Deck, message: str) -> None:
    text = refused(shell_deck(**keys))
    assert "scene.yaml:" in text
    assert message in text


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ({"thickness": -1.0}, "geometry[0].thickness: must be greater than 0"),
        ({"hinges": "weighted"}, "'hinges' has a meaning with bending: hinge only, got 'midedge'"),
        ({"bending": "hing"}, "geometry[0].bending: expected 'midedge', 'hinge' or 'averaged'"),
        ({"generate": SHEET | {"axes": [[1, 0, 0], [2, 0, 0]]}}, "axes of a sheet must not be parallel"),
        ({"generate": BELL | {"polar_angles": [0.1, 0.2]}}, "give either 'rings' or 'polar_angles'"),
        ({"generate": None, "mesh": {"file": "lines.txt"}}, "has no triangles; a shell needs some"),
        ({"generate": None, "mesh": {"file": "mixed.txt", "group": "a"}}, "has no group of triangles 'a'"),
    ],
)
def test_refused_bodies(refused: Any, tmp_path: Path, body: Deck, message: str) -> None:
    (tmp_path / "mixed.txt").write_text(MIXED, encoding="utf-8")
    (tmp_path / "lines.txt").write_text(MIXED.partition("*Triangles")[0], encoding="utf-8")
    text = refused(shell_deck(body=body))
    assert "scene.yaml:" in text
    assert message in text


def test_stout_shells_are_doubtful(write: Any) -> None:
    (warning,) = load(write(shell_deck(body={"thickness": 0.05}))).warnings
    assert "geometry[0].thickness: thickness 0.05 m on a size of 0.2 m: too stout for a shell" in warning


def test_what_needs_motion_does_nothing_at_rest(write: Any) -> None:
    """Thrust as well as damping: neither has anything to push in a static run."""
    forces = [
        {"type": "thrust", "shell": "sheet", "coefficient": 1.0, "direction": [0, 0, 1]},
        {"type": "pressure", "shell": "sheet", "pressure": 1.0},
        {"type": "area_damping", "coefficient": 1.0},
    ]
    deck = shell_deck(forces=forces, numerics=STATIC)
    warnings = load(write(deck)).warnings
    assert [warning.partition(": ")[2] for warning in warnings] == [
        "forces[0].type: thrust depends on velocity: it does nothing in a static run",
        "forces[2].type: area_damping depends on velocity: it does nothing in a static run",
    ]
    assert load(write(deck | {"numerics": EULER})).warnings == ()
