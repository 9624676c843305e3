"""Energies of shells: derivatives, invariance, stress-free rest, exactness on uniform states."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from derivatives import Probe, assert_derivatives, complex_gradient, complex_hessian, unpacked
from high_precision import assert_kernel_derivatives
from numpy.testing import assert_allclose
from shell_cases import NUMPY, Material, shell
from shell_states import configured, disturbed, driver_of, relaxed, stored_at

from dismech_cli.arrays import FloatArray
from dismech_cli.energies.hinge import hinge, hinge_angles
from dismech_cli.energies.membrane import MEMBRANE, membrane
from dismech_cli.energies.midedge import midedge
from dismech_cli.energies.midedge_averaged import midedge_averaged, neighbour_corners
from dismech_cli.kernels.driver import Driver
from dismech_cli.kinematics.rod_frames import FrameState
from dismech_cli.kinematics.strains import angles_of_curvature, rest_metric
from dismech_cli.mesh.generate.rings import hemisphere
from dismech_cli.mesh.generate.sheets import Pattern, sheet
from dismech_cli.mesh.measure import edge_lengths, triangle_areas
from dismech_cli.mesh.mesh import Mesh
from dismech_cli.sections.mass import shell_mass
from dismech_cli.sections.shells import (
    area_springs,
    bending_stiffness,
    hinge_springs,
    hinge_stiffness,
    midedge_springs,
    plane_stress_stiffness,
    weighted_hinge_stiffness,
)

BENDING = ("hinge", "midedge", "averaged")
FACE = np.array([[0, 1, 2]])
TRIANGLES = {
    "equilateral": np.array([[0.0, 0, 0], [1, 0, 0], [0.5, 0.866, 0]]),
    "right": np.array([[0.3, 0, 1], [0.3, 2, 1], [-1.2, 0, 1]]),
    "needle": np.array([[0.0, 0, 0], [1, 0, 0], [0.3, 1e-3, 0]]),
    "obtuse": np.array([[0.0, 0, 0], [1, 0, 0], [-0.9, 0.1, 0]]),
}
HEIGHT = {"equilateral": 0.8, "right": 1.2, "needle": 1e-3, "obtuse": 0.05}


def rotation(seed: int = 3) -> FloatArray:
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return np.asarray(q * np.sign(np.linalg.det(q)))


def matrix(seed: int) -> FloatArray:
    """Upper triangle of a positive definite 3x3 matrix."""
    a = np.random.default_rng(seed).normal(size=(3, 3))
    return np.asarray((a @ a.T + 0.1 * np.eye(3))[np.triu_indices(3)])


# ---------------------------------------------------------------- derivatives of the kernels


@pytest.mark.parametrize("shape", TRIANGLES)
@pytest.mark.parametrize("stretch", [1.0, 0.6, 2.5])
@pytest.mark.parametrize("growth", [0.0, 0.2])
def test_membrane_derivatives(shape: str, stretch: float, growth: float) -> None:
    x = TRIANGLES[shape]
    metric = rest_metric(x, FACE)
    stiffness = plane_stress_stiffness(metric, 3.0, 0.3, 0.1)
    p = np.concatenate(([growth], metric[:, 0], stiffness[:, 0]))
    rng = np.random.default_rng(1)
    y = stretch * np.concatenate((x[1] - x[0], x[2] - x[0])) + 0.3 * HEIGHT[shape] * rng.normal(size=6)
    _, gradient, hessian = membrane(tuple(y), (), tuple(p))
    # sums of terms that cancel: the needle's stiffness across is 1e6 times that along
    size = np.abs(stiffness).max() * np.abs(metric).max() ** 2
    assert_allclose(gradient, complex_gradient(MEMBRANE, y, np.empty(0), p), rtol=0, atol=1e-14 * size)
    exact = complex_hessian(MEMBRANE, y, np.empty(0), p)
    assert_allclose(unpacked(hessian, 6), exact, rtol=0, atol=1e-14 * size)


@pytest.mark.parametrize("fold", [0.0, 1e-9, 0.4, -1.5, np.radians(170), np.radians(-179)])
@pytest.mark.parametrize("height", [1.0, 1e-3])
def test_hinge_derivatives(fold: float, height: float) -> None:
    e = np.array([1.0, 0, 0])
    f = np.array([0.4, -height, 0])
    g = np.array([0.7, 0.8 * np.cos(fold), -0.8 * np.sin(fold)])
    turn = rotation()
    y = np.concatenate((turn @ e, turn @ f, turn @ g))
    assert_kernel_derivatives(hinge, y, np.empty(0), np.array([0.2, 1.7]), size=min(height, 0.8))


def test_the_sign_of_the_dihedral_angle() -> None:
    """A roof seen from the side of its normals opens by a positive angle."""
    roof = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, -1, -0.1], [0.5, 1, -0.1]])
    hinges = np.array([[0, 1, 3, 2]])  # faces (0, 1, 3) and (1, 0, 2): normals up
    assert_allclose(hinge_angles(roof, hinges), 2.0 * np.arctan(0.1), rtol=1e-14)
    assert_allclose(hinge_angles(roof * (1, 1, -1), hinges), -2.0 * np.arctan(0.1), rtol=1e-14)


def test_a_hinge_bends_the_short_way_round() -> None:
    """At a natural angle of 175 degrees a fold of -175 degrees is 10 degrees away, not 350."""
    fold = np.radians(-175)
    # the first face looks down, so the second one rises by a positive angle
    y = np.array([1.0, 0, 0, 0.5, -1, 0, 0.5, np.cos(fold), np.sin(fold)])
    energy = hinge(tuple(y), (), (np.radians(175), 2.0))[0]
    assert_allclose(energy, np.radians(10) ** 2, rtol=1e-12)


@pytest.mark.parametrize("shape", TRIANGLES)
@pytest.mark.parametrize("turned", [0.0, 0.3, 1.5])
def test_midedge_derivatives(shape: str, turned: float) -> None:
    """At the stored frames and away from them: the transport is part of the energy."""
    rng = np.random.default_rng(2)
    x = TRIANGLES[shape] @ rotation().T
    a, b = x[1] - x[0], x[2] - x[0]
    n = np.cross(a, b) / np.linalg.norm(np.cross(a, b))
    signs = np.array([1.0, -1.0, -1.0])
    auxiliary = []
    for v, s in zip((b - a, -b, a), signs, strict=True):
        t = v / np.linalg.norm(v) + turned * rng.normal(size=3)
        t = s * t / np.linalg.norm(t)
        m = n + 0.4 * rng.normal(size=3)
        m -= (m @ t) * t
        auxiliary.append(np.concatenate((t, m / np.linalg.norm(m), rng.normal(size=1))))
    y = np.concatenate((a, b, [auxiliary[k][6] + 0.3 * rng.normal() for k in range(3)]))
    p = np.concatenate((0.1 * rng.normal(size=3), matrix(1), signs))
    assert_kernel_derivatives(midedge, y, np.concatenate(auxiliary), p, size=HEIGHT[shape])


@pytest.mark.parametrize("shape", TRIANGLES)
@pytest.mark.parametrize("fold", [0.0, 0.5, np.radians(170)])
@pytest.mark.parametrize("rim", [False, True])
def test_averaged_derivatives(shape: str, fold: float, rim: bool) -> None:
    x = TRIANGLES[shape]
    n = np.cross(x[1] - x[0], x[2] - x[0])
    n /= np.linalg.norm(n)
    corners = []
    for k, angle in enumerate((fold, -0.7 * fold, 0.9 * fold)):
        tail, head = x[k - 2], x[k - 1]
        t = (head - tail) / np.linalg.norm(head - tail)
        out = np.cos(angle) * np.cross(t, n) - np.sin(angle) * n
        corners.append(0.5 * (tail + head) + 0.9 * out)
    if rim:
        corners[1] = x[1]
    y = (np.concatenate((x[1:], corners)) - x[0]) @ rotation().T
    share = np.array([0.5, 0.0 if rim else 0.5, 0.5])
    p = np.concatenate(([0.1, -0.2, 0.15], matrix(2), share))
    assert_kernel_derivatives(midedge_averaged, y.reshape(-1), np.empty(0), p, size=HEIGHT[shape])


# ---------------------------------------------------------------- bound terms


SURFACES = {
    "flat": sheet(1.0, 0.8, 4, Pattern.UNSTRUCTURED),
    "cap": hemisphere(1.0, 3),
}


@pytest.mark.parametrize("surface", SURFACES)
@pytest.mark.parametrize("size", [0.0, 0.2])
@pytest.mark.parametrize("bending", BENDING)
def test_terms_are_consistent(surface: str, size: float, bending: str) -> None:
    """Energy, residual and tangent of whole shells, stencils scattered into a matrix."""
    check_terms(surface, size, bending, NUMPY)


@pytest.mark.parametrize("bending", ["hinge", "midedge", pytest.param("averaged", marks=pytest.mark.slow)])
def test_terms_are_consistent_when_compiled(bending: str) -> None:
    """The same in compiled loops; compiling takes long where no run before has done it."""
    check_terms("cap", 0.2, bending, driver_of("numba"))


def check_terms(surface: str, size: float, bending: str, driver: Driver) -> None:
    made = shell(SURFACES[surface], bending, driver=driver)
    q = disturbed(made, size)
    stored = stored_at(made, q)
    scale = np.full(len(q), 0.2)
    scale[: made.model.dofs.n_positions] *= made.model.length
    for term in made.model.terms:
        assert_derivatives(
            term,
            lambda x, v: replace(configured(made, stored, x), v=v),
            q,
            np.zeros_like(q),
            made.model,
            driver=made.model.driver,
            scale=scale,
        )


@pytest.mark.parametrize("bending", BENDING)
@pytest.mark.parametrize("membrane_kind", ["cst", "springs"])
def test_rest_is_free_of_stress(bending: str, membrane_kind: str) -> None:
    made = shell(SURFACES["cap"], bending, membrane_kind)
    q = made.model.rest
    c = configured(made, stored_at(made, q), q)
    for term in made.model.terms:
        probe = Probe.of(term, made.model, NUMPY)
        stiffness = float(np.abs(probe.tangents(c)[0]).max())
        # strain errors of an ulp, twice for the two faces of a hinge
        assert_allclose(probe.residual(c), 0.0, atol=1e-15 * stiffness)
        assert probe.energy(c) <= 1e-28 * stiffness


def rotated(frames: FrameState, turn: FloatArray) -> FrameState:
    return replace(frames, edge_tangent=turn @ frames.edge_tangent, edge_normal=turn @ frames.edge_normal)


@pytest.mark.parametrize("bending", BENDING)
def test_rigid_motions_cost_nothing(bending: str) -> None:
    """Same energy, forces turned along; no net force, no net moment."""
    made = shell(SURFACES["cap"], bending)
    q = disturbed(made, 0.2)
    stored = stored_at(made, q)
    q = relaxed(made, stored, q)
    turn, shift = rotation(), np.array([3.0, -2.0, 1.0])
    split = made.model.dofs.n_positions
    moved = q.copy()
    moved[:split] = (q[:split].reshape(-1, 3) @ turn.T + shift).reshape(-1)
    for term in made.model.terms:
        probe = Probe.of(term, made.model, NUMPY)
        here, there = configured(made, stored, q), configured(made, rotated(stored, turn), moved)
        r, s = probe.residual(here), probe.residual(there)
        size = float(np.abs(r).max())
        assert size > 0.0
        assert_allclose(probe.energy(there), probe.energy(here), rtol=1e-12)
        f = r[:split].reshape(-1, 3)
        assert_allclose(s[:split].reshape(-1, 3), f @ turn.T, rtol=0, atol=1e-11 * size)
        assert_allclose(f.sum(axis=0), 0.0, atol=1e-12 * size)
        moment = np.cross(q[:split].reshape(-1, 3), f).sum(axis=0)
        assert_allclose(moment, 0.0, atol=1e-11 * size)


# ---------------------------------------------------------------- membrane: exact on uniform strain


def affine(mesh: Mesh, f: FloatArray) -> FloatArray:
    """Nodes of a flat sheet mapped by a 3x2 deformation gradient."""
    return np.asarray(mesh.nodes[:, :2] @ f.T)


def test_patch_of_constant_strain() -> None:
    """Any uniform deformation: St. Venant-Kirchhoff's energy, and no force on inner nodes."""
    sheet_material = Material(youngs_modulus=3.0, poisson_ratio=0.4, thickness=0.05)
    mesh = sheet(1.0, 0.7, 6, Pattern.UNSTRUCTURED)
    made = shell(mesh, "hinge", material=sheet_material)
    f = np.array([[1.1, 0.2], [-0.1, 0.9], [0.3, 0.4]])
    q = affine(mesh, f).reshape(-1)
    probe = Probe.of(made.term("membrane"), made.model, NUMPY)
    c = configured(made, stored_at(made, q), q)
    g = 0.5 * (f.T @ f - np.eye(2))
    lame = 3.0 * 0.4 / (1.0 - 0.4**2)
    density = 0.5 * lame * np.trace(g) ** 2 + 3.0 / 2.8 * np.sum(g * g)
    assert_allclose(probe.energy(c), 0.05 * 0.7 * density, rtol=1e-13)
    inner = np.setdiff1d(np.arange(len(mesh.nodes)), mesh.node_groups["rim"])
    force = probe.residual(c).reshape(-1, 3)
    assert_allclose(force[inner], 0.0, atol=1e-13 * np.abs(force).max())


