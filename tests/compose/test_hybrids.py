"""Rods welded to shells, from scenario text: against beam theory, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from shell_decks import MIXED, STATIC, Deck, made, ran, refused, write

from dismech_cli.model.stencil import StencilEnergy
from dismech_cli.session.report import Report

__all__ = ["made", "ran", "refused", "write"]

LENGTH, WIDTH = 0.1, 0.02
BENDING_1 = 1e9 * 3e-3 * 2e-3**3 / 12.0  # along z, the director
BENDING_2 = 1e9 * 2e-3 * 3e-3**3 / 12.0
TORSION = 0.4e9 * 5e-12
JOINT: Deck = {"type": "rigid", "nodes": ["rod.end", {"nearest": [LENGTH, 0.0, 0.0]}]}


def strip(nodes: int, divisions: int, *, modulus: float = 1e12, joint: Deck = JOINT, **keys: Any) -> Deck:
    """A rectangular rod from the origin along x, and a strip of a shell without Poisson's ratio beyond it."""
    section = {
        "type": "given",
        "axial_stiffness": 6e3,
        "bending_stiffness_1": BENDING_1,
        "bending_stiffness_2": BENDING_2,
        "torsional_stiffness": TORSION,
        "mass_per_length": 6e-3,
        "rotary_inertia_per_length": 6.5e-9,
        "radius": 1e-3,
    }
    line = {"shape": "line", "from": [0, 0, 0], "to": [LENGTH, 0, 0], "nodes": nodes}
    sheet = {"shape": "sheet", "origin": [LENGTH, -WIDTH / 2, 0], "length": LENGTH, "width": WIDTH}
    sheet |= {"divisions": divisions, "pattern": "alternating"}
    return {
        "schema_version": 1,
        "name": "strip",
        "materials": {
            "rod": {"youngs_modulus": 1e9, "poisson_ratio": 0.25, "density": 1000.0},
            "sheet": {"youngs_modulus": modulus, "poisson_ratio": 0.0, "density": 1000.0},
        },
        "geometry": [
            {"type": "rod", "name": "rod", "material": "rod", "section": section, "director": [0, 0, 1]}
            | {"generate": line},
            {"type": "shell", "name": "sheet", "material": "sheet", "thickness": 1e-3, "generate": sheet},
        ],
        "joints": [joint],
        "motions": [{"type": "clamp", "where": "rod.start"}],
        "numerics": STATIC | {"newton": {"tolerance": 1e-10}},
    } | keys


def push(where: Any, force: list[float]) -> Deck:
    return {"forces": [{"type": "point", "where": where, "force": force}]}


def moved(result: Report, place: list[float]) -> np.ndarray:
    """Displacement of the node at a place."""
    start, end = result.frames[0].positions, result.frames[-1].positions
    distances = np.linalg.norm(start - place, axis=1)
    assert distances.min() < 1e-9
    return np.asarray((end - start)[np.argmin(distances)])


@pytest.mark.parametrize(("axis", "stiffness"), [(2, BENDING_1), (1, BENDING_2)])
def test_a_stiff_plate_on_a_rod_bends_it_as_a_beam(ran: Any, axis: int, stiffness: float) -> None:
    """Load at the far end of the plate: its joint passes bending about both axes.

    The error of the rod is second order in its edge: with n edges a cantilever is (1 + O(1/n^2)).
    """
    load = [0.0, 0.0, 0.0]
    load[axis] = 1e-5
    end = {"nearest": [2 * LENGTH, 0.0, 0.0]}
    # deflection, slope and the slope's lever: (L^3/3 + L^2 M + L M^2) P / EI with M = L
    exact = 1e-5 * LENGTH**3 * (1.0 / 3.0 + 2.0) / stiffness
    errors = []
    for nodes, divisions in ((6, 10), (11, 20)):
        result = ran(strip(nodes, divisions, **push(end, load)))
        errors.append(moved(result, [2 * LENGTH, 0.0, 0.0])[axis] / exact - 1.0)
    assert 0.0 < errors[0] < 0.2 / 5**2
    # the plate itself gives way by a few parts in ten thousand
    assert abs(errors[1]) < 0.3 * abs(errors[0])


