"""The weld of a rod to a face: derivatives, invariance, what it resists and what it ignores."""

from __future__ import annotations

import numpy as np
import pytest
from cases import NUMPY, adapted, configuration, disturbed
from derivatives import Probe, assert_derivatives
from hybrid_cases import FACES, NODES, STIFFNESS, hybrid
from numpy.testing import assert_allclose

from dismech_cli.arrays import FloatArray
from dismech_cli.geometry.face_rotation import face_axes, face_frame
from dismech_cli.kinematics.rod_frames import FrameState
from dismech_cli.model.model import Model
from dismech_cli.model.stencil import StencilEnergy


def terms(toward: bool) -> tuple[Model, tuple[StencilEnergy, ...]]:
    made = hybrid(toward)
    return made.model, (made.on, made.beside)


def energy(model: Model, term: StencilEnergy, q: FloatArray, stored: FrameState) -> float:
    return Probe.of(term, model, NUMPY).energy(configuration(model, q, np.zeros_like(q), stored))


def about(axis: FloatArray, angle: float) -> FloatArray:
    """Rotation matrix."""
    k = np.cross(np.eye(3), axis / np.linalg.norm(axis)).T
    return np.asarray(np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * k @ k)


NATURAL = {"n_0": 0.4, "n_1": -0.3, "n_2": 0.2}


@pytest.mark.parametrize("natural", [{}, NATURAL], ids=["at rest", "grown"])
@pytest.mark.parametrize("toward", [True, False])
@pytest.mark.parametrize("part", [0.0, 0.05, 0.3])
def test_derivatives(toward: bool, part: float, natural: dict[str, float]) -> None:
    """At rest, slightly and largely disturbed, the rod's edge running to the joint or from it."""
    model, found = terms(toward)
    found = tuple(term.having(natural) for term in found)
    q = model.rest + part * (disturbed(model, seed=3, size=1.0) - model.rest)
    stored = adapted(model, q)
    scale = np.full(len(q), 0.1)
    for term in found:
        assert_derivatives(
            term,
            lambda x, v: configuration(model, x, v, stored),
            q,
            np.zeros_like(q),
            model,
            driver=NUMPY,
            scale=scale,
        )


@pytest.mark.parametrize("toward", [True, False])
def test_compiled_text_gives_the_same(toward: bool) -> None:
    pytest.importorskip("numba")
    from dismech_cli.kernels.numba_driver import NumbaDriver

    model, found = terms(toward)
    q = disturbed(model, seed=4)
    c = configuration(model, q, np.zeros_like(q), adapted(model, q))
    for term in found:
        plain, fast = (Probe.of(term, model, driver) for driver in (NUMPY, NumbaDriver()))
        assert_allclose(fast.energy(c), plain.energy(c), rtol=1e-12)
        k = plain.tangents(c)[0]
        assert_allclose(fast.tangents(c)[0], k, rtol=0, atol=1e-12 * np.abs(k).max())


def test_rest_is_free_of_stress() -> None:
    model, found = terms(False)
    stored = model.frames.rest(model.rest)
    c = configuration(model, model.rest, np.zeros_like(model.rest), stored)
    for term in found:
        # angles of an ulp
        assert_allclose(Probe.of(term, model, NUMPY).residual(c), 0.0, atol=1e-15)


def test_rigid_motions_cost_nothing() -> None:
    """Same energy, forces turned along; no net force, no net moment: the angle's is about the tangent."""
    model, found = terms(True)
    q = disturbed(model, seed=5)
    stored = adapted(model, q)
    turn, shift = about(np.array([0.3, -0.5, 0.8]), 2.0), np.array([3.0, -1.0, 2.0])
    turned = FrameState(turn @ stored.tangent, turn @ stored.director, stored.reference_twist)
    split = model.dofs.n_positions
    moved = q.copy()
    moved[:split] = (q[:split].reshape(-1, 3) @ turn.T + shift).reshape(-1)
    for term in found:
        probe = Probe.of(term, model, NUMPY)
        here = configuration(model, q, np.zeros_like(q), stored)
        there = configuration(model, moved, np.zeros_like(q), turned)
        assert probe.energy(here) > 1e-3
        assert_allclose(probe.energy(there), probe.energy(here), rtol=1e-12)
        r, s = probe.residual(here), probe.residual(there)
        f, size = r[:split].reshape(-1, 3), float(np.abs(r).max())
        assert_allclose(s[:split].reshape(-1, 3), f @ turn.T, rtol=0, atol=1e-12 * size)
        assert_allclose(f.sum(axis=0), 0.0, atol=1e-13 * size)
        moment = np.cross(q[:split].reshape(-1, 3), f).sum(axis=0)
        moment += here.frames.state.tangent @ r[split:]
        assert_allclose(moment, 0.0, atol=1e-12 * size)


