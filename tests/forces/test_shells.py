"""Drag, damping, pressure and thrust on shells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from derivatives import Probe, assert_derivatives
from numpy.testing import assert_allclose
from shell_cases import NUMPY, Material, shell
from shell_force_checks import CAP, check, disturbed, state

from dismech_cli.forces.aerodynamic import aerodynamic_drag
from dismech_cli.forces.enclosed_volume import EnclosedVolume
from dismech_cli.forces.hydrodynamic import area_damping, hydrodynamic_drag
from dismech_cli.forces.pressure import FollowerPressure, VolumePressure, pressure
from dismech_cli.forces.thrust import thrust
from dismech_cli.laws.field import Spatial
from dismech_cli.laws.laws import Constant
from dismech_cli.mesh.generate.rings import annulus, hemisphere
from dismech_cli.mesh.generate.sheets import sheet
from dismech_cli.mesh.measure import nodal_areas
from dismech_cli.mesh.mesh import Mesh
from dismech_cli.model.flow import DragInFlow
from dismech_cli.solve.integrators import ImplicitEuler
from dismech_cli.solve.problem import NewtonSettings
from dismech_cli.solve.status import Status
from dismech_cli.solve.step import Stepper

OCTAHEDRON = Mesh(
    nodes=np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]),
    triangles=np.array(
        [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
    ),
)


@pytest.mark.parametrize("driver", ["numpy", pytest.param("numba", marks=pytest.mark.slow)])
def test_aerodynamic_drag(driver: str) -> None:
    made = shell(CAP, "hinge")
    drag = aerodynamic_drag(
        "drag", made.model.dofs, CAP.triangles, made.areas, fluid_density=1.2, coefficient=2.0
    )
    check(drag, made, driver)


def test_aerodynamic_drag_of_a_plate() -> None:
    """rho c A w |w| / 2 across, nothing along; it opposes the motion either way."""
    mesh = sheet(1.0, 0.5, 4)
    made = shell(mesh, "hinge")
    drag = aerodynamic_drag(
        "drag", made.model.dofs, mesh.triangles, made.areas, fluid_density=1.2, coefficient=2.0
    )
    probe = Probe.of(drag, made.model, NUMPY)
    for w in (3.0, -3.0):
        v = np.tile([7.0, -5.0, w], len(mesh.nodes))
        total = probe.residual(state(made, made.model.rest, v)).reshape(-1, 3).sum(axis=0)
        # three corners, each with a sixth of the area: half the area's dynamic pressure
        assert_allclose(total, [0.0, 0.0, 0.5 * 1.2 * 2.0 * 0.5 * w * abs(w)], rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("texts", [("1 + t", "-0.2", "3"), ("sin(2*z)", "x*y - 1", "0.3*x**2")])
def test_drag_in_a_fluid_that_moves(texts: tuple[str, ...]) -> None:
    made = shell(CAP, "midedge")
    dofs = made.model.dofs
    area = nodal_areas(dofs.n_nodes, CAP.triangles, made.areas)
    for drag in (
        aerodynamic_drag("a", dofs, CAP.triangles, made.areas, fluid_density=1.2, coefficient=2.0),
        hydrodynamic_drag("h", dofs, area, fluid_density=1000.0, coefficient=0.02),
    ):
        check(DragInFlow(drag, [Spatial(text) for text in texts], dofs), made)


def test_drag_vanishes_on_what_moves_with_the_fluid() -> None:
    made = shell(CAP, "hinge")
    dofs = made.model.dofs
    drag = aerodynamic_drag("a", dofs, CAP.triangles, made.areas, fluid_density=1.2, coefficient=2.0)
    flow = DragInFlow(drag, [Spatial("2*z"), Spatial("x - y"), Spatial("0.5")], dofs)
    x, y, z = CAP.nodes.T
    v = np.stack((2 * z, x - y, np.full_like(x, 0.5)), axis=1).reshape(-1)
    r = Probe.of(flow, made.model, NUMPY).residual(state(made, made.model.rest, v))
    assert_allclose(r, 0.0, atol=1e-30)


def test_linear_drag_and_damping() -> None:
    made = shell(CAP, "midedge")
    dofs = made.model.dofs
    area = nodal_areas(dofs.n_nodes, CAP.triangles, made.areas)
    v = np.concatenate((np.tile([1.0, -2.0, 0.5], dofs.n_nodes), np.ones(dofs.n_normals)))
    for term, coefficient in (
        (area_damping("damping", dofs, area, 3.0), 3.0),
        (hydrodynamic_drag("drag", dofs, area, fluid_density=1000.0, coefficient=0.02), 20.0),
    ):
        check(term, made)
        r = Probe.of(term, made.model, NUMPY).residual(state(made, made.model.rest, v))
        total = r[: dofs.n_positions].reshape(-1, 3).sum(axis=0)
        assert_allclose(total, coefficient * made.areas.sum() * np.array([1.0, -2.0, 0.5]), rtol=1e-12)
        assert_allclose(r[dofs.n_positions :], 0.0)


# ---------------------------------------------------------------- pressure


@pytest.mark.parametrize(("mesh", "kind"), [(CAP, FollowerPressure), (OCTAHEDRON, VolumePressure)])
def test_pressure_derivatives(mesh: Mesh, kind: type) -> None:
    made = shell(mesh, "hinge")
    term = pressure("pressure", made.model.dofs, mesh.triangles, Constant(2.5))
    assert isinstance(term, kind)
    check(term, made)


def test_pressure_on_an_open_cap() -> None:
    """The net force is p times the area of the opening, whatever the shape above it."""
    made = shell(CAP, "hinge")
    q, v = disturbed(made)
    rim = CAP.node_groups["rim"]
    q.reshape(-1, 3)[rim] = CAP.nodes[rim]
    probe = Probe.of(pressure("p", made.model.dofs, CAP.triangles, Constant(2.5)), made.model, NUMPY)
    total = probe.residual(state(made, q, v)).reshape(-1, 3).sum(axis=0)
    around = len(rim)
    opening = 0.5 * around * np.sin(2.0 * np.pi / around)  # a regular polygon in the unit circle
    assert_allclose(total, [0.0, 0.0, -2.5 * opening], rtol=1e-12, atol=1e-13)


def test_pressure_on_a_closed_surface_follows_its_faces() -> None:
    """Both forms give the same forces where there is no rim; a symmetric tangent only one."""
    made = shell(OCTAHEDRON, "hinge")
    q, v = disturbed(made)
    dofs, law = made.model.dofs, Constant(2.5)
    corners = dofs.of_nodes(OCTAHEDRON.triangles).reshape(-1, 9)
    here = state(made, q, v)
    follower = Probe.of(FollowerPressure("a", corners, law), made.model, NUMPY)
    volume = Probe.of(VolumePressure("b", corners, law), made.model, NUMPY)
    size = np.abs(volume.residual(here)).max()
    assert_allclose(follower.residual(here), volume.residual(here), rtol=0, atol=1e-14 * size)
    tangent = volume.tangents(here)[0]
    assert_allclose(follower.tangents(here)[0], tangent, rtol=0, atol=1e-14 * np.abs(tangent).max())
    enclosed = EnclosedVolume.of(dofs.n_nodes, OCTAHEDRON.triangles).value(q.reshape(-1, 3))
    assert_allclose(volume.energy(here), -2.5 * enclosed, rtol=1e-13)


# ---------------------------------------------------------------- volume and thrust


def test_volume_of_a_closed_bell() -> None:
    """An open cap of many rings holds 2 pi / 3; a flat ring, nothing."""
    fine = hemisphere(1.0, 40)
    volume = EnclosedVolume.of(len(fine.nodes), fine.triangles).value(fine.nodes)
    assert_allclose(volume, 2.0 * np.pi / 3.0, rtol=2e-3)  # inscribed facets: (pi / 80)^2
    ring = annulus(0.5, 1.0, 3)
    assert_allclose(EnclosedVolume.of(len(ring.nodes), ring.triangles).value(ring.nodes), 0.0, atol=1e-15)


def test_volume_is_closed_about_every_rim() -> None:
    """A tube with two rims: its facets' prism, wherever it is and however it is turned."""
    around, height = 12, 2.0
    angle = 2.0 * np.pi * np.arange(around) / around
    ring = np.stack((np.cos(angle), np.sin(angle), 0.0 * angle), axis=1)
    nodes = np.concatenate((ring, ring + np.array([0, 0, height])))
    i = np.arange(around)
    j = (i + 1) % around
    triangles = np.concatenate((np.stack((i, j, i + around), 1), np.stack((j, j + around, i + around), 1)))
    tube = EnclosedVolume.of(len(nodes), triangles)
    prism = 0.5 * around * np.sin(2.0 * np.pi / around) * height
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    for x in (nodes, nodes + np.array([50.0, -3.0, 7.0]), nodes @ turn.T):
        assert_allclose(tube.value(x), prism, rtol=1e-12)
        gradient = tube.gradient(x)
        assert_allclose(gradient.sum(axis=0), 0.0, atol=1e-13)
        assert_allclose(np.cross(x - x.mean(axis=0), gradient).sum(axis=0), 0.0, atol=1e-12)