@pytest.mark.parametrize(("nodes", "divisions"), [(6, 10), (11, 20)])
def test_a_stiff_plate_on_a_rod_twists_it(ran: Any, nodes: int, divisions: int) -> None:
    """Load at a corner: torque P b / 2. Twist of a rod is exact on any mesh; the plate bends a little."""
    corner = [2 * LENGTH, WIDTH / 2, 0.0]
    result = ran(strip(nodes, divisions, **push({"nearest": corner}, [0.0, 0.0, 1e-4])))
    other = [2 * LENGTH, -WIDTH / 2, 0.0]
    angle = (moved(result, corner)[2] - moved(result, other)[2]) / WIDTH
    assert_allclose(angle, 1e-4 * 0.5 * WIDTH * LENGTH / TORSION, rtol=1e-3)


@pytest.mark.parametrize("bending", ["midedge", "hinge", "averaged"])
def test_every_kind_of_shell_can_be_welded(ran: Any, bending: str) -> None:
    load = push({"nearest": [2 * LENGTH, 0.0, 0.0]}, [0.0, 0.0, 1e-5])
    deck = strip(6, 10, **load)
    deck["geometry"][1]["bending"] = bending
    exact = 1e-5 * LENGTH**3 * (1.0 / 3.0 + 2.0) / BENDING_1
    assert_allclose(moved(ran(deck), [2 * LENGTH, 0.0, 0.0])[2], exact, rtol=5e-3)


@pytest.mark.parametrize(("nodes", "divisions"), [(6, 10), (6, 20)])
def test_half_rod_half_strip_is_one_beam(ran: Any, nodes: int, divisions: int) -> None:
    """Equal stiffness against bending out of the plane, load at the end of the rod, strip clamped.

    The couple enters the strip at a node: near it the plate turns more than a beam by an amount of
    order b / (2 pi L) times a logarithm, a per cent of the whole.
    """
    modulus = BENDING_1 / (WIDTH * 1e-3**3 / 12.0)
    deck = strip(nodes, divisions, modulus=modulus, **push("rod.start", [0.0, 0.0, 1e-5]))
    deck["motions"] = [{"type": "clamp", "where": "sheet.right"}]
    exact = 1e-5 * (2.0 * LENGTH) ** 3 / (3.0 * BENDING_1)
    assert_allclose(moved(ran(deck), [0.0, 0.0, 0.0])[2], exact, rtol=0.01)


def test_a_footprint_spreads_the_weld(ran: Any, made: Any) -> None:
    """In its plane a sheet gives way at a point without bound; over the width of the strip it does not.

    Linear triangles are too stiff in bending, by 38 % with two across and by 15 % with four.
    """
    modulus = BENDING_2 / (1e-3 * WIDTH**3 / 12.0)
    wide = JOINT | {"footprint": WIDTH / 2}
    exact = 1e-5 * (2.0 * LENGTH) ** 3 / (3.0 * BENDING_2)
    errors = []
    for divisions in (10, 20):
        deck = strip(6, divisions, modulus=modulus, joint=wide, **push("rod.start", [0.0, 1e-5, 0.0]))
        deck["motions"] = [{"type": "clamp", "where": "sheet.right"}]
        errors.append(moved(ran(deck), [0.0, 0.0, 0.0])[1] / exact - 1.0)
    # second order, toward a sheet that is stiff over the footprint
    assert -0.4 < errors[0] < 2.0 * errors[1] < 0.0
    near, far = (weld_stiffness(made(strip(6, 20, joint=j))) for j in (JOINT, wide))
    assert_allclose(far, near, rtol=1e-14)


def weld_stiffness(built: Any) -> np.ndarray:
    """Sum over all triangles of the stiffness against twist and bending."""
    terms = [t for t in built.simulation.model.terms if isinstance(t, StencilEnergy) and "weld" in t.name]
    return np.sum([[t.parameter(name).sum() for name in ("K_0", "K_1", "K_2")] for t in terms], axis=0)


@pytest.mark.parametrize("divisions", [10, 20])
def test_a_weld_is_the_half_of_an_edge_and_weighs_nothing(made: Any, divisions: int) -> None:
    """However many triangles meet at the node; mass is that of the rod and of the sheet."""
    built = made(strip(6, divisions) | {"numerics": {"dt": 0.01, "t_end": 0.1}})
    assert_allclose(weld_stiffness(built), np.array([TORSION, BENDING_2, BENDING_1]) / 0.01, rtol=1e-14)
    model = built.simulation.model
    total = model.mass[: model.dofs.n_positions : 3].sum()
    assert_allclose(total, 6e-3 * LENGTH + LENGTH * WIDTH * 1e-3 * 1000.0, rtol=1e-12)