@pytest.mark.parametrize("growth", [-0.1, 0.3])
def test_growth_is_free_of_stress_at_the_grown_shape(growth: float) -> None:
    made = shell(SURFACES["cap"], "hinge")
    grown = made.with_naturals("membrane", np.full((1, len(made.areas)), growth))
    probe = Probe.of(grown.term("membrane"), grown.model, NUMPY)
    q = (1.0 + growth) * made.model.rest
    c = configured(made, stored_at(made, q), q)
    assert_allclose(probe.residual(c), 0.0, atol=1e-15)
    # and a strain of 1 % from there costs what it costs a sheet of the grown size
    e = (1.01**2 - 1.0) / 2.0
    stretched = configured(made, stored_at(made, 1.01 * q), 1.01 * q)
    area = made.areas.sum() * (1.0 + growth) ** 2
    assert_allclose(probe.energy(stretched), 0.1 * area * e**2 / 0.7, rtol=1e-10)


def test_springs_are_a_sheet_of_poisson_ratio_one_third() -> None:
    """On equilateral triangles, exactly: E h / (1 - nu^2) against a strain along x."""
    mesh = sheet(1.0, np.sqrt(3.0) / 2.0 * 8.0 / 10.0, 10)
    nodes, length = mesh.nodes, 0.1
    inner = (np.abs(nodes[mesh.triangles][:, :, 0] - 0.5).max(axis=1)) < 0.46
    mesh = Mesh(nodes=nodes, triangles=mesh.triangles[inner])
    made = shell(mesh, "hinge", "springs", Material(youngs_modulus=2.0, thickness=0.1))
    assert_allclose(edge_lengths(nodes, made.topology.edges), length, rtol=1e-10)
    strain = 1e-5
    q = (nodes * (1.0 + strain, 1.0, 1.0)).reshape(-1)
    probe = Probe.of(made.term("membrane"), made.model, NUMPY)
    energy = probe.energy(configured(made, stored_at(made, q), q))
    exact = 0.5 * 2.0 * 0.1 / (1.0 - 1.0 / 9.0) * strain**2 * made.areas.sum()
    assert_allclose(energy, exact, rtol=1e-4)  # strains of second order