def test_gradient_of_the_volume() -> None:
    """The volume is a cubic polynomial: central differences of two steps are exact together."""
    cap = EnclosedVolume.of(len(CAP.nodes), CAP.triangles)
    d = np.random.default_rng(0).normal(size=CAP.nodes.shape)

    def slope(h: float) -> float:
        return (cap.value(CAP.nodes + h * d) - cap.value(CAP.nodes - h * d)) / (2.0 * h)

    exact = (4.0 * slope(0.05) - slope(0.1)) / 3.0
    assert_allclose(np.vdot(cap.gradient(CAP.nodes), d), exact, rtol=1e-12)


@pytest.mark.parametrize("flipped", [False, True])
def test_thrust_pushes_only_while_the_bell_shrinks(flipped: bool) -> None:
    triangles = CAP.triangles[:, ::-1].copy() if flipped else CAP.triangles
    mesh = replace(CAP, triangles=triangles)
    made = shell(mesh, "midedge")
    dofs = made.model.dofs
    mass = made.model.mass[: dofs.n_positions : 3]
    term = thrust(
        "thrust", dofs, mesh.nodes, triangles, coefficient=7.0, direction=np.array([0, 0, 2.0]), shares=mass
    )
    at_rim = np.zeros((dofs.n_nodes, 3))
    at_rim[mesh.node_groups["rim"]] = mesh.nodes[mesh.node_groups["rim"]]
    for speed, expected in ((-0.1, 1.0), (0.1, 0.0)):
        v = np.concatenate((speed * at_rim.reshape(-1), np.zeros(dofs.n_normals)))
        c = state(made, made.model.rest, v)
        r = np.zeros(dofs.n)
        term.add_residual(c, r)
        force = -r[: dofs.n_positions].reshape(-1, 3)
        rate = term.rate(c)
        assert rate * speed > 0.0
        assert_allclose(force.sum(axis=0), [0.0, 0.0, -7.0 * rate * expected], rtol=1e-12, atol=1e-15)
        assert_allclose(force[:, 2] * mass.sum(), force[:, 2].sum() * mass, rtol=0, atol=1e-14)
    rigid = np.concatenate((np.tile([1.0, 2.0, 3.0], dofs.n_nodes), np.zeros(dofs.n_normals)))
    assert_allclose(term.rate(state(made, made.model.rest, rigid)), 0.0, atol=1e-13)