def through(modulus: float, **keys: Any) -> Deck:
    """The rod along x from -LENGTH to LENGTH, welded to the middle of a square sheet across it."""
    deck = strip(21, 4, modulus=modulus, **keys)
    rod, sheet = deck["geometry"]
    rod["generate"] = {"shape": "line", "from": [-LENGTH, 0, 0], "to": [LENGTH, 0, 0], "nodes": 21}
    sheet["generate"] |= {
        "origin": [0, -WIDTH / 2, -WIDTH / 2],
        "axes": [[0, 1, 0], [0, 0, 1]],
        "length": WIDTH,
    }
    pair = [{"nodes": {"of": body, "indices": [middle]}} for body, middle in (("rod", 10), ("sheet", 12))]
    deck["joints"] = [{"type": "rigid", "nodes": pair}]
    return deck


def test_a_rod_through_a_wall_is_two_cantilevers(ran: Any) -> None:
    held = {"motions": [{"type": "clamp", "where": "sheet.boundary"}]}
    result = ran(through(1e15, **held, **push("rod.end", [0.0, 0.0, 1e-5])))
    sag = moved(result, [LENGTH, 0.0, 0.0])[2]
    # each half begins at the wall; a cantilever of n edges sags (1 + 1/(2 n^2)) of a beam
    assert_allclose(sag, 1e-5 * LENGTH**3 / (3.0 * BENDING_1) * (1.0 + 0.5 / 10**2), rtol=1e-5)
    assert abs(moved(result, [-LENGTH, 0.0, 0.0])[2]) < 1e-6 * sag


def test_a_rod_through_a_soft_sheet_stays_whole(ran: Any) -> None:
    """Its halves about the weld are springs in a row: one cantilever of twenty edges."""
    for axis, stiffness in ((2, BENDING_1), (1, BENDING_2)):
        load = [0.0, 0.0, 0.0]
        load[axis] = 1e-5
        result = ran(through(1e3, **push("rod.end", load)))
        sag = moved(result, [LENGTH, 0.0, 0.0])[axis]
        exact = 1e-5 * (2.0 * LENGTH) ** 3 / (3.0 * stiffness) * (1.0 + 0.5 / 20**2)
        assert_allclose(sag, exact, rtol=1e-5)


@pytest.mark.parametrize("release", ["bending", "twist"])
def test_released_welds_pass_the_rest(ran: Any, made: Any, release: str) -> None:
    """A rod pinned at its start, its other end on a plate that is held all over."""
    deck = strip(41, 10, joint=JOINT | {"release": release})
    pin = {"type": "pin", "where": "rod.start"}
    deck["motions"] = [{"type": "clamp", "where": "sheet"}, pin]
    stiffness = weld_stiffness(made(deck))
    assert (stiffness > 0.0).tolist() == (
        [True, False, False] if release == "bending" else [False, True, True]
    )
    if release == "bending":
        deck["forces"] = [{"type": "moment", "where": "rod.start", "moment": [1e-5, 0.0, 0.0]}]
        turned = {"probe": {"twist": "rod.start"}, "value": 0.0, "tolerance": 1.0, "source": "none"}
        deck["expect"] = {"twist": turned}
        angle = ran(deck).outcome.watched["twist"][-1]
        # from the middle of the first edge to the plate
        assert_allclose(angle, 1e-5 * (LENGTH - 0.5 * LENGTH / 40) / TORSION, rtol=1e-9)
    else:
        deck["motions"].append({"type": "twist", "where": "rod.start", "angle": 0.0})
        place, load, a = [0.04, 0.0, 0.0], 1e-5, 0.06
        deck |= push({"nearest": place}, [0.0, 0.0, load])
        # a cantilever of length a from the plate, less what the pin holds back
        held = a**4 * (3.0 * LENGTH - a) ** 2 / (12.0 * LENGTH**3)
        exact = load * (a**3 / 3.0 - held) / BENDING_1
        assert_allclose(moved(ran(deck), place)[2], exact, rtol=5e-3)


