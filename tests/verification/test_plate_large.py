"""Large deflections of strips against the elastica and the circle."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from shell_cases import Material, Shell, pressed, shell

from dismech_cli.arrays import FloatArray, IntArray
from dismech_cli.forces.load import DeadLoad
from dismech_cli.kinematics.motion import Motion
from dismech_cli.laws.laws import Constant, Ramp
from dismech_cli.mesh.generate.sheets import Pattern, sheet
from dismech_cli.solve.integrators import Static
from dismech_cli.solve.problem import NewtonSettings
from dismech_cli.solve.status import Status
from dismech_cli.solve.step import Stepper

LOADED = Ramp(before=0.0, after=1.0, start=0.0, end=1.0)


def bent(made: Shell, held: IntArray, force: FloatArray, steps: int) -> FloatArray:
    """Static shape under a load raised in equal steps: node positions (N, 3)."""
    model = made.model
    motion = Motion("clamp", held, model.rest[held], Constant(0.0))
    model = replace(
        model,
        mass=np.zeros_like(model.mass),
        terms=(*model.terms, DeadLoad("load", force, LOADED)),
        motions=(motion,),
    )
    stepper = Stepper(model, Static(), NewtonSettings(), "auto")
    state = stepper.prepare(stepper.rest_state())
    for _ in range(steps):
        result = stepper.step(state, 1.0 / steps)
        assert result.status is Status.CONVERGED
        state = result.state
    return np.asarray(state.q[: model.dofs.n_positions].reshape(-1, 3))


def root(made: Shell) -> IntArray:
    """DOFs of the left side: its nodes and its edge normals."""
    left = made.mesh.nodes[:, 0] == 0.0
    nodes = made.model.dofs.of_nodes(np.flatnonzero(left)).reshape(-1)
    return np.concatenate((nodes, made.model.dofs.of_normals(made.edges_among(left))))


@pytest.mark.parametrize(
    ("gamma", "drop", "reach", "steps"),
    [(1.0, 0.1234714, 0.9912464, 1), (10.0, 0.7001997, 0.6563538, 2)],
)
@pytest.mark.parametrize("pattern", [Pattern.RIGHT, Pattern.UNSTRUCTURED])
def test_heavy_cantilever(pattern: Pattern, gamma: float, drop: float, reach: float, steps: int) -> None:
    """A strip under its weight, Gamma = rho g A L^3 / (E I): the heavy elastica's tip to 0.2 % of L."""
    material = Material(youngs_modulus=1e6, poisson_ratio=0.0, thickness=0.01)
    made = shell(sheet(1.0, 0.1, 30, pattern), "midedge", material=material)
    load = -gamma * material.rigidity  # per area, on length 1
    x = bent(made, root(made), pressed(made, load), steps)
    end = x[made.mesh.node_groups["right"]].mean(axis=0)
    assert_allclose([end[0], -end[2]], [reach, drop], atol=2e-3)


@pytest.mark.slow
def test_roll_up() -> None:
    """An end moment of 2 pi E I / L rolls a strip into a closed circle (Sze, Liu & Lo 2004, sec. 3.2).

    The moment loads the edge normals of the free side: their angles are true rotations.
    """
    material = Material(youngs_modulus=1.2e6, poisson_ratio=0.0, thickness=0.1)
    made = shell(sheet(12.0, 1.0, 36, Pattern.RIGHT), "midedge", material=material)
    dofs = made.model.dofs
    end = made.mesh.nodes[:, 0] == 12.0
    edges = made.edges_among(end)
    along = (made.mesh.nodes[made.topology.edges[edges]] * [[[-1.0], [1.0]]]).sum(axis=1)[:, 1]
    for share in (0.25, 1.0):
        force = np.zeros(dofs.n)
        force[dofs.of_normals(edges)] = -share * 50.0 * np.pi / 3.0 * along
        x = bent(made, root(made), force, int(40 * share))[end].mean(axis=0)
        turn = 2.0 * np.pi * share
        exact = 12.0 / turn * np.array([np.sin(turn), 1.0 - np.cos(turn)])
        # of second order on the way; the last closes whatever the mesh
        assert_allclose([x[0], x[2]], exact, atol=12.0 * (5e-4 if share < 1.0 else 1e-7))
