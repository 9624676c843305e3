"""What `check` warns of in the geometry: mechanisms, rows too narrow to clamp, bodies that only touch."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from decks import given_section, line, rod_deck
from shell_decks import BELL, DOWN, EULER, SHEET, STATIC, Deck, made, refused, rod, shell_deck, write

from dismech_cli import load
from dismech_cli.compose.compose import compose

__all__ = ["made", "refused", "write"]

WIDE = SHEET | {"pattern": "equilateral"}
CLAMP: Deck = {"type": "clamp", "where": "sheet.left"}


def warnings(made: Any, deck: Deck) -> list[str]:
    """Without the file and the line."""
    return [warning.split(": ", 1)[1] for warning in made(deck).plan.warnings]


@pytest.mark.parametrize("bending", ["midedge", "hinge", "averaged"])
def test_a_single_row_is_no_clamp_without_normals(made: Any, bending: str) -> None:
    told = warnings(made, shell_deck(WIDE, body={"bending": bending}, motions=[CLAMP]))
    assert len(told) == (bending != "midedge")
    assert all("motions[0].where: holds no whole triangle of 'sheet', which can turn" in w for w in told)
    two_rows = CLAMP | {"where": {"box": {"min": [-1, -1, -1], "max": [0.06, 1, 1]}}}
    assert warnings(made, shell_deck(WIDE, body={"bending": bending}, motions=[two_rows])) == []
    pinned = shell_deck(WIDE, body={"bending": bending}, motions=[CLAMP | {"type": "pin"}])
    assert warnings(made, pinned) == []


def test_springs_between_other_triangles_are_doubtful(made: Any) -> None:
    for pattern, count in (("right", 1), ("equilateral", 0)):
        told = warnings(made, shell_deck(SHEET | {"pattern": pattern}, body={"membrane": "springs"}))
        assert len(told) == count
    assert (
        "springs along edges stretch by the mesh there; take 'cst'"
        in warnings(made, shell_deck(SHEET | {"pattern": "right"}, body={"membrane": "springs"}))[0]
    )


PINNED: Deck = {"type": "pin", "where": "sheet.left"}
CORNER: Deck = {"type": "pin", "where": {"nearest": [0, 0, 0]}}


@pytest.mark.parametrize(
    ("motions", "free"),
    [
        ([], 6),
        ([CORNER], 3),
        ([PINNED], 1),
        ([CLAMP], 0),
        ([PINNED, {"type": "pin", "where": {"nearest": [0.3, 0, 0]}, "components": ["z"]}], 0),
        ([{"type": "symmetry", "where": "sheet.left", "normal": "x"}], 3),
    ],
)
def test_statics_that_may_drift_are_told(made: Any, motions: list[Deck], free: int) -> None:
    told = warnings(made, shell_deck(WIDE, motions=motions, numerics=STATIC))
    expected = f"geometry[0]: nothing holds 'sheet' in {free} of the 6 ways to move or turn as a whole"
    assert [w.partition(":  ")[0][: len(expected)] for w in told] == ([expected] if free else [])
    assert warnings(made, shell_deck(WIDE, motions=motions, numerics=EULER)) == []


@pytest.mark.parametrize(
    ("dimension", "motions", "free"),
    [
        (2, [], 3),
        (2, [{"type": "pin", "where": "rod.start"}], 1),
        (2, [{"type": "clamp", "where": "rod.start"}], 0),
        (3, [{"type": "pin", "where": "rod.start"}, {"type": "pin", "where": "rod.end"}], 1),
        (3, [{"type": "clamp", "where": "rod.start"}], 0),
        (3, [{"type": "clamp", "where": "rod.start", "at": "edge"}], 0),
    ],
)
def test_rods_that_may_drift(write: Any, made: Any, dimension: int, motions: list[Deck], free: int) -> None:
    told = warnings(made, rod_deck(line(6), dimension=dimension, motions=motions))
    assert [f"nothing holds 'rod' in {free} of the" in w for w in told] == ([True] if free else [])


def test_bodies_hang_together_at_joints_and_only_there(made: Any) -> None:
    deck = shell_deck(WIDE, motions=[CLAMP], numerics=STATIC)
    corner = [0.3, 0.0, 0.0]
    deck["geometry"] = [*deck["geometry"], rod(corner, [0.3, 0.0, -0.5])]
    apart = warnings(made, deck)
    assert len(apart) == 2
    assert (
        "geometry[1]: 'sheet' and 'rod' touch, with nodes at the same place (1), but nothing joins"
        in apart[0]
    )
    assert "geometry[1]: nothing holds 'rod' in 6 of the 6 ways to move or turn" in apart[1]
    joint = {"type": "rigid", "nodes": ["rod.start", {"nearest": corner}]}
    assert warnings(made, deck | {"joints": [joint]}) == []


def test_light_sections_swing_too_fast(write: Any) -> None:
    section = {"mass_per_length": 1.0, "rotary_inertia": 1e-12}
    numerics = {"dt": 0.01, "t_end": 0.1}
    (warning,) = load(write(rod_deck(line(6), given_section(**section), numerics=numerics))).warnings
    assert "section.rotary_inertia_per_length: 1e-12 kg m is far below that of a solid round rod" in warning
    assert load(write(rod_deck(line(6), given_section(**section)))).warnings == ()


THRUST: Deck = {"type": "thrust", "shell": "sheet", "coefficient": 1.0, "direction": [0, 0, 1]}
RING: Deck = {"shape": "annulus", "center": [0, 0, 0], "inner_radius": 0.1, "outer_radius": 0.2, "rings": 2}


def test_only_a_bell_thrusts(made: Any, refused: Any) -> None:
    assert made(shell_deck(BELL, forces=[THRUST]))
    told = refused(shell_deck(RING, forces=[THRUST]))
    assert "forces[0].shell: 'sheet' has 2 rims; a bell has one, around its opening" in told


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"motions": [CLAMP | {"twist": 1.0}]}, "motions[0].twist: turns no edge of a rod: none is held"),
        (
            {"forces": [DOWN, {"type": "pressure", "shell": "rod", "pressure": 1.0}]},
            "forces[1].shell: 'rod' is no shell",
        ),
        (
            {"forces": [{"type": "viscous", "rods": ["sheet"], "coefficient": 1.0}]},
            "forces[0].rods[0]: 'sheet' is no rod",
        ),
    ],
)
def test_refused(refused: Any, keys: Deck, message: str) -> None:
    deck = shell_deck() | keys
    deck["geometry"] = [*deck["geometry"], rod([0.0, 0.0, 1.0], [0.0, 0.0, 0.5])]
    assert message in refused(deck)


@pytest.mark.parametrize(("twist", "bending_2", "told"), [(60.0, 2.0, 1), (60.0, 1.0, 0), (8.0, 2.0, 0)])
def test_a_mesh_must_follow_the_axes_of_a_twisted_section(
    made: Any, twist: float, bending_2: float, told: int
) -> None:
    deck = rod_deck(
        line(21), given_section(bending_2=bending_2), dimension=3, rod={"natural": {"twist": twist}}
    )
    found = warnings(made, deck)
    assert len(found) == told
    assert all(
        "geometry[0].natural.twist: turns the section of 'rod', which is not round, by 3 rad" in w
        for w in found
    )
    assert all("take about 121 nodes" in w for w in found)


GRIDSHELL = Path(__file__).parents[2] / "scenarios" / "gridshell.yaml"


@pytest.mark.parametrize(
    ("overrides", "told"),
    [
        (["numerics.integrator.method=newton"], "nearer to each other by 10%"),
        ([], ""),
        (
            [
                "numerics.integrator.method=newton",
                *(f"motions[{k}].displacement=[0, 0, 10 mm]" for k in range(4)),
            ],
            "",
        ),
    ],
)
def test_nets_pushed_in_are_proposed_motion_to_rest(overrides: list[str], told: str) -> None:
    plan = compose(load(GRIDSHELL, overrides=tuple(overrides))).plan
    decisions = [d.why for d in plan.decisions if "numerics.integrator.method=relax" in d.why]
    assert len(decisions) == bool(told)
    assert all(told in why for why in decisions)


@pytest.mark.parametrize(
    "stem", ["welded_net", "drooping_ring", "buckled_strip", "grippers", "hinged_bridge"]
)
def test_no_other_shipped_scene_is(stem: str) -> None:
    plan = compose(load(GRIDSHELL.with_name(f"{stem}.yaml"))).plan
    assert not any("relax" in d.why for d in plan.decisions)