def test_bodies_of_one_file_hang_until_they_are_welded(made: Any, tmp_path: Path) -> None:
    """Where both name the same place, the second selection means the other body."""
    (tmp_path / "mixed.txt").write_text(MIXED, encoding="utf-8")
    deck = strip(6, 10, joints=[])
    source = {"mesh": {"file": "mixed.txt"}}
    bodies = [{key: v for key, v in body.items() if key != "generate"} | source for body in deck["geometry"]]
    deck |= {"geometry": [bodies[0] | {"director": [1, 0, 0]}, bodies[1]]}
    assert not made(deck).geometry.shell_welds
    at = {"nearest": [0.0, 0.0, 0.0]}
    built = made(deck | {"joints": [{"type": "rigid", "nodes": [at, at], "release": "twist"}]})
    assert [weld.edge for weld in built.geometry.shell_welds] == [0]
    assert_allclose(weld_stiffness(built), np.array([0.0, BENDING_2, BENDING_1]) / 0.5, rtol=1e-14)


def test_hinged_rods_hang_on_shells_as_before(made: Any) -> None:
    assert weld_stiffness(made(strip(6, 10, joint=JOINT | {"type": "hinge"}))) == 0.0


@pytest.mark.parametrize("whole", [False, True], ids=["two halves", "within one"])
def test_released_joints_of_rods(ran: Any, whole: bool) -> None:
    """Held at one end, twisted or bent at the other, past a joint in the middle that passes that alone."""
    deck = strip(6, 10)
    body = {key: value for key, value in deck["geometry"][0].items() if key != "generate"}

    def line(name: str, start: float, end: float, nodes: int) -> Deck:
        shape = {"shape": "line", "from": [start, 0, 0], "to": [end, 0, 0], "nodes": nodes}
        return body | {"name": name, "generate": shape}

    halves = [line("a", 0.0, 0.05, 11), line("b", 0.05, LENGTH, 11)]
    deck["geometry"] = [line("a", 0.0, LENGTH, 21)] if whole else halves
    end = "a.end" if whole else "b.end"
    within = {"type": "hinge", "where": {"nodes": {"of": "a", "indices": [10]}}}
    joint = within if whole else {"type": "rigid", "nodes": ["a.end", "b.start"]}
    deck["motions"] = [{"type": "clamp", "where": "a.start"}, {"type": "pin", "where": end}]
    turned = {"probe": {"twist": end}, "value": 0.0, "tolerance": 1.0, "source": "none"}
    deck["expect"] = {"twist": turned}

    deck["joints"] = [joint | {"release": "bending"}]
    deck["forces"] = [{"type": "moment", "where": end, "moment": [1e-5, 0.0, 0.0]}]
    angle = ran(deck).outcome.watched["twist"][-1]
    assert_allclose(angle, 1e-5 * (LENGTH - 0.0025) / TORSION, rtol=1e-9)

    deck["joints"] = [joint | {"release": "twist"}]
    deck["forces"] = [{"type": "moment", "where": end, "moment": [0.0, -1e-5, 0.0]}]
    deck["motions"].append({"type": "twist", "where": end, "angle": 0.0})
    # clamped and pinned, moment at the pin; second order in the edge
    middle = moved(ran(deck), [0.05, 0.0, 0.0])[2]
    assert_allclose(middle, -1e-5 * LENGTH**2 / 32.0 / BENDING_1, rtol=0.02)


@pytest.mark.parametrize(
    ("joint", "message"),
    [
        ({"release": "torsion"}, "joints[0].release: expected 'bending' or 'twist', got 'torsion'"),
        ({"footprint": 0.0}, "joints[0].footprint: must be greater than 0"),
        ({"nodes": ["rod.start", "rod.end"]}, "joints[0].nodes: the two nodes are 0.1 m apart"),
        (
            {"nodes": [{"nearest": [0.2, 0, 0]}, {"nearest": [0.2, 0, 0]}]},
            "joints[0].nodes: both select one node, and 0 others are at its place; expected one",
        ),
        ({"nodes": [{"nearest": [LENGTH, 0, 0]}, {"nearest": [LENGTH, 0, 0]}]}, ""),
    ],
)
def test_refused(refused: Any, made: Any, joint: Deck, message: str) -> None:
    deck = strip(6, 10, joint=JOINT | joint)
    if message:
        text = refused(deck)
        assert "scene.yaml:" in text
        assert message in text
    else:
        assert len(made(deck).geometry.shell_welds) == 1


