"""Joints pass what they say, whatever else meets at their node."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import Deck, scalar, solve
from numpy.testing import assert_allclose

from dismech_cli import load
from dismech_cli.compose.compose import Composition, compose
from dismech_cli.compose.structure.plan import Bending
from dismech_cli.errors import ScenarioError
from dismech_cli.session.inspect import inspect

OBJ = (Path(__file__).parents[1] / "data" / "cases" / "joint_beside_shell.obj").read_text(encoding="utf-8")
MATERIAL = {"m": {"youngs_modulus": 1e9, "poisson_ratio": 0.4, "density": 1150.0}}


def made(folder: Path, deck: Deck) -> Composition:
    file = folder / "scene.yaml"
    file.write_text(json.dumps(deck), encoding="utf-8")
    return compose(load(file))


def refused(folder: Path, deck: Deck) -> str:
    with pytest.raises(ScenarioError) as error:
        made(folder, deck)
    return str(error.value)


def line(name: str, start: list[float], end: list[float], nodes: int, **keys: Any) -> Deck:
    shape = {"shape": "line", "from": start, "to": end, "nodes": nodes}
    return {"type": "rod", "name": name, "material": "m", "radius": 4e-3, "generate": shape} | keys


def scene(*bodies: Deck, **keys: Any) -> Deck:
    deck = {
        "schema_version": 1,
        "name": "joints",
        "materials": MATERIAL,
        "geometry": list(bodies),
        "numerics": {"integrator": {"type": "static", "load_steps": 2}},
    }
    return deck | keys


def beside_shell(shell: bool) -> Deck:
    """Two rods of one file, welded where a shell of it has a corner."""
    source = {"mesh": {"file": "lsh.obj", "group": "sh"}}
    bodies = [
        {"type": "rod", "name": name, "material": "m", "radius": 2e-3}
        | {"mesh": {"file": "lsh.obj", "group": name}}
        for name in ("a", "b")
    ]
    if shell:
        bodies.insert(0, {"type": "shell", "name": "tag", "material": "m", "thickness": 1e-5} | source)
    return scene(
        *bodies,
        joints=[{"type": "rigid", "nodes": ["a.end", "b.start"]}],
        motions=[{"type": "clamp", "where": "a.start"}],
        forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -9.81]}],
        numerics={"integrator": {"type": "implicit_midpoint"}, "dt": 2e-3, "t_end": 0.04},
        output={"probes": {"z": {"displacement": {"nearest": [0.2, 0.0, 0.0]}, "component": "z"}}},
    )


def test_a_rigid_joint_counts_beside_a_shell(tmp_path: Path) -> None:
    (tmp_path / "lsh.obj").write_text(OBJ, encoding="utf-8")
    without, beside = (scalar(solve(tmp_path, beside_shell(shell)), "z")[-1] for shell in (False, True))
    assert without < -1e-3
    assert_allclose(beside, without, rtol=1e-2)


def test_without_a_joint_rods_are_hinged_to_the_shell(tmp_path: Path) -> None:
    (tmp_path / "lsh.obj").write_text(OBJ, encoding="utf-8")
    deck = beside_shell(True) | {"joints": []}
    composed = made(tmp_path, deck)
    ends, edges = composed.geometry.turning.ends, composed.geometry.edges
    here = np.argmin(np.linalg.norm(composed.geometry.nodes - [0.1, 0.0, 0.0], axis=1))
    assert len(set(ends[edges == here])) == 2


def crossing(kind: str, **keys: Any) -> Deck:
    """Two straight rods that cross."""
    u = line("u", [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 9, **keys)
    v = line("v", [0.0, -1.0, 0.0], [0.0, 1.0, 0.0], 9)
    at = [{"nodes": {"of": name, "indices": [4]}} for name in "uv"]
    pins = [{"type": "pin", "where": f"{name}.{end}"} for name in "uv" for end in ("start", "end")]
    load = [{"type": "point", "where": {"nodes": {"of": "u", "indices": [2]}}, "force": [0.0, 0.0, -0.2]}]
    return scene(u, v, joints=[{"type": kind, "nodes": at}], motions=pins, forces=load)


def test_a_hinged_crossing_of_straight_rods_is_not_curved(tmp_path: Path) -> None:
    deck = crossing("hinge")
    assert made(tmp_path, deck).plan.bending is Bending.ISOTROPIC
    plain = solve(tmp_path, deck).frames[-1].positions
    framed = solve(tmp_path, crossing("hinge", bending="framed")).frames[-1].positions
    assert np.abs(plain[:, 2]).max() > 1e-3
    assert_allclose(plain, framed, atol=1e-8)


def test_a_welded_crossing_has_a_frame(tmp_path: Path) -> None:
    composed = made(tmp_path, crossing("rigid"))
    assert composed.plan.bending is Bending.FRAMED
    dofs = composed.simulation.model.dofs
    assert dofs.n_nodes == dofs.visible + 1


def three(*joints: Deck) -> Deck:
    """Three rods that end at one place."""
    origin = [0.0, 0.0, 0.0]
    rods = [line(name, origin, end, 5) for name, end in zip("abc", np.eye(3).tolist(), strict=True)]
    clamps = [{"type": "clamp", "where": f"{name}.end"} for name in "abc"]
    return scene(*rods, joints=list(joints), motions=clamps)


def pair(kind: str, one: str, two: str, **keys: Any) -> Deck:
    return {"type": kind, "nodes": [f"{one}.start", f"{two}.start"]} | keys


@pytest.mark.parametrize(
    ("joints", "joined"),
    [
        ([pair("rigid", "a", "b"), pair("hinge", "b", "c")], {"ab"}),
        ([pair("hinge", "b", "c"), pair("rigid", "a", "b")], {"ab"}),
        ([pair("hinge", "a", "b"), pair("hinge", "b", "c")], set()),
        ([pair("rigid", "a", "b"), pair("rigid", "c", "a")], {"ab", "bc", "ac"}),
    ],
)
def test_rigid_and_hinged_rods_meet_at_one_node(tmp_path: Path, joints: list[Deck], joined: set[str]) -> None:
    geometry = made(tmp_path, three(*joints)).geometry
    here = int(np.argmin(np.linalg.norm(geometry.nodes, axis=1)))
    edge, side = np.nonzero(geometry.edges == here)
    number = {
        geometry.rods[geometry.edge_rod[e]].name: geometry.turning.ends[e, s]
        for e, s in zip(edge, side, strict=True)
    }
    assert len(number) == 3
    assert {x + y for x, y in ("ab", "bc", "ac") if number[x] == number[y]} == joined


def test_a_released_rod_passes_what_is_left_to_its_own_partner_alone(tmp_path: Path) -> None:
    composed = made(tmp_path, three(pair("rigid", "a", "b", release="twist"), pair("hinge", "b", "c")))
    geometry = composed.geometry
    here = int(np.argmin(np.linalg.norm(geometry.nodes, axis=1)))
    edge, side = np.nonzero(geometry.edges == here)
    a, b, c = geometry.turning.ends[edge, side]
    passing = geometry.turning.passing(np.array([a, b, a]), np.array([b, c, c]))
    assert passing.tolist() == [[True, False], [False, False], [False, False]]


@pytest.mark.parametrize(
    ("joints", "message"),
    [
        (
            [pair("rigid", "a", "b"), pair("hinge", "a", "b")],
            "joints[1]: releases nothing: joints[0] welds these nodes",
        ),
        (
            [pair("rigid", "a", "b"), {"type": "hinge", "where": "a.start"}],
            "joints[0]: passes nothing but force: joints[1] releases this node",
        ),
        (
            [{"type": "hinge", "where": "a.start"}],
            "joints[0]: releases nothing: only one edge of a rod ends here",
        ),
    ],
)
def test_joints_that_do_nothing_are_refused(tmp_path: Path, joints: list[Deck], message: str) -> None:
    assert message in refused(tmp_path, three(*joints))


def lines(folder: Path, deck: Deck) -> list[str]:
    file = folder / "scene.yaml"
    file.write_text(json.dumps(deck), encoding="utf-8")
    found = inspect(file, overrides=(), profile=None, allow_outside=False)
    return [str(line) for line in found.joints]


def test_check_lists_every_joint(tmp_path: Path) -> None:
    (tmp_path / "lsh.obj").write_text(OBJ, encoding="utf-8")
    assert lines(tmp_path, beside_shell(True)) == [
        "mesh file: tag[0] + a.end at (0.1, 0, 0) m: force",
        "mesh file: tag[0] + b.start at (0.1, 0, 0) m: force",
        "joints[0]: a.end + b.start at (0.1, 0, 0) m: force, bending, twist",
    ]
    deck = three(pair("rigid", "a", "b", release="twist"), pair("hinge", "a", "c"))
    assert lines(tmp_path, deck) == [
        "joints[0]: a.start + b.start at (0, 0, 0) m: force, bending",
        "joints[1]: a.start + c.start at (0, 0, 0) m: force",
    ]
    released = crossing("rigid")
    released["joints"] = [
        {"type": "hinge", "where": {"nodes": {"of": "u", "indices": [2]}}, "release": "bending"}
    ]
    assert lines(tmp_path, released) == ["joints[0]: u[2] at (-0.5, 0, 0) m: force, twist"]


@pytest.mark.parametrize("joints", ["auto", [{"type": "auto"}], [{"type": "auto", "join": "rigid"}]])
def test_auto_welds_rods_that_touch(tmp_path: Path, joints: Any) -> None:
    named = three(pair("rigid", "a", "b"), pair("rigid", "a", "c"))
    named["forces"] = [{"type": "gravity", "acceleration": [0.3, -0.2, -9.81]}]
    found = named | {"joints": joints}
    assert_allclose(
        solve(tmp_path, found).frames[-1].positions, solve(tmp_path, named).frames[-1].positions, atol=1e-14
    )
    assert lines(tmp_path, found) == [
        f"joints[0]: {one}.start + {two}.start at (0, 0, 0) m: force, bending, twist"
        for one, two in ("ab", "ac", "bc")
    ]


def test_auto_hinges_by_pair_and_tolerance(tmp_path: Path) -> None:
    deck = three({"type": "auto", "between": ["c", "a"], "tolerance": "2 mm", "join": "hinge"})
    deck["geometry"][2]["generate"]["from"] = [0.0, 0.001, 0.0]
    assert lines(tmp_path, deck) == [
        "joints[0]: a.start + c.start at (0, 0, 0) m, 0.001 m apart at most: force"
    ]
    assert (
        "joins nothing: no nodes of two bodies lie within 2.5e-07 m of each other; the nearest are 0.001 m"
        in (refused(tmp_path, deck | {"joints": [{"type": "auto", "between": ["a", "c"]}]}))
    )


def test_auto_needs_two_bodies(tmp_path: Path) -> None:
    deck = three({"type": "auto"})
    deck["geometry"], deck["motions"] = deck["geometry"][:1], deck["motions"][:1]
    assert "joints[0]: joins nothing: the scene has one body" in refused(tmp_path, deck)


def test_auto_leaves_named_nodes_alone(tmp_path: Path) -> None:
    deck = three(pair("hinge", "a", "b"), {"type": "auto"})
    # b and c would weld; b is named
    assert lines(tmp_path, deck) == ["joints[0]: a.start + b.start at (0, 0, 0) m: force"]


@pytest.mark.parametrize(
    ("joint", "message"),
    [
        ({"tolerance": "0.2 m"}, "joints[0].tolerance: is more than half of the shortest edge, 0.25 m"),
        ({"between": ["a", "d"]}, "joints[0].between[1]: no rod is named 'd'"),
        ({"between": ["a", "a"]}, "joints[0].between: names one body twice"),
    ],
)
def test_wrong_auto_joints_are_told(tmp_path: Path, joint: Deck, message: str) -> None:
    assert message in refused(tmp_path, three({"type": "auto"} | joint))


def test_check_tells_where_clamps_act(tmp_path: Path) -> None:
    deck = three(pair("rigid", "a", "b"))
    deck["motions"] = [
        {"type": "clamp", "where": {"nodes": {"of": "a", "range": [3, 4]}}, "at": "edge"},
        {"type": "clamp", "where": "b.end"},
    ]
    said = {d.what: d.why for d in made(tmp_path, deck).plan.decisions if d.what.startswith("clamp")}
    assert list(said) == [
        "clamp motions[0] holds 2 nodes and 1 edge of rods",
        "clamp motions[1] holds 1 node and 0 edges of rods",
    ]
    edge, node = said.values()
    assert "half an edge further on than at: node" in edge
    assert "1 end of them by a wall behind it" in node