def test_spring_and_hinge_constants() -> None:
    lengths, pair = np.array([0.2, 0.2]), np.sqrt(3.0) / 4.0 * 0.04 * np.array([2.0, 1.0])
    assert_allclose(area_springs(2.0, 0.1, lengths, pair)[0], hinge_springs(2.0, 0.1, lengths)[0], rtol=1e-14)
    assert_allclose(area_springs(2.0, 0.1, lengths, pair)[1], 0.5 * hinge_springs(2.0, 0.1, lengths)[1])
    assert_allclose(midedge_springs(2.0, 0.3, 0.1, lengths), 2.0 * 2.0 * 0.1 * 0.2 / 0.91, rtol=1e-14)
    weighted = weighted_hinge_stiffness(2.0, 0.1, lengths, pair)
    assert_allclose(weighted[0], hinge_stiffness(2.0, 0.1, 2)[0], rtol=1e-14)
    assert_allclose(hinge_stiffness(2.0, 0.1, 2), 2.0 / np.sqrt(3.0) * 2.0 * 1e-3 / 12.0, rtol=1e-14)


def test_mass_of_a_cap() -> None:
    made = shell(SURFACES["cap"], "midedge", material=Material(thickness=0.1, density=2.0))
    dofs = made.model.dofs
    mass = shell_mass(dofs, made.mesh.triangles, made.areas, np.full(len(made.areas), 0.2))
    assert_allclose(mass[: dofs.n_positions : 3].sum(), 0.2 * made.areas.sum(), rtol=1e-14)
    assert_allclose(mass[dofs.n_positions :], 0.0)
    assert_allclose(made.areas, triangle_areas(made.mesh.nodes, made.mesh.triangles))


