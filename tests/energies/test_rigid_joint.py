"""Two edges joined rigidly: derivatives, stress-free rest, no net force, the turn that is its strain."""

from __future__ import annotations

import numpy as np
import pytest
from cases import (
    FULL_STIFFNESS,
    NUMPY,
    UNEQUAL,
    adapted,
    configuration,
    disturbed,
    framed_rod,
    rigid_joints,
    rotation,
)
from derivatives import Probe, assert_derivatives
from numpy.testing import assert_allclose

from dismech_cli.arrays import FloatArray
from dismech_cli.model.model import Model
from dismech_cli.model.stencil import StencilEnergy

CORNER = np.array([[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [1.2, 0.9, 0.4]])
SHARP = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.1, 0.5, 0.0]])
SIGNS = [(1, 1), (1, -1), (-1, 1), (-1, -1)]
NATURAL = {"w_0": 0.3, "w_1": -0.2, "w_2": 0.4}


def joint(x: FloatArray, walk: tuple[int, int]) -> tuple[StencilEnergy, Model]:
    """Two edges, each drawn along the walk or against it."""
    ends = [[0, 1], [1, 2]]
    model = framed_rod(
        x, np.array([e if s > 0 else e[::-1] for e, s in zip(ends, walk, strict=True)]), UNEQUAL
    )
    return rigid_joints(model), model


@pytest.mark.parametrize("walk", SIGNS)
@pytest.mark.parametrize("x", [CORNER, SHARP], ids=["corner", "sharp"])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_derivatives(x: FloatArray, walk: tuple[int, int], seed: int) -> None:
    term, model = joint(x, walk)
    q = disturbed(model, seed, 0.4) if seed else model.rest.copy()
    stored = adapted(model, q)
    assert_derivatives(
        term.having(NATURAL),
        lambda y, v: configuration(model, y, v, stored),
        q,
        np.zeros_like(q),
        model,
        driver=NUMPY,
        scale=np.full(len(q), 0.2),
    )


@pytest.mark.parametrize("walk", SIGNS)
def test_no_stress_at_rest_and_no_net_force(walk: tuple[int, int]) -> None:
    term, model = joint(CORNER, walk)
    at_rest = configuration(model, model.rest, 0.0 * model.rest, model.frames.rest(model.rest))
    probe = Probe.of(term, model, NUMPY)
    assert probe.energy(at_rest) < 1e-30
    assert_allclose(probe.residual(at_rest), 0.0, atol=1e-14)
    q = disturbed(model, 4, 0.4)
    forces = probe.residual(configuration(model, q, 0.0 * q, adapted(model, q)))[:9].reshape(3, 3)
    assert np.abs(forces).max() > 0.1
    assert_allclose(forces.sum(axis=0), 0.0, atol=1e-14)


@pytest.mark.parametrize("walk", SIGNS[:3])  # the last one walks the other way: e is f
@pytest.mark.parametrize("angle", [0.3, 2.0, 3.1])
def test_energy_is_that_of_the_turn_from_rest(walk: tuple[int, int], angle: float) -> None:
    """Edge f turned about an axis of e: w = 2 tan(angle/2) there, whatever the rest angle."""
    term, model = joint(CORNER, walk)
    tangent = (CORNER[1] - CORNER[0]) / np.linalg.norm(CORNER[1] - CORNER[0])
    x = model.rest[:9].reshape(3, 3).copy()
    # about the tangent of e, the first axis of its frame
    turned = _turn(tangent, angle)
    x[2] = x[1] + turned @ (x[2] - x[1])
    q = model.rest.copy()
    q[:9] = x.reshape(-1)
    # the directors of f follow its tangent by parallel transport; turn them to where a rigid edge has them
    stored = model.frames.rest(model.rest)
    here = model.frames.transport(stored, q)
    wanted = turned @ stored.director[:, 1]
    have = here.state.director[:, 1]
    along = here.state.tangent[:, 1]
    q[10] = np.arctan2(along @ np.cross(have, wanted), have @ wanted)
    energy = Probe.of(term, model, NUMPY).energy(configuration(model, q, 0.0 * q, stored))
    assert_allclose(energy, 0.5 * FULL_STIFFNESS[0, 0] * (2.0 * np.tan(0.5 * angle)) ** 2, rtol=1e-10)


def test_rigid_motion_costs_nothing() -> None:
    term, model = joint(SHARP, (1, -1))
    q = model.rest.copy()
    q[:9] = (SHARP @ rotation(3).T).reshape(-1)
    stored = model.frames.rest(model.rest)
    here = model.frames.transport(stored, q)
    for edge in range(2):
        wanted, have = rotation(3) @ stored.director[:, edge], here.state.director[:, edge]
        q[9 + edge] = np.arctan2(here.state.tangent[:, edge] @ np.cross(have, wanted), have @ wanted)
    assert Probe.of(term, model, NUMPY).energy(configuration(model, q, 0.0 * q, stored)) < 1e-28


def _turn(axis: FloatArray, angle: float) -> FloatArray:
    x, y, z = axis
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned: FloatArray = np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * k @ k
    return turned