def line(name: str, start: list[float], end: list[float]) -> Deck:
    generate = {"shape": "line", "from": start, "to": end, "nodes": 3}
    return {"type": "rod", "name": name, "material": "rod", "radius": 1e-3, "generate": generate}


ROOT = {"nodes": {"of": "sheet", "indices": [11]}}  # at (LENGTH, 0, 0)
MIDDLE = {"nodes": {"of": "other", "indices": [1]}}


@pytest.mark.parametrize(
    ("joints", "message"),
    [
        (
            [{"type": "rigid", "nodes": [MIDDLE, ROOT], "release": "twist"}],
            "joints[0].release: 2 edges of a rod meet here, between which twist must pass",
        ),
        (
            [{"type": "rigid", "nodes": [MIDDLE, "rod.end"], "footprint": 0.01}],
            "joints[0].footprint: neither node is on a shell",
        ),
        (
            [JOINT | {"nodes": ["rod.end", ROOT]}, {"type": "rigid", "nodes": [MIDDLE, "rod.end"]}],
            "joints[1]: a shell joins these rods: weld each of them to it instead",
        ),
        (
            [{"type": "rigid", "nodes": [ROOT, {"nodes": {"of": "second", "indices": [11]}}]}],
            "a rigid joint welds rods, or a rod to a shell; two shells are welded along a 'seam'",
        ),
    ],
)
def test_refused_where_no_rod_or_no_end_meets_a_shell(refused: Any, joints: list[Deck], message: str) -> None:
    deck = strip(6, 10)
    deck["geometry"] += [line("other", [0.05, 0, 0], [0.15, 0, 0]), deck["geometry"][1] | {"name": "second"}]
    deck["joints"] = joints
    text = refused(deck)
    assert "scene.yaml:" in text
    assert message in text


def test_a_rod_that_ends_along_the_only_triangles_is_refused(refused: Any) -> None:
    """At the end of a rod that runs along the rim into a corner, the one triangle has both its nodes."""
    deck = strip(6, 10)
    deck["geometry"][1]["generate"]["pattern"] = "right"
    y = -WIDTH / 2
    deck["geometry"].append(line("rib", [2 * LENGTH - 0.02, y, 0], [2 * LENGTH, y, 0]))
    first, second = ({"nodes": {"of": "sheet", "indices": [k]}} for k in (10, 9))
    rib = {"nodes": {"of": "rib", "indices": [1]}}
    deck["joints"] = [
        {"type": "rigid", "nodes": ["rib.end", first]},
        {"type": "hinge", "nodes": [rib, second]},
    ]
    assert "joints[0]: the rod lies along every triangle around this node; weld another" in refused(deck)


@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("given", [False, True], ids=["driven", "given"])
def test_a_rod_grows_from_a_held_plate_as_from_a_clamp(ran: Any, backwards: bool, given: bool) -> None:
    """Its natural strains act on the half edge at the weld too, drawn towards it or from it."""
    strains = {"curvature_1": 6.0, "curvature_2": 4.0 if backwards else -4.0, "twist": 5.0}
    welded, clamped = strip(6, 10), strip(6, 10)
    del clamped["geometry"][1], clamped["joints"]
    hub, tip = ("start", "end") if backwards else ("end", "start")
    for deck in (welded, clamped):
        body = deck["geometry"][0]
        if backwards:
            line = body["generate"]
            line["from"], line["to"] = line["to"], line["from"]
        if given:
            body["natural"] = strains
        else:
            deck["actuation"] = [
                {"type": name, "rod": "rod", "value": {"table": [[0.0, 0.0], [1.0, value]]}}
                for name, value in strains.items()
            ]
        deck["forces"] = [{"type": "point", "where": f"rod.{tip}", "force": [0.0, 1e-3, 2e-3]}]
    welded["joints"][0]["nodes"][0] = f"rod.{hub}"
    welded["motions"] = [{"type": "clamp", "where": "sheet"}]
    clamped["motions"] = [{"type": "clamp", "where": f"rod.{hub}"}]
    here, there = (ran(deck).frames[-1].positions[:6] for deck in (welded, clamped))
    assert np.abs(there[:, 1:]).max() > 0.01
    # half an edge twists by 0.05 rad: 2 tan(0.025) is 1e-5 more, over a length of 0.1 m
    assert_allclose(here, there, atol=1e-6)