# ---------------------------------------------------------------- bending: exact on uniform curvature


@pytest.mark.parametrize("pattern", [Pattern.RIGHT, Pattern.ALTERNATING, Pattern.UNSTRUCTURED])
def test_patch_of_constant_curvature(pattern: Pattern) -> None:
    """A plate bent to any uniform curvature has the plate's energy, on any mesh (Morley's element)."""
    sheet_material = Material(youngs_modulus=3.0, poisson_ratio=0.4, thickness=0.05)
    mesh = sheet(1.0, 0.7, 5, pattern)
    made = shell(mesh, "midedge", material=sheet_material)
    k = 1e-6 * np.array([[1.3, 0.4], [0.4, -0.5]])
    x = mesh.nodes[:, :2]
    q = made.model.rest.copy()
    q[2 : made.model.dofs.n_positions : 3] = -0.5 * np.einsum("ni,ij,nj->n", x, k, x)
    ends = x[made.topology.edges]
    along = ends[:, 1] - ends[:, 0]
    normal = ends.mean(axis=1) @ k  # - grad w at the middle of each edge
    q[made.model.dofs.n_positions :] = (normal[:, 0] * along[:, 1] - normal[:, 1] * along[:, 0]) / np.hypot(
        *along.T
    )
    probe = Probe.of(made.term("bend"), made.model, NUMPY)
    c = configured(made, made.model.frames.rest(made.model.rest), q)
    exact = 0.5 * 0.7 * sheet_material.rigidity * (0.6 * np.sum(k * k) + 0.4 * np.trace(k) ** 2)
    # angles of 1e-6 from positions of order one: 1e-10 of round-off
    assert_allclose(probe.energy(c), exact, rtol=1e-8)
    force = probe.residual(c)
    inner = np.setdiff1d(np.arange(len(x)), mesh.node_groups["rim"])
    assert_allclose(force[3 * inner + 2], 0.0, atol=1e-8 * np.abs(force).max())
    space = np.zeros((len(mesh.triangles), 3, 3))
    space[:, :2, :2] = k
    bent = made.with_naturals("bend", angles_of_curvature(mesh.nodes, mesh.triangles, space))
    relaxed = Probe.of(bent.term("bend"), bent.model, NUMPY)
    assert relaxed.energy(c) < 1e-15 * exact
    assert_allclose(relaxed.residual(c), 0.0, atol=1e-8 * np.abs(force).max())