@pytest.mark.parametrize("toward", [True, False])
@pytest.mark.parametrize("which", [0, 1, 2])
def test_turning_the_faces_against_the_rod(toward: bool, which: int) -> None:
    """About each axis of the rod's frame by phi: K (2 tan(phi/2))^2 / 2, far beyond small angles."""
    model, found = terms(toward)
    phi = 1.2
    stored = model.frames.rest(model.rest)
    a1 = stored.director[:, 0]
    tangent = NODES[1] - NODES[0]
    axis = (tangent, a1, np.cross(tangent, a1))[which]
    x = NODES.copy()
    x[1:] = (x[1:] - x[1]) @ about(axis, phi).T + x[1]
    q = model.rest.copy()
    q[: x.size] = x.reshape(-1)
    for k, term in enumerate(found):
        expected = 0.5 * STIFFNESS[which, k] * (2.0 * np.tan(0.5 * phi)) ** 2
        assert_allclose(energy(model, term, q, stored), expected, rtol=1e-13)


@pytest.mark.parametrize("toward", [True, False])
def test_twisting_the_rod(toward: bool) -> None:
    model, found = terms(toward)
    q = model.rest.copy()
    q[model.dofs.n_positions] = 0.9
    for k, term in enumerate(found):
        expected = 0.5 * STIFFNESS[0, k] * (2.0 * np.tan(0.45)) ** 2
        assert_allclose(energy(model, term, q, model.frames.rest(model.rest)), expected, rtol=1e-13)


@pytest.mark.parametrize("twist", [0.0, 0.8, -2.5])
def test_bending_does_not_know_of_twist(twist: float) -> None:
    """Round rods: twisted, then bent, the joint has both energies, none more."""
    model, (term, _) = terms(True)
    term = term.having({"K_2": term.parameter("K_1")})
    stored = model.frames.rest(model.rest)
    tangent = NODES[1] - NODES[0]
    x = NODES.copy()
    turn = about(np.cross(tangent, [0.3, 0.4, -0.8]), 0.7) @ about(tangent, twist)
    x[1:] = (x[1:] - x[1]) @ turn.T + x[1]
    q = model.rest.copy()
    q[: x.size] = x.reshape(-1)
    strains = 2.0 * np.tan(0.5 * np.array([twist, 0.7]))
    expected = 0.5 * STIFFNESS[:2, 0] @ strains**2
    assert_allclose(energy(model, term, q, stored), expected, rtol=1e-12)


def test_stretching_a_face_turns_no_rod() -> None:
    """In any direction within the face, and by any amount: its rotation is that of polar decomposition."""
    model, found = terms(True)
    for k, face in enumerate(FACES):
        x = NODES.copy()
        origin = x[1] if 1 in face else x[face[0]]
        u, v = x[face[1]] - x[face[0]], x[face[2]] - x[face[0]]
        along = 0.3 * u + 0.8 * v
        along /= np.linalg.norm(along)
        for node in face:
            x[node] += 0.7 * ((x[node] - origin) @ along) * along
        q = model.rest.copy()
        q[: x.size] = x.reshape(-1)
        assert energy(model, found[k], q, model.frames.rest(model.rest)) < 1e-28


def test_the_frame_of_a_face_is_its_polar_rotation() -> None:
    from scipy.linalg import polar

    rng = np.random.default_rng(8)
    for _ in range(10):
        u0, v0, u, v = rng.normal(size=(4, 3))
        (alpha, beta_u, beta_v), axes = (z.squeeze() for z in face_axes(u0[None], v0[None]))
        n0, n = (np.cross(a, b) / np.linalg.norm(np.cross(a, b)) for a, b in ((u0, v0), (u, v)))
        gradient = np.column_stack((u, v, n)) @ np.linalg.inv(np.column_stack((u0, v0, n0)))
        rotation, _ = polar(gradient)
        f, h, m, *_ = face_frame(tuple(u), tuple(v), alpha, beta_u, beta_v)
        assert_allclose(np.stack((f, h, m)), axes @ rotation.T, atol=1e-12)
