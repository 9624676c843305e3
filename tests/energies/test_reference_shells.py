"""Shell forces and tangents against numbers that MAT-DiSMech computed (see data/README-shell.md)."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from derivatives import Probe
from numpy.testing import assert_allclose
from shell_cases import NUMPY, Material, Shell, shell

from dismech_cli.arrays import FloatArray
from dismech_cli.energies.membrane_springs import spring_term
from dismech_cli.forces.aerodynamic import aerodynamic_drag
from dismech_cli.kinematics.dofs import DofMap
from dismech_cli.kinematics.rod_frames import NoFrames
from dismech_cli.mesh.measure import edge_lengths, triangle_areas
from dismech_cli.mesh.mesh import Mesh
from dismech_cli.model.configuration import Configuration
from dismech_cli.model.model import Model
from dismech_cli.model.stencil import StencilEnergy
from dismech_cli.model.term import Term
from dismech_cli.sections.shells import hinge_springs, midedge_springs

DATA = Path(__file__).parents[1] / "data"
SHEET = Material(youngs_modulus=2e8, poisson_ratio=0.5, thickness=1e-3, density=1200.0)


def reference(name: str) -> dict[str, FloatArray]:
    with np.load(DATA / f"reference_{name}.npz") as data:
        return dict(data)


def cantilever(bending: str) -> Shell:
    data = reference("shell_cantilever")
    mesh = Mesh(nodes=data["nodes"], triangles=data["triangles"].astype(np.int64))
    return shell(mesh, bending, "springs", SHEET)


def directions(n: int) -> FloatArray:
    """The vectors that the tangents of the data were multiplied with, shape (n, 3)."""
    return np.cos(np.arange(n)[:, None] * np.arange(1, 4))


def assert_force(probe: Probe, c: Configuration, force: FloatArray) -> None:
    assert np.abs(force).max() > 0.0
    assert_allclose(probe.residual(c), -force, rtol=0, atol=1e-8 * np.abs(force).max())


def assert_tangent(tangent: FloatArray, data: FloatArray, largest: FloatArray) -> None:
    """-J times three vectors, to 1e-8 of J's largest entry."""
    assert_allclose(tangent @ directions(len(tangent)), -data, rtol=0, atol=1e-8 * float(largest))


def at(q: FloatArray) -> Configuration:
    nothing = NoFrames()
    return Configuration(0.0, q, np.zeros_like(q), nothing.transport(nothing.rest(q), q))


def springs(made: Shell) -> StencilEnergy:
    edges = made.topology.edges
    lengths = edge_lengths(made.mesh.nodes, edges)
    stiffness = hinge_springs(SHEET.youngs_modulus, SHEET.thickness, lengths)
    return spring_term("springs", made.model.dofs, edges, lengths, stiffness)


def test_stretch_of_the_cantilever() -> None:
    made, data = cantilever("hinge"), reference("shell_cantilever")
    probe = Probe.of(springs(made), made.model, NUMPY)
    c = at(data["q"])
    assert_force(probe, c, data["stretch_force"])
    assert_tangent(probe.tangents(c)[0], data["stretch_products"], data["stretch_largest"])


@pytest.mark.parametrize("state", ["shell_cantilever", "shell_hinge"])
def test_hinges_of_the_cantilever(state: str) -> None:
    made, data = cantilever("hinge"), reference(state)
    probe = Probe.of(made.term("bend"), made.model, NUMPY)
    c = at(data["q"])
    assert_force(probe, c, data["hinge_force"])
    assert_tangent(probe.tangents(c)[0], data["hinge_products"], data["hinge_largest"])


def midedge_state(made: Shell) -> tuple[Configuration, dict[str, FloatArray], FloatArray]:
    """The data's state with the data's edge directors tau: the stored normals are tau x t."""
    data = reference("shell_midedge")
    q, tau = data["q"], data["tau"]
    ends = q[: made.model.dofs.n_positions].reshape(-1, 3)[made.topology.edges]
    e = (ends[:, 1] - ends[:, 0]).T
    tangent = e / np.linalg.norm(e, axis=0)
    normal = np.cross(tau.T, tangent.T).T
    empty = NoFrames().rest(q)
    stored = replace(empty, edge_tangent=tangent, edge_normal=normal, edge_angle=np.zeros(len(tangent.T)))
    return Configuration(0.0, q, np.zeros_like(q), made.model.frames.transport(stored, q)), data, normal


def test_midedge_forces_of_the_cantilever() -> None:
    made = cantilever("midedge")
    c, data, normal = midedge_state(made)
    assert_force(Probe.of(made.term("bend"), made.model, NUMPY), c, data["force"])
    assert_allclose(made.model.frames.mean_normals(c.q), normal, rtol=0, atol=1e-14)  # type: ignore[attr-defined]