def test_bending_stiffness_of_one_triangle() -> None:
    """Uniform curvature through the edge angles gives the plate's energy."""
    x = TRIANGLES["obtuse"] @ rotation().T
    k = rotation() @ np.diag([0.7, -1.1, 0.0]) @ rotation().T
    alpha = angles_of_curvature(x, FACE, k[None])[:, 0]
    m = np.zeros((3, 3))
    m[np.triu_indices(3)] = bending_stiffness(x, FACE, 3.0, 0.4, 0.1)[:, 0]
    m += np.triu(m, 1).T
    rigidity = 3.0 * 0.1**3 / (12.0 * 0.84)
    exact = 0.5 * triangle_areas(x, FACE)[0] * rigidity * (0.6 * np.sum(k * k) + 0.4 * np.trace(k) ** 2)
    # 1e3 of cancellation among the angles of an obtuse triangle
    assert_allclose(0.5 * alpha @ m @ alpha, exact, rtol=1e-10)


def test_averaged_normals_are_a_constraint_on_free_ones() -> None:
    """With xi halfway at every edge both energies agree where no rim is: a closed surface."""
    x = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
    faces = np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]])
    mesh = Mesh(nodes=x, triangles=faces)
    free, averaged = shell(mesh, "midedge"), shell(mesh, "averaged")
    rng = np.random.default_rng(4)
    nodes = x.reshape(-1) + rng.uniform(-0.2, 0.2, 18)
    q = np.concatenate((nodes, np.zeros(free.model.dofs.n_normals)))
    rest = free.model.frames.rest(free.model.rest)
    halfway = free.model.frames.mean_normals(q)  # type: ignore[attr-defined]
    e = (q[:18].reshape(-1, 3)[free.topology.edges] * [[[-1.0], [1.0]]]).sum(axis=1).T
    stored = replace(rest, edge_tangent=e / np.linalg.norm(e, axis=0), edge_normal=halfway)
    a = Probe.of(free.term("bend"), free.model, NUMPY)
    b = Probe.of(averaged.term("bend"), averaged.model, NUMPY)
    c = configured(free, stored, q)
    d = configured(averaged, stored_at(averaged, nodes), nodes)
    assert_allclose(b.energy(d), a.energy(c), rtol=1e-12)
    stiffness, _ = a.tangents(c)
    r = a.residual(c)
    xi = slice(18, None)
    gain = 0.5 * r[xi] @ np.linalg.solve(stiffness[xi, xi], r[xi])
    assert gain > 1e-3 * a.energy(c), "free normals have nothing to gain: the case is too symmetric"


def test_neighbours_across_sides() -> None:
    mesh = sheet(1.0, 1.0, 2, Pattern.RIGHT)
    made = shell(mesh, "averaged")
    topology = made.topology
    corners = neighbour_corners(mesh.triangles, topology.face_edges, topology.edge_faces)
    for (x0, x1, x2, x3), (first, second), edge in zip(
        topology.hinges, topology.hinge_faces, topology.hinge_edges, strict=True
    ):
        assert {x0, x1} == set(topology.edges[edge])
        assert corners[first][topology.face_edges[first] == edge] == [x3]
        assert corners[second][topology.face_edges[second] == edge] == [x2]
    rim = topology.edge_faces[topology.face_edges][:, :, 1] < 0
    assert_allclose(corners[rim], mesh.triangles[rim])
