"""Parallel transport, signed angles, reference twist."""

from __future__ import annotations

import numpy as np
import pytest
from cases import NUMPY, UNEQUAL, chain, configuration, energy_of, framed_rod, helix, y_network
from derivatives import Probe
from numpy.testing import assert_allclose

from dismech_cli.arrays import FloatArray
from dismech_cli.geometry.rotation import parallel_transport, rotate_about, signed_angle
from dismech_cli.kinematics.rod_frames import FrameState, RodFrames


def unit(x: FloatArray) -> FloatArray:
    return x / np.linalg.norm(x)


def transported(u: FloatArray, t0: FloatArray, t1: FloatArray) -> FloatArray:
    return np.array(parallel_transport(tuple(u), tuple(t0), tuple(t1)))


def _apart(angle: float, seed: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Two unit tangents at an angle, with the unit normal of their plane."""
    rng = np.random.default_rng(seed)
    t0 = unit(rng.normal(size=3))
    normal = unit(np.cross(t0, rng.normal(size=3)))
    t1 = np.cos(angle) * t0 + np.sin(angle) * np.cross(normal, t0)
    return t0, unit(t1), normal


ANGLES = [0.0, 1e-12, 1e-6, 0.5, np.pi / 2, 2.0, np.pi - 1e-3, np.pi - 1e-6]


@pytest.mark.parametrize("angle", ANGLES)
def test_transport_is_the_rotation_in_the_plane_of_the_tangents(angle: float) -> None:
    """Tangent to tangent, normal kept, lengths and angles kept.

    The plane of nearly antiparallel tangents is known to eps / sin(angle); 1 / (1 + cos) would
    lose eps / sin(angle)^2.
    """
    t0, t1, normal = _apart(angle, seed=3)
    atol = 5e-15 / (np.sin(angle) if angle > 1.0 else 1.0)
    p = np.stack([transported(x, t0, t1) for x in np.eye(3)], axis=1)
    assert_allclose(p @ t0, t1, rtol=0, atol=atol)
    assert_allclose(p @ normal, normal, rtol=0, atol=atol)
    assert_allclose(p.T @ p, np.eye(3), rtol=0, atol=atol)
    assert_allclose(np.linalg.det(p), 1.0, rtol=0, atol=atol)


def test_transport_between_exactly_antiparallel_tangents_is_finite() -> None:
    """No plane is defined: a director normal to both comes back normal and of unit length."""
    t = unit(np.array([1.0, -2.0, 0.5]))
    u = unit(np.cross(t, [0.0, 0.0, 1.0]))
    with np.errstate(all="raise"):
        out = transported(u, t, -t)
    assert abs(out @ t) < 1e-15
    assert_allclose(np.linalg.norm(out), 1.0, rtol=1e-15)


@pytest.mark.parametrize("degrees", [-179.999, -90.0, -30.0, 0.0, 1e-7, 45.0, 90.0, 179.0, 180.0])
def test_signed_angle(degrees: float) -> None:
    """Also at 90 and 180 degrees, where other formulas break."""
    t = unit(np.array([0.3, -0.8, 0.5]))
    u = unit(np.cross(t, [1.0, 0.0, 0.0]))
    v = rotate_about(tuple(u), tuple(t), np.deg2rad(degrees))
    angle = np.rad2deg(signed_angle(tuple(u), v, tuple(t)))
    assert_allclose(abs(angle) if degrees == 180.0 else angle, degrees, rtol=1e-14, atol=1e-14)


@pytest.mark.parametrize("shape", [helix(6), y_network()], ids=["helix", "network"])
def test_rest_frames_are_orthonormal_and_follow_the_rule(shape: tuple[FloatArray, FloatArray]) -> None:
    nodes, edges = shape
    model = framed_rod(nodes, edges, UNEQUAL)
    stored = model.frames.rest(model.rest)
    t, a1 = stored.tangent.T, stored.director.T
    assert_allclose((t * a1).sum(axis=1), 0.0, atol=1e-15)
    assert_allclose((a1 * a1).sum(axis=1), 1.0, rtol=1e-15)
    assert_allclose(a1[0], unit(np.cross(t[0], [0.0, 1.0, 0.0])), atol=1e-15)
    assert_allclose(a1[1], transported(a1[0], t[0], t[1]), atol=1e-15)


def test_first_director_of_a_rod_along_y() -> None:
    """t x y vanishes: the rule falls back to t x -z."""
    model = framed_rod(np.array([[0.0, 0, 0], [0, 1, 0]]), chain(2), UNEQUAL)
    assert_allclose(model.frames.rest(model.rest).director[:, 0], [-1.0, 0.0, 0.0], atol=1e-15)


def test_given_directors_are_kept() -> None:
    nodes, edges = helix(4)
    given = np.full((3, 3), np.nan)
    given[1] = [0.0, 0.0, 2.0]
    stored = framed_rod(nodes, edges, UNEQUAL, directors=given).frames.rest(
        np.concatenate((nodes.reshape(-1), np.zeros(3)))
    )
    t = stored.tangent[:, 1]
    assert_allclose(stored.director[:, 1], unit(np.array([0, 0, 1.0]) - t[2] * t), atol=1e-15)


def test_antiparallel_neighbours_have_rest_frames() -> None:
    """Edges of consecutive numbers may run opposite ways, as in a network: frames stay orthonormal."""
    nodes = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]])
    model = framed_rod(nodes, np.array([[0, 1], [2, 1]]), UNEQUAL)
    stored = model.frames.rest(model.rest)
    assert_allclose(stored.director.T, [[0, 0, 1], [0, 0, 1]], atol=1e-15)
    assert_allclose(stored.reference_twist, 0.0, atol=1e-15)


def _cone(azimuth: float, colatitude: float) -> FloatArray:
    return np.array(
        [
            np.cos(colatitude),
            np.sin(colatitude) * np.cos(azimuth),
            np.sin(colatitude) * np.sin(azimuth),
        ]
    )


@pytest.mark.parametrize("colatitude", [0.4, 2.2])
def test_reference_twist_of_a_hundred_turns(colatitude: float) -> None:
    """An edge driven around a cone a hundred times gathers the cone's solid angle each time.

    The path is a spherical polygon; its area is that of its triangles with the pole,
    tan(A/2) = tan^2(c/2) sin(C) / (1 + tan^2(c/2) cos(C)), C = 2 pi / corners. One turn around the
    wide cone exceeds 2 pi: nothing may wrap.
    """
    corners, turns = 12, 100
    nodes = np.array([[-1.0, 0, 0], [0, 0, 0], _cone(0.0, colatitude)])
    model = framed_rod(nodes, chain(3), UNEQUAL)
    stored = model.frames.rest(model.rest)
    start = stored.reference_twist[0]
    for k in range(1, corners * turns + 1):
        q = model.rest.copy()
        q[6:9] = _cone(2.0 * np.pi * k / corners, colatitude)
        stored = model.frames.transport(stored, q).state
    c, w = 2.0 * np.pi / corners, np.tan(colatitude / 2.0) ** 2
    triangle = 2.0 * np.arctan2(w * np.sin(c), 1.0 + w * np.cos(c))
    gathered = turns * corners * triangle
    assert gathered > (200.0 * np.pi if colatitude > 2.0 else 1.0)
    # 1200 transports, an ulp of the sum each
    assert_allclose(abs(stored.reference_twist[0] - start), gathered, rtol=1e-12)


def test_material_twist_of_a_hundred_turns() -> None:
    """Angles are never wrapped: E = GJ (200 pi)^2 / (2 l)."""
    nodes = np.array([[0.0, 0, 0], [1.0, 0, 0], [2.0, 0, 0]])
    model = framed_rod(nodes, chain(3), UNEQUAL)
    q = model.rest.copy()
    q[-1] = 200.0 * np.pi
    c = configuration(model, q, np.zeros_like(q), model.frames.rest(model.rest))
    energy = Probe.of(energy_of(model, "bend_twist"), model, NUMPY).energy(c)
    assert_allclose(energy, 0.5 * UNEQUAL.torsional * (200.0 * np.pi) ** 2, rtol=1e-13)


def test_places_of_the_auxiliary_array() -> None:
    """Directors that theta has turned and the reference twists, each number in one place."""
    nodes, edges = y_network()
    model = framed_rod(nodes, edges, UNEQUAL)
    frames = model.frames
    assert isinstance(frames, RodFrames)
    theta, joints = np.linspace(-2.0, 2.0, len(edges)), np.arange(len(frames.joint_edges))
    trial = frames.transport(frames.rest(model.rest), np.concatenate((nodes.reshape(-1), theta)))
    directors, twists = frames.director_places(np.arange(len(edges))), frames.twist_places(joints)
    t, a1 = trial.state.tangent.T, trial.state.director.T
    a2, c, s = np.cross(t, a1), np.cos(theta)[:, None], np.sin(theta)[:, None]
    assert_allclose(trial.auxiliary[directors], np.hstack((c * a1 + s * a2, c * a2 - s * a1)), atol=1e-15)
    assert np.array_equal(trial.auxiliary[twists], trial.state.reference_twist)
    assert np.array_equal(np.sort(np.concatenate((directors.reshape(-1), twists))), np.arange(frames.size))
    assert len(trial.auxiliary) == frames.size


def test_rejected_trials_leave_no_trace() -> None:
    """Transport reads stored frames and makes new ones: trying a far state changes nothing."""
    nodes, edges = helix(5)
    model = framed_rod(nodes, edges, UNEQUAL)
    stored = model.frames.rest(model.rest)
    copy = FrameState(stored.tangent.copy(), stored.director.copy(), stored.reference_twist.copy())
    before = model.frames.transport(stored, model.rest).auxiliary
    model.frames.transport(stored, model.rest + np.random.default_rng(0).normal(size=model.dofs.n))
    after = model.frames.transport(stored, model.rest).auxiliary
    assert np.array_equal(before, after)
    assert np.array_equal(stored.director, copy.director)