def test_thrust_derivatives() -> None:
    """A tangent of rank one while the bell shrinks; shares that are not the masses."""
    made = shell(CAP, "midedge")
    dofs = made.model.dofs
    shares = np.random.default_rng(3).uniform(0.5, 1.5, dofs.n_nodes)
    term = thrust(
        "thrust",
        dofs,
        CAP.nodes,
        CAP.triangles,
        coefficient=7.0,
        direction=np.array([1.0, 0, 2.0]),
        shares=shares,
    )
    q, v = disturbed(made)
    v[: dofs.n_positions] -= 20.0 * CAP.nodes.reshape(-1)
    assert term.rate(state(made, q, v)) < -1.0
    scale = np.full(len(q), 0.1 * made.model.length)
    assert_derivatives(term, lambda x, u: state(made, x, u), q, v, made.model, driver=NUMPY, scale=scale)


def test_newton_steps_with_the_tangent_of_thrust() -> None:
    """A bell of the size of the jellyfish scene, its rim moving inward: no iteration more than without."""
    bell = hemisphere(1.0, 6)
    made = shell(bell, "hinge", "springs", Material(1e9, 0.3, 5e-3, 1200.0))
    dofs = made.model.dofs
    mass = made.model.mass[: dofs.n_positions : 3]
    term = thrust(
        "thrust", dofs, bell.nodes, bell.triangles,
        coefficient=1000.0, direction=np.array([0.0, 0, 1]), shares=mass,
    )  # fmt: skip
    v = np.zeros((dofs.n_nodes, 3))
    v[:, :2] = -0.1 * bell.nodes[:, :2] * (1.0 - bell.nodes[:, 2:])
    iterations = []
    for terms in (made.model.terms, (*made.model.terms, term)):
        stepper = Stepper(replace(made.model, terms=terms), ImplicitEuler(), NewtonSettings(), "auto")
        result = stepper.step(stepper.prepare(stepper.rest_state(v.reshape(-1))), 2e-3)
        assert result.status is Status.CONVERGED
        iterations.append(result.iterations)
    momentum = (result.state.v.reshape(-1, 3) * mass[:, None]).sum(axis=0)
    rate = term.rate(state(made, result.state.q, result.state.v))
    assert rate < 0.0
    # implicit Euler: the gain of momentum is dt times the thrust of the end state
    assert_allclose(momentum[2], -1000.0 * rate * 2e-3, rtol=1e-6)
    assert iterations[1] <= iterations[0] + 1