def test_midedge_tangent_of_the_cantilever() -> None:
    """The data's tangent drops the turning of tau and of the in-plane normals.

    Without those terms it is the material part (the angles' natural values set to the present ones)
    and a geometric part n t^T + t n^T, written out here. The exact tangent differs by the angles'
    size, 1e-4.
    """
    made = cantilever("midedge")
    c, data, _ = midedge_state(made)
    term = made.term("bend")
    exact, _ = Probe.of(term, made.model, NUMPY).tangents(c)
    angles, moments = angles_and_moments(made, c)
    unstressed = term.having(dict(zip(term.kernel.naturals, angles, strict=True)))
    material, _ = Probe.of(unstressed, made.model, NUMPY).tangents(c)
    tangent = material + simplified_geometric(made, c, moments)
    assert_tangent(tangent, data["products"], data["largest"])
    difference = np.abs((exact - tangent) @ directions(len(exact))).max() / float(data["largest"])
    assert 1e-8 < difference < 3e-4


def angles_and_moments(made: Shell, c: Configuration) -> tuple[FloatArray, FloatArray]:
    """Edge angles and their moments, from the energy's own gradient: dE/dxi of one face alone."""
    term = made.term("bend")
    upper = np.zeros((3, 3, len(made.areas)))
    upper[np.triu_indices(3)] = [term.parameter(f"M{i}{j}") for i in range(3) for j in range(i, 3)]
    m = upper + np.triu(np.ones((3, 3)), 1).T[:, :, None] * upper.transpose(1, 0, 2)
    q, dofs = c.q, made.model.dofs
    y = np.concatenate(
        [
            (q[term.dofs[:, 3:6]] - q[term.dofs[:, :3]]).T,
            (q[term.dofs[:, 6:9]] - q[term.dofs[:, :3]]).T,
            q[term.dofs[:, 9:]].T,
        ]
    )
    assert dofs.n_angles == 0
    gradient = term.kernel.function(
        tuple(y), tuple(c.frames.auxiliary[term.auxiliaries].T), tuple(term.parameters)
    )[1]
    moments = np.stack(gradient[6:]) * [term.parameter(f"sign_{k}") for k in range(3)]
    angles = np.linalg.solve(m.transpose(2, 0, 1), moments.T[:, :, None])[:, :, 0].T
    return angles + term.natural, moments


def simplified_geometric(made: Shell, c: Configuration, moments: FloatArray) -> FloatArray:
    """-sum_i m_i (tau_i.t_k) / A^2 (n t_l^T + t_l n^T), A twice the area: blocks (k, l) of positions."""
    triangles = made.mesh.triangles
    x = c.q[: made.model.dofs.n_positions].reshape(-1, 3)[triangles]
    v = np.stack([x[:, 2] - x[:, 1], x[:, 0] - x[:, 2], x[:, 1] - x[:, 0]], axis=1)
    n = np.cross(v[:, 2], -v[:, 1])
    area = np.linalg.norm(n, axis=1)
    n /= area[:, None]
    t = np.cross(v, n[:, None, :])
    tau = t / np.linalg.norm(t, axis=2)[:, :, None]
    h = np.einsum("it,tic,tkc->tk", moments, tau, t) / area[:, None] ** 2
    block = np.einsum("tk,ta,tlb->tkalb", h, n, t) + np.einsum("tk,tla,tb->tkalb", h, t, n)
    out = np.zeros((len(c.q), len(c.q)))
    dofs = (3 * triangles[:, :, None] + np.arange(3)).reshape(-1, 9)
    np.add.at(out, (dofs[:, :, None], dofs[:, None, :]), -block.reshape(-1, 9, 9))
    return out


def test_midedge_springs_of_the_family() -> None:
    """2 E h l / (1 - nu^2): 4/3 over 3/4 times the springs that go with hinges, at nu = 1/2."""
    lengths = np.array([1.0, 2.0])
    ratio = midedge_springs(1.0, 0.5, 0.1, lengths) / hinge_springs(1.0, 0.1, lengths)
    assert_allclose(ratio, (8.0 / 3.0) / (np.sqrt(3.0) / 2.0), rtol=1e-15)


def test_aerodynamic_drag_of_the_parachute() -> None:
    """The data's tangent is twice the true one; velocities are (q - q0) / dt, so both tangents add."""
    data = reference("parachute_aerodynamic")
    nodes, triangles = data["nodes"], data["triangles"].astype(np.int64)
    dofs = DofMap(len(nodes), 0, (0, 1, 2), len(nodes))
    areas, dt = triangle_areas(nodes, triangles), 1e-2
    term: Term = aerodynamic_drag("drag", dofs, triangles, areas, fluid_density=1.0, coefficient=10.0)
    rest = nodes.reshape(-1)
    model = Model(dofs, rest, np.zeros(dofs.n), (term,), (), NoFrames(), NUMPY, 0.1)
    probe = Probe.of(term, model, NUMPY)
    c = replace(at(data["q"]), v=(data["q"] - data["q0"]) / dt)
    assert_force(probe, c, data["force"])
    stiffness, damping = probe.tangents(c)
    assert_tangent(2.0 * (stiffness + damping / dt), data["products"], data["largest"])
