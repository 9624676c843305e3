"""Moments on sides of shells: derivatives, virtual work, independence of the path of load."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from derivatives import Probe
from numpy.testing import assert_allclose
from shell_cases import NUMPY, Shell, shell
from shell_decks import SHEET, Deck, ran, refused, shell_deck, write
from shell_force_checks import check, disturbed, state

from dismech_cli.arrays import FloatArray
from dismech_cli.forces.edge_torque import EdgeTorque
from dismech_cli.forces.moment import EdgeMoment
from dismech_cli.kinematics.shell_frames import ShellFrames
from dismech_cli.laws.laws import Constant
from dismech_cli.mesh.generate.rings import hemisphere

__all__ = ["ran", "refused", "write"]

MOMENTS = np.array([[0.3, -0.8, 0.5], [-0.2, 0.6, 0.9], [1.1, 0.1, -0.4]])
EDGES = np.array([0, 4, 9])


@pytest.fixture
def cap() -> Shell:
    return shell(hemisphere(1.0, 3), "midedge")


def torque(made: Shell) -> EdgeTorque:
    assert isinstance(made.model.frames, ShellFrames)
    dofs, ends = made.model.dofs, made.topology.edges[EDGES]
    return EdgeTorque(
        "torque",
        dofs.of_nodes(ends[:, 0]),
        dofs.of_nodes(ends[:, 1]),
        dofs.of_normals(EDGES),
        made.model.frames.edge_places(EDGES)[:, :3],
        MOMENTS,
        Constant(1.4),
    )


def couple(made: Shell) -> EdgeMoment:
    whole = torque(made)
    none = np.empty(0, dtype=np.int64)
    return EdgeMoment("couple", whole.tails, whole.heads, none, (0, 1, 2), whole.moments, whole.signal)


def test_derivative(cap: Shell) -> None:
    """Far from where the frames are stored: the transport of the normals is differentiated too."""
    check(torque(cap), cap)


def test_more_auxiliary_inputs_change_nothing(cap: Shell) -> None:
    """It knows the places of its own inputs, whatever comes behind them."""
    q, _ = disturbed(cap, 3)
    c = state(cap, q, np.zeros_like(q))
    more = replace(c.frames, auxiliary=np.append(c.frames.auxiliary, [1.0, 2.0]))
    probe = Probe.of(torque(cap), cap.model, NUMPY)
    assert np.array_equal(probe.residual(replace(c, frames=more)), probe.residual(c))


def rotated(x: FloatArray, axis: FloatArray, angle: float) -> FloatArray:
    """Rodrigues' formula on rows."""
    size = np.linalg.norm(axis)
    k = axis / size
    c, s = np.cos(angle * size), np.sin(angle * size)
    return np.asarray(c * x + s * np.cross(k, x) + (1.0 - c) * (x @ k)[:, None] * k)


def test_work_in_a_rigid_rotation(cap: Shell) -> None:
    """Moments M do the work M.w whatever the state and wherever the normals are stored.

    The rates of the angles xi are those that keep each transported normal with its edge, by differences.
    """
    q, _ = disturbed(cap, 3)
    dofs = cap.model.dofs
    c = state(cap, q, np.zeros_like(q))
    probes = [Probe.of(term, cap.model, NUMPY) for term in (torque(cap), couple(cap))]
    force = -sum(probe.residual(c) for probe in probes)
    h = 1e-6
    x, normals = dofs.positions(q), c.frames.state.edge_normal.T
    for spin in np.eye(3):
        rate = np.zeros(dofs.n)
        dofs.positions(rate)[:] = np.cross(spin, x)
        turned = []
        for step in (h, -h):
            p = q.copy()
            dofs.positions(p)[:] = rotated(x, spin, step)
            at = state(cap, p, np.zeros_like(p)).frames.state
            t, n, want = at.edge_tangent.T, at.edge_normal.T, rotated(normals, spin, step)
            turned.append(np.arcsin(np.einsum("bi,bi->b", np.cross(n, want), t)))
        rate[dofs.of_normals(np.arange(dofs.n_normals))] = (turned[0] - turned[1]) / (2.0 * h)
        assert_allclose(force @ rate, 1.4 * MOMENTS.sum(axis=0) @ spin, atol=1e-8)


def test_equilibrium_does_not_depend_on_load_steps(ran: Any) -> None:
    """A corner of a sheet is turned by moments in all directions, its sides tilt: one step or three."""
    moment: Deck = {"type": "line_moment", "where": "sheet.right", "moment_per_length": [1e-3, -1.5e-3, 5e-4]}
    ends = []
    for steps in (1, 3):
        deck = shell_deck(
            SHEET | {"divisions": 3},
            motions=[{"type": "clamp", "where": "sheet.left"}],
            forces=[moment],
            numerics={"integrator": {"type": "static", "load_steps": steps}},
        )
        ends.append(ran(deck).frames)
    rest, last = ends[0][0].positions, [frames[-1].positions for frames in ends]
    moved = np.abs(last[0] - rest).max()
    assert moved > 0.01
    assert_allclose(last[0], last[1], atol=1e-6 * moved)


def test_line_moments_need_normals(refused: Any) -> None:
    load: Deck = {"type": "line_moment", "where": "sheet.right", "moment_per_length": [0.0, 1.0, 0.0]}
    message = refused(shell_deck(SHEET, body={"bending": "hinge"}, forces=[load]))
    assert "of a shell with bending: midedge, whose normals it turns" in message
