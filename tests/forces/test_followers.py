"""Follower loads: derivatives, rotation with their carriers, parts of rods and shells, what is refused."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases import (
    NUMPY,
    UNEQUAL,
    TermCase,
    adapted,
    configuration,
    disturbed,
    framed_rod,
    planar_rod,
    rotation,
    straight,
    term_cases,
    y_network,
)
from decks import given_section, line, rod_deck, solve
from derivatives import Probe, assert_derivatives, dense
from numpy.testing import assert_allclose
from shell_cases import Shell, shell
from shell_decks import SHEET, Deck, ran, refused, shell_deck, write
from shell_force_checks import CAP, check, state

from dismech_cli import load
from dismech_cli.arrays import FloatArray
from dismech_cli.compose.compose import compose
from dismech_cli.compose.structure.plan import Bending
from dismech_cli.forces.follower import Faces, FollowerForce, FramedEdges, PlanarEdges
from dismech_cli.kernels.linearization import all_symmetric
from dismech_cli.kinematics.motion import held_dofs
from dismech_cli.kinematics.rod_frames import FrameState, RodFrames
from dismech_cli.laws.laws import Constant
from dismech_cli.mesh.mesh import Mesh
from dismech_cli.model.model import Model
from dismech_cli.solve.integrators import Static
from dismech_cli.solve.pattern import SparsityPattern
from dismech_cli.solve.problem import NewtonSettings
from dismech_cli.solve.status import Status
from dismech_cli.solve.step import Stepper
from dismech_cli.solve.system import System

__all__ = ["ran", "refused", "write"]

FORCE = np.array([0.3, -0.8, 0.5])
EDGES = {name: case for name, case in term_cases().items() if name.startswith("follower")}


def on_faces(made: Shell) -> FollowerForce:
    which = np.array([0, 3, 7])
    shares = np.array([[0.5, 1.0, 0.0], [0.0, 0.7, 0.1], [0.3, 0.2, 0.9]])
    carrier = Faces.of(made.model.dofs, made.mesh.triangles[which], made.mesh.nodes)
    return FollowerForce.of("follower", carrier, shares, FORCE, Constant(1.4))


# ---------------------------------------------------------------- derivatives (random states: test_forces.py)


@pytest.mark.parametrize("bending", ["hinge", "midedge"])
def test_derivatives_on_faces(bending: str) -> None:
    made = shell(CAP, bending)
    check(on_faces(made), made)


@pytest.mark.parametrize("size", [2.0, 20.0], ids=["upside_down", "torn"])
@pytest.mark.parametrize("name", EDGES)
def test_derivatives_of_extreme_edges(name: str, size: float) -> None:
    """Edges stretched many times over, shrunk and turned upside down."""
    case = EDGES[name]
    model = case.model
    q = disturbed(model, 5, size)
    shortest = np.linalg.norm(np.diff(model.dofs.positions(q)[:2], axis=0))
    _check(case, q, 0.3 * float(shortest))


@pytest.mark.parametrize("name", EDGES)
def test_derivatives_of_a_vanishing_edge(name: str) -> None:
    """The edge is a millionth of its length long, and so is the perturbation that changes its state."""
    case = EDGES[name]
    q = case.model.rest.copy()
    tail, head = case.term.couplings[0].dofs[0, : 2 * case.model.dofs.dimension].reshape(2, -1)
    q[head] = q[tail] + 1e-6 * np.arange(1.0, len(tail) + 1.0)
    _check(case, q, 1e-7)


def _check(case: TermCase, q: FloatArray, step: float) -> None:
    model = case.model
    # frames that are stored there, wherever they came from
    stored = adapted(model, q, 50)
    scale = np.full(model.dofs.n, 0.3)
    scale[: model.dofs.n_positions] = step
    assert_derivatives(
        case.term,
        lambda q, v: configuration(model, q, v, stored),
        q,
        np.zeros(model.dofs.n),
        model,
        driver=NUMPY,
        scale=scale,
    )


@pytest.mark.parametrize("corner", [[0.5, 1e-5, 0.0], [0.5, -1.0, 0.2], [40.0, 30.0, -20.0]])
def test_derivatives_of_extreme_faces(corner: list[float]) -> None:
    """A triangle squeezed to a needle, turned inside out, and pulled far away."""
    made = shell(build_sheet(), "hinge")
    triangle = made.mesh.triangles[:1]
    carrier = Faces.of(made.model.dofs, triangle, made.mesh.nodes)
    shares = np.array([[0.5, 1.0, 0.2]])
    term = FollowerForce.of("follower", carrier, shares, FORCE, Constant(1.4))
    q = made.model.rest.copy()
    made.model.dofs.positions(q)[triangle[0]] = [[0.0, 0, 0], [1, 0, 0], corner]
    height = float(np.linalg.norm(corner[1:]))
    assert_derivatives(
        term,
        lambda q, v: state(made, q, v),
        q,
        np.zeros_like(q),
        made.model,
        driver=NUMPY,
        scale=np.full(len(q), 0.2 * min(height, 1.0)),
    )


# ---------------------------------------------------------------- turning


def residual(model: Model, term: FollowerForce, q: FloatArray, stored: FrameState) -> FloatArray:
    r = Probe.of(term, model, NUMPY).residual(configuration(model, q, np.zeros_like(q), stored))
    assert_allclose(r[model.dofs.n_positions :], 0.0, atol=0.0)  # no torque on angles
    return model.dofs.positions(-r)


@pytest.mark.parametrize("kind", ["framed", "faces"])
def test_turns_with_a_rigid_body(kind: str) -> None:
    """At rest the force as given; of a body turned as a whole the turned one."""
    if kind == "framed":
        model = framed_rod(*y_network(), UNEQUAL)
        term = EDGES["follower_framed"].term
    else:
        made = shell(CAP, "hinge")
        model, term = made.model, on_faces(made)
    assert isinstance(term, FollowerForce)
    rest = model.frames.rest(model.rest)
    here = residual(model, term, model.rest, rest)
    assert_allclose(here.sum(axis=0), 1.4 * term.shares.sum() * FORCE, rtol=1e-13)
    turn = rotation(3)
    q = model.rest.copy()
    model.dofs.positions(q)[:] = model.dofs.positions(q) @ turn.T
    turned = FrameState(turn @ rest.tangent, turn @ rest.director, rest.reference_twist)
    assert_allclose(residual(model, term, q, turned), here @ turn.T, rtol=0, atol=1e-13)


@pytest.mark.parametrize("axes", [(0, 2), (0, 1), (1, 2)])
def test_turns_in_the_plane(axes: tuple[int, int]) -> None:
    from dismech_cli.kinematics.dofs import DofMap
    from dismech_cli.kinematics.rod_frames import NoFrames

    dofs = DofMap(2, 0, axes, 2)
    nodes = dofs.embed(np.array([[0.0, 0.0], [2.0, 1.0]]))
    carrier = PlanarEdges.of(dofs, np.array([[0, 1]]), nodes)
    force = np.array([0.7, -0.4])
    term = FollowerForce.of("f", carrier, np.array([[0.0, 1.0]]), dofs.embed(force[None])[0], Constant(1.0))
    quarter = np.array([[0.0, -1.0], [1.0, 0.0]])
    q = (dofs.project(nodes) @ quarter.T).reshape(-1) * 3.0 + 5.0
    model = planar_rod(*straight(2), UNEQUAL)
    probe = Probe.of(term, model, NUMPY)
    r = probe.residual(configuration(model, q, np.zeros(4), NoFrames().rest(q)))
    assert_allclose(-r, [0.0, 0.0, *(quarter @ force)], atol=1e-15)


def test_turns_about_a_rod() -> None:
    """A twisted edge takes the lateral part of the force along, and leaves that along it."""
    x, edges = straight(3, 1.0)
    model = framed_rod(x, edges, UNEQUAL)
    rest = model.frames.rest(model.rest)
    assert isinstance(model.frames, RodFrames)
    carrier = FramedEdges.of(model.dofs, model.frames, np.array([1]), model.rest)
    term = FollowerForce.of("f", carrier, np.array([[0.0, 1.0]]), np.array([2.0, 3.0, 0.0]), Constant(1.0))
    q = model.rest.copy()
    q[model.dofs.of_angles(np.array([1]))] = 0.5 * np.pi
    force = residual(model, term, q, rest)
    assert_allclose(force, [[0, 0, 0], [0, 0, 0], [2.0, 0.0, 3.0]], atol=1e-15)


# ---------------------------------------------------------------- from scenarios


def forces_at(deck: Deck, folder: Path, turn: FloatArray | None = None) -> FloatArray:
    """Loads of a scene on its nodes at rest, or with all nodes turned."""
    file = folder / "scene.yaml"
    file.write_text(json.dumps(deck), encoding="utf-8")
    simulation = compose(load(file)).simulation
    model = simulation.model
    q = model.rest.copy()
    stored = model.frames.rest(q)
    if turn is not None:
        x = model.dofs.positions(q)
        x[:] = model.dofs.project(model.dofs.space_positions(q) @ turn.T)
        stored = FrameState(turn @ stored.tangent, turn @ stored.director, stored.reference_twist)
    terms = [t for t in model.terms if t.name in simulation.roles.loads]
    free = np.ones(model.dofs.n, dtype=np.bool_)
    couplings = [c for t in terms for c in t.couplings]
    pattern = SparsityPattern.build(model.dofs, free, couplings, symmetric=all_symmetric(couplings))
    r = np.zeros(model.dofs.n)
    for term in terms:
        term.bind(pattern, NUMPY).add_residual(configuration(model, q, q, stored, 1.0), r)
    return model.dofs.embed(model.dofs.positions(-r))


LOADS: dict[str, tuple[Deck, Deck]] = {
    "rod": (rod_deck(line(7), dimension=3), {"type": "point", "where": "rod", "force": FORCE.tolist()}),
    "rod_line": (rod_deck(line(7), dimension=3), {"type": "distributed", "force_per_length": FORCE.tolist()}),
    "planar": (rod_deck(line(7)), {"type": "point", "where": "rod.end", "force": [0.3, 0.0, 0.5]}),
    "planar_line": (rod_deck(line(7)), {"type": "distributed", "force_per_length": [0.3, 0.0, 0.5]}),
    "sheet": (
        shell_deck(body={"bending": "hinge"}),
        {"type": "point", "where": "sheet", "force": FORCE.tolist()},
    ),
    "sheet_line": (
        shell_deck(body={"bending": "hinge"}),
        {"type": "line", "where": "sheet", "force_per_length": FORCE.tolist()},
    ),
}


@pytest.mark.parametrize("name", LOADS)
def test_is_the_dead_load_at_rest_and_turns_with_the_body(tmp_path: Path, name: str) -> None:
    deck, force = LOADS[name]
    if deck["numerics"]["integrator"]["type"] != "static":
        deck = deck | {"numerics": {"integrator": {"type": "static"}}}
    dead = forces_at(deck | {"forces": [force]}, tmp_path)
    scene = deck | {"forces": [force | {"follower": True}]}
    assert_allclose(forces_at(scene, tmp_path), dead, rtol=0, atol=1e-14)
    turn = rotation(2)
    if deck.get("dimension") == 2:
        turn = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    assert_allclose(forces_at(scene, tmp_path, turn), dead @ turn.T, rtol=0, atol=1e-14)


def test_node_between_edges_takes_half_of_each(tmp_path: Path) -> None:
    """A corner opened by a right angle: half of the force stays, half turns."""
    corner = {"shape": "polyline", "points": [[0, 0, 0], [1, 0, 0], [2, 0, 0]], "nodes": 3}
    deck = rod_deck(corner) | {
        "forces": [{"type": "point", "where": {"nearest": [1, 0, 0]}, "force": [0, 0, 1], "follower": True}]
    }
    file = tmp_path / "scene.yaml"
    file.write_text(json.dumps(deck), encoding="utf-8")
    model = compose(load(file)).simulation.model
    (term,) = (t for t in model.terms if isinstance(t, FollowerForce))
    q = model.rest.copy()
    model.dofs.positions(q)[2] = [1.0, 1.0]
    c = configuration(model, q, q, model.frames.rest(q), 1.0)
    assert_allclose(-Probe.of(term, model, NUMPY).residual(c)[2:4], [-0.5, 0.5], atol=1e-15)


def test_a_straight_round_rod_gets_frames(tmp_path: Path) -> None:
    deck, force = LOADS["rod"]
    file = tmp_path / "scene.yaml"
    for follower, bending in ((False, Bending.ISOTROPIC), (True, Bending.FRAMED)):
        file.write_text(json.dumps(deck | {"forces": [force | {"follower": follower}]}), encoding="utf-8")
        plan = compose(load(file)).plan
        assert plan.bending is bending
    assert any(d.why == "a load turns with a rod" for d in plan.decisions)


def test_refusals(refused: Any, tmp_path: Path) -> None:
    _, force = LOADS["rod"]
    followers = [force | {"follower": True}]
    deck = rod_deck(line(5), dimension=3, rod={"bending": "isotropic"}, forces=followers)
    assert "isotropic bending is not exact here: a load turns with a rod" in refused(deck)
    assert "has a part in y, out of the plane" in refused(rod_deck(line(5), forces=followers))
    probes = {"probes": {"negative": {"negative_eigenvalues": True}}}
    assert "unsymmetric" in refused(rod_deck(line(5), dimension=3, forces=followers, output=probes))
    sides = {"type": "line", "where": {"nearest": [0, 0, 0]}, "force_per_length": [0, 0, 1], "follower": True}
    assert "selects no edge of a shell" in refused(shell_deck(SHEET, forces=[sides]))


# ---------------------------------------------------------------- balance


def test_tangent_in_balance(tmp_path: Path) -> None:
    """A rod bent and twisted in space: elastic and load tangents make up the derivative of the balance.

    Follower forces leave no torque on the angles, so no skew part of the elastic energies is missing.
    """
    forces: list[Deck] = [
        {"type": "point", "where": "rod.end", "force": [1.0, 2.0, 3.0], "follower": True},
        {"type": "distributed", "force_per_length": [0.0, -2.0, 1.0], "follower": True},
    ]
    section = given_section(axial=100.0, bending_2=2.0, torsion=0.7)
    deck = rod_deck(line(9), section, dimension=3, forces=forces)
    file = tmp_path / "scene.yaml"
    file.write_text(json.dumps(deck), encoding="utf-8")
    model = compose(load(file)).simulation.model
    stepper = Stepper(model, Static(), NewtonSettings(), "auto")
    state = stepper.prepare(stepper.rest_state())
    for _ in range(4):
        result = stepper.step(state, 0.25)
        assert result.status is Status.CONVERGED
        state = result.state
    system = System(model, ~held_dofs(model.motions, model.dofs.n, 0.0))
    stage, free = Static().stage(0, state, state, 0.0), system.pattern.free
    tangent = dense(system.pattern, system.linearize(stage, state.q, state.frames).values)

    def balance(q: FloatArray) -> FloatArray:
        return system.linearize(stage, q, state.frames).residual[free].copy()

    h = 1e-6
    steps = h * np.eye(model.dofs.n)[free]
    slope = np.stack([(balance(state.q + d) - balance(state.q - d)) / (2.0 * h) for d in steps], axis=1)
    # differences: h^2 of the slope, and round-off over h
    assert_allclose(tangent, slope, rtol=0, atol=1e-8 * np.abs(slope).max())


# ---------------------------------------------------------------- invariance of answers


def test_rod_scene_turned_as_a_whole(tmp_path: Path) -> None:
    """A rod clamped along any direction, pushed sideways and back: the same shape, turned."""
    ends = []
    for turn in (np.eye(3), rotation(1), rotation(7)):
        deck = rod_deck(
            line(16, (turn @ [1.0, 0.0, 0.0]).tolist()),
            dimension=3,
            forces=[
                {
                    "type": "point",
                    "where": "rod.end",
                    "force": (turn @ [-1.0, 2.0, 4.0]).tolist(),
                    "follower": True,
                },
                {
                    "type": "distributed",
                    "force_per_length": (turn @ [0.0, 3.0, 0.0]).tolist(),
                    "follower": True,
                },
            ],
        )
        ends.append(solve(tmp_path, deck).frames[-1].positions @ turn)
    assert np.abs(ends[0] - solve(tmp_path, deck).frames[0].positions @ turn).max() > 0.3
    for end in ends[1:]:
        assert_allclose(end, ends[0], atol=1e-8)


def test_shell_scene_turned_as_a_whole(tmp_path: Path, ran: Any) -> None:
    ends = []
    sheet = build_sheet()
    for turn in (np.eye(3), rotation(4)):
        x = sheet.nodes @ turn.T
        lines = ["v " + " ".join(f"{value:.17g}" for value in row) for row in x]
        lines += ["f " + " ".join(str(k + 1) for k in row) for row in sheet.triangles]
        (tmp_path / "sheet.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")
        left, right = ({"of": "sheet", "indices": k.tolist()} for k in (sheet_side(0.0), sheet_side(0.3)))
        deck = shell_deck(
            motions=[{"type": "clamp", "where": {"nodes": left}}],
            forces=[
                {
                    "type": "line",
                    "where": {"nodes": right},
                    "force_per_length": (turn @ [0.0, 0.02, 0.2]).tolist(),
                    "follower": True,
                }
            ],
            numerics={"integrator": {"type": "static", "load_steps": 4}},
        )
        body = deck["geometry"][0]
        del body["generate"]
        body["mesh"] = {"file": "sheet.obj"}
        frames = ran(deck).frames
        ends.append(frames[-1].positions @ turn)
    assert np.abs(ends[0] - sheet.nodes).max() > 0.05
    assert_allclose(ends[1], ends[0], atol=1e-8)


def build_sheet() -> Mesh:
    from dismech_cli.mesh.generate.sheets import Pattern, sheet

    return sheet(0.3, 0.2, 6, Pattern.ALTERNATING)


def sheet_side(x: float) -> np.ndarray:
    return np.flatnonzero(np.abs(build_sheet().nodes[:, 0] - x) < 1e-12)
