"""What must not matter: place, orientation, numbering, direction of edges, choice of frame, model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cases import (
    NUMPY,
    UNEQUAL,
    adapted,
    chain,
    configuration,
    disturbed,
    framed_rod,
    helix,
    isotropic_rod,
    planar_rod,
    ring,
    rotation,
    y_network,
)
from derivatives import Probe
from numpy.testing import assert_allclose

from dismech_cli.arrays import FloatArray, IntArray
from dismech_cli.kinematics.rod_frames import FrameState
from dismech_cli.model.configuration import Configuration
from dismech_cli.model.model import Model

ROUND = replace(UNEQUAL, bending_2=UNEQUAL.bending_1)
SHAPES = {"helix": helix(6), "network": y_network(), "ring": ring(8)}
BUILDERS = {"isotropic": isotropic_rod, "framed": framed_rod}
MODELS = {f"{kind}-{shape}": BUILDERS[kind](*SHAPES[shape], UNEQUAL) for kind in BUILDERS for shape in SHAPES}


def energy(model: Model, c: Configuration) -> float:
    return sum(Probe.of(term, model, NUMPY).energy(c) for term in model.terms)


def forces(model: Model, c: Configuration) -> FloatArray:
    return np.sum([Probe.of(term, model, NUMPY).residual(c) for term in model.terms], axis=0)


def at(model: Model, q: FloatArray, stored: FrameState) -> Configuration:
    return configuration(model, q, np.zeros_like(q), stored)


def moved(model: Model, q: FloatArray, turn: FloatArray, shift: FloatArray) -> FloatArray:
    out = q.copy()
    out[: model.dofs.n_positions] = (model.dofs.positions(q) @ turn.T + shift).reshape(-1)
    return out


@pytest.mark.parametrize("name", MODELS)
def test_rigid_motion(name: str) -> None:
    """The whole model, frames included, moved: same energy, forces turned along."""
    model = MODELS[name]
    q = disturbed(model, seed=5)
    stored = adapted(model, q)
    turn, shift = rotation(1), np.array([3.0, -1.0, 2.0])
    turned = FrameState(turn @ stored.tangent, turn @ stored.director, stored.reference_twist)
    here, there = at(model, q, stored), at(model, moved(model, q, turn, shift), turned)
    assert energy(model, here) > 0.01
    assert_allclose(energy(model, there), energy(model, here), rtol=1e-12)
    f = forces(model, here)
    expected = moved(model, f, turn, np.zeros(3))
    assert_allclose(forces(model, there), expected, rtol=0, atol=1e-12 * np.abs(f).max())


@pytest.mark.parametrize("name", MODELS)
def test_rigid_motion_in_time(name: str) -> None:
    """Moved as a rigid body, with frames transported along the way, a model stays as strained as it was.

    Here the reference frames do not turn along: they are transported, and the angle of every edge
    changes with them. Turning steadily about a fixed axis, each edge gathers holonomy; the twist
    between edges must not, so the angles are re-measured from the turned material directors.
    """
    model = MODELS[name]
    q = disturbed(model, seed=5)
    stored = adapted(model, q)
    before = energy(model, at(model, q, stored))
    n = model.dofs.n_angles
    axis = np.array([0.3, -0.5, 0.8])
    axis /= np.linalg.norm(axis)
    k = np.cross(np.eye(3), axis).T
    step = 2.0 * np.pi / 50
    turn = np.eye(3) + np.sin(step) * k + (1.0 - np.cos(step)) * k @ k
    state = q.copy()
    for _ in range(60):
        new = moved(model, state, turn, np.array([0.01, 0.0, 0.02]))
        if n:
            old = model.frames.transport(stored, state)
            places = model.frames.director_places(np.arange(n))[:, :3]
            material = turn @ old.auxiliary[places].T
            a1 = model.frames.transport(stored, new).state.director
            tangent = model.frames.transport(stored, new).state.tangent
            angle = np.arctan2(
                (tangent * np.cross(a1.T, material.T).T).sum(axis=0), (a1 * material).sum(axis=0)
            )
            theta = new[-n:]
            new[-n:] = theta + (angle - theta + np.pi) % (2.0 * np.pi) - np.pi
            stored = model.frames.transport(stored, new).state
        state = new
    assert np.abs(state - q).max() > 0.5
    # 60 transports with an ulp each
    assert_allclose(energy(model, at(model, state, stored)), before, rtol=1e-11)


@pytest.mark.parametrize("name", MODELS)
def test_internal_forces_have_no_resultant(name: str) -> None:
    """Sum of forces and sum of x cross f vanish; the torques on angles act about the tangents."""
    model = MODELS[name]
    q = disturbed(model, seed=6)
    stored = adapted(model, q)
    c = at(model, q, stored)
    f = forces(model, c)
    x, g = model.dofs.positions(q), model.dofs.positions(f)
    size = np.abs(f).max()
    moment = np.cross(x, g).sum(axis=0)
    if model.dofs.n_angles:
        moment += c.frames.state.tangent @ f[model.dofs.n_positions :]
    assert_allclose(g.sum(axis=0), 0.0, atol=1e-13 * size)
    assert_allclose(moment, 0.0, atol=1e-12 * size)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("build", [planar_rod, framed_rod])
def test_curved_rest_shape_is_stress_free(build: object, shape: str) -> None:
    """No force at rest, to the round-off of strains times stiffness, |K| |x| eps."""
    nodes, edges = SHAPES[shape]
    if build is planar_rod:
        nodes = nodes @ np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.7]])
    model = build(nodes, edges, UNEQUAL)
    c = at(model, model.rest, model.frames.rest(model.rest))
    stiffness = max(np.abs(Probe.of(t, model, NUMPY).tangents(c)[0]).max() for t in model.terms)
    assert stiffness > 1.0
    assert np.abs(forces(model, c)).max() < 1e-14 * stiffness
    assert energy(model, c) < 1e-28 * stiffness


def test_choice_of_reference_frame() -> None:
    """Reference directors turned by any angle, theta turned back: nothing changes."""
    nodes, edges = y_network()
    model = framed_rod(nodes, edges, UNEQUAL)
    q = disturbed(model, seed=7)
    stored = adapted(model, q)
    angles = np.array([0.5, -1.0, 2.0, -2.5, 0.1, 3.0])
    t, a1 = stored.tangent, stored.director
    turned = np.cos(angles) * a1 + np.sin(angles) * np.cross(t.T, a1.T).T
    # the reference twist of a joint changes by the turn of f less that of e, signed as walked
    frames = model.frames
    pairs, signs = frames.joint_edges, frames.joint_signs
    change = signs[:, 1] * angles[pairs[:, 1]] - signs[:, 0] * angles[pairs[:, 0]]
    other = FrameState(t, turned, stored.reference_twist + change)
    q_other = q.copy()
    q_other[model.dofs.n_positions :] -= angles
    one, two = at(model, q, stored), at(model, q_other, other)
    assert_allclose(energy(model, two), energy(model, one), rtol=1e-13)
    f = forces(model, one)
    assert_allclose(forces(model, two), f, rtol=0, atol=1e-12 * np.abs(f).max())
    for term in model.terms:
        probe = Probe.of(term, model, NUMPY)
        k = probe.tangents(one)[0]
        assert_allclose(probe.tangents(two)[0], k, rtol=0, atol=1e-12 * np.abs(k).max())


def _relabelled(
    nodes: FloatArray, edges: IntArray, seed: int
) -> tuple[FloatArray, IntArray, IntArray, IntArray]:
    rng = np.random.default_rng(seed)
    new_of_node, order = rng.permutation(len(nodes)), rng.permutation(len(edges))
    shuffled = np.empty_like(nodes)
    shuffled[new_of_node] = nodes
    return shuffled, new_of_node[edges[order]], new_of_node, order


@pytest.mark.parametrize("kind", ["isotropic", "framed"])
@pytest.mark.parametrize("shape", SHAPES)
def test_relabelling(kind: str, shape: str) -> None:
    """Other numbers of nodes and edges, same directors: same forces."""
    nodes, edges = SHAPES[shape]
    model = BUILDERS[kind](nodes, edges, UNEQUAL)
    shuffled, renumbered, new_of_node, order = _relabelled(nodes, edges, seed=8)
    if kind == "framed":
        directors = model.frames.rest(model.rest).director.T
        other = framed_rod(shuffled, renumbered, UNEQUAL, directors=directors[order])
    else:
        other = isotropic_rod(shuffled, renumbered, UNEQUAL)
    q = disturbed(model, seed=9)
    p = other.rest.copy()
    dofs = np.concatenate(
        (
            model.dofs.of_nodes(np.argsort(new_of_node)).reshape(-1),
            model.dofs.n_positions + order if kind == "framed" else np.empty(0, dtype=np.int64),
        )
    )
    p[:] = q[dofs]
    f = forces(model, at(model, q, adapted(model, q)))
    g = forces(other, at(other, p, adapted(other, p)))
    assert_allclose(g, f[dofs], rtol=0, atol=1e-12 * np.abs(f).max())


def test_reversal_of_edges() -> None:
    """An edge walked the other way keeps m1, turns m2 and theta: forces on nodes stay, torques change sign.

    Reversing every edge that reverses nothing else exercises every combination of signs at a joint.
    """
    nodes, edges = y_network()
    model = framed_rod(nodes, edges, UNEQUAL)
    directors = model.frames.rest(model.rest).director.T
    q = disturbed(model, seed=10)
    f = forces(model, at(model, q, adapted(model, q)))
    for reversed_edges in ([0], [1, 3], [0, 2, 4], [0, 1, 2, 3, 4, 5]):
        flipped = edges.copy()
        flipped[reversed_edges] = edges[reversed_edges][:, ::-1]
        other = framed_rod(nodes, flipped, UNEQUAL, directors=directors)
        sign = np.ones(model.dofs.n)
        sign[model.dofs.n_positions + np.array(reversed_edges)] = -1.0
        p = q * sign
        g = forces(other, at(other, p, adapted(other, p)))
        assert_allclose(g * sign, f, rtol=0, atol=1e-12 * np.abs(f).max())


# ---------------------------------------------------------------- equal models


def _planar_state(model: Model) -> FloatArray:
    """The same bent and stretched shape in the xz plane for every model."""
    s = np.linspace(0.0, 1.0, 6) ** 1.2
    x = np.stack((np.sin(2.0 * s), 0.0 * s, 1.1 * (1.0 - np.cos(2.0 * s))), axis=1)
    q = np.zeros(model.dofs.n)
    q[: model.dofs.n_positions] = model.dofs.project(x).reshape(-1)
    return q


def test_three_models_agree_in_the_plane() -> None:
    """Energies, in-plane forces and in-plane stiffness to 1e-12; no force out of the plane."""
    nodes = np.zeros((6, 3))
    nodes[:, 0] = [0.0, 0.3, 0.5, 0.9, 1.2, 1.4]
    results = []
    for build in (planar_rod, isotropic_rod, framed_rod):
        model = build(nodes, chain(6), ROUND)
        q = _planar_state(model)
        # frames may be stored where they like on the way: all lie in the plane
        c = at(model, q, model.frames.rest(model.rest))
        k = np.sum([Probe.of(t, model, NUMPY).tangents(c)[0] for t in model.terms], axis=0)
        keep = model.dofs.of_nodes(np.arange(6))[
            :, [model.dofs.axes.index(0), model.dofs.axes.index(2)]
        ].reshape(-1)
        f = forces(model, c)
        out = np.setdiff1d(np.arange(model.dofs.n), keep)
        assert_allclose(f[out], 0.0, atol=1e-13 * np.abs(f).max())
        results.append((energy(model, c), f[keep], k[np.ix_(keep, keep)]))
    for e, f, k in results[1:]:
        assert_allclose(e, results[0][0], rtol=1e-12)
        assert_allclose(f, results[0][1], rtol=0, atol=1e-12 * np.abs(f).max())
        assert_allclose(k, results[0][2], rtol=0, atol=1e-12 * np.abs(k).max())


def test_framed_rod_without_twist_bends_isotropically_in_space() -> None:
    """With angles that undo the reference twist, a straight round rod has the isotropic energy and forces."""
    nodes = np.zeros((6, 3))
    nodes[:, 0] = np.linspace(0.0, 1.0, 6)
    framed, free = (build(nodes, chain(6), ROUND) for build in (framed_rod, isotropic_rod))
    p = disturbed(free, seed=11)
    q = np.concatenate((p, np.zeros(5)))
    stored = adapted(framed, q)
    q[-5:] = -np.concatenate(([0.0], np.cumsum(stored.reference_twist)))
    assert np.abs(q[-5:]).max() > 1e-3
    c, d = at(framed, q, stored), at(free, p, free.frames.rest(p))
    assert_allclose(energy(framed, c), energy(free, d), rtol=1e-13)
    f, g = forces(framed, c), forces(free, d)
    assert_allclose(f[: len(g)], g, rtol=0, atol=1e-12 * np.abs(g).max())
    assert_allclose(f[len(g) :], 0.0, atol=1e-13 * np.abs(g).max())
