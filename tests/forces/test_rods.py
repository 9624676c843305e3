"""Forces: derivatives, closed forms, symmetry of tangents, mass and weight."""

from __future__ import annotations

import numpy as np
import pytest
from cases import (
    NUMPY,
    SILICONE,
    UNEQUAL,
    adapted,
    chain,
    configuration,
    disturbed,
    framed_rod,
    helix,
    isotropic_rod,
    planar_rod,
    straight,
    term_cases,
    y_network,
)
from derivatives import Probe, assert_derivatives
from numpy.testing import assert_allclose

from dismech_cli.arrays import FloatArray, IntArray
from dismech_cli.forces.gravity import weight
from dismech_cli.forces.load import DeadLoad
from dismech_cli.forces.moment import EdgeMoment
from dismech_cli.forces.resistive import resistive_force
from dismech_cli.laws.laws import Constant, Ramp
from dismech_cli.model.model import Model
from dismech_cli.model.stencil import StencilEnergy

# the tangent of a moment on an edge with an angle is checked with the torque that it balances, below
CASES = {
    name: case
    for name, case in term_cases().items()
    if not isinstance(case.term, StencilEnergy) and name != "moment_framed"
}


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("name", CASES)
def test_derivatives(name: str, seed: int) -> None:
    case = CASES[name]
    model = case.model
    q = disturbed(model, seed)
    stored = adapted(model, q)
    scale = np.full(model.dofs.n, 0.3)
    scale[: model.dofs.n_positions] *= model.length
    assert_derivatives(
        case.term,
        lambda q, v: configuration(model, q, v, stored),
        q,
        np.random.default_rng(seed).normal(size=model.dofs.n),
        model,
        driver=NUMPY,
        scale=scale,
    )


def residual(model: Model, term: object, q: FloatArray, v: FloatArray, t: float = 0.3) -> FloatArray:
    c = configuration(model, q, v, model.frames.rest(model.rest), t)
    return Probe.of(term, model, NUMPY).residual(c)


def test_weight_is_the_mass_of_the_rod() -> None:
    x, edges = straight(11, 0.1)
    model = framed_rod(x, edges, SILICONE)
    nodal = model.mass[:33:3]
    force = weight(model.dofs, nodal, np.array([0.0, 0.0, -9.81]))
    mass = 1200.0 * np.pi * 1e-6 * 0.1
    assert_allclose(nodal.sum(), mass, rtol=1e-14)
    assert_allclose(force[2:33:3].sum(), -9.81 * mass, rtol=1e-14)
    assert_allclose(force[33:], 0.0, atol=0.0)
    # polar inertia of a disc: rho l (I1 + I2) = rho l pi r^4 / 2
    assert_allclose(model.mass[33:], 1200.0 * 0.01 * np.pi * 1e-12 / 2.0, rtol=1e-12)


def test_buoyancy_lifts_the_displaced_water() -> None:
    model = planar_rod(*straight(3), UNEQUAL)
    force = weight(model.dofs, -1000.0 * np.array([1e-3, 2e-3, 1e-3]), np.array([0.0, 0.0, -9.81]))
    assert_allclose(force, [0, 9.81, 0, 19.62, 0, 9.81], rtol=1e-14)


def test_dead_load_follows_its_law() -> None:
    model = planar_rod(*straight(3), UNEQUAL)
    force = np.arange(6.0)
    load = DeadLoad("f", force, Ramp(before=0.0, after=2.0, start=0.0, end=1.0))
    for t, factor in ((-1.0, 0.0), (0.25, 0.5), (3.0, 2.0)):
        assert_allclose(residual(model, load, model.rest, model.rest, t), -factor * force, rtol=1e-15)


@pytest.mark.parametrize("build", [planar_rod, isotropic_rod, framed_rod])
@pytest.mark.parametrize(("direction", "coefficient"), [([1.0, 0, 0], 0.3), ([0, 0, 1.0], 1.1)])
def test_resistive_drag_of_a_straight_rod(build: object, direction: list[float], coefficient: float) -> None:
    """Total drag c L u: along the rod with c_t, across it with c_n."""
    x, edges = straight(7, 2.0)
    model = build(x, edges, UNEQUAL)
    dofs = model.dofs
    u = 1.7 * dofs.project(np.array(direction))
    v = np.zeros(dofs.n)
    v[: dofs.n_positions] = np.tile(u, 7)
    term = resistive_force("drag", dofs, edges, np.full(6, 1.0 / 3.0), tangential=0.3, normal=1.1)
    total = dofs.positions(residual(model, term, model.rest, v)).sum(axis=0)
    assert_allclose(total, coefficient * 2.0 * u, rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("shape", [helix(6), y_network()], ids=["chain", "network"])
def test_resistive_drag_dissipates(shape: tuple[FloatArray, IntArray]) -> None:
    x, edges = shape
    model = isotropic_rod(x, edges, UNEQUAL)
    term = resistive_force("drag", model.dofs, edges, np.ones(len(edges)), tangential=0.3, normal=1.1)
    for seed in range(5):
        v = np.random.default_rng(seed).normal(size=model.dofs.n)
        power = v @ residual(model, term, model.rest, v)
        # Between c_t and c_n times sum of l u^2: the lengths of nodes sum to those of edges.
        lengths = np.bincount(edges.reshape(-1), minlength=len(x)) / 2.0
        size = (lengths[:, None] * model.dofs.positions(v) ** 2).sum()
        assert 0.3 * size < power < 1.1 * size


def _moment(model: Model, edges: IntArray, moment: list[float], *, angles: IntArray) -> EdgeMoment:
    dofs = model.dofs
    return EdgeMoment(
        "moment",
        dofs.of_nodes(edges[:1, 0]),
        dofs.of_nodes(edges[:1, 1]),
        angles,
        dofs.axes,
        np.array([moment]),
        Constant(1.0),
    )


def test_edge_moment_is_a_couple() -> None:
    """No net force; the couple and the torque on the angle together are the moment."""
    x, edges = helix(4)
    model = framed_rod(x, edges, UNEQUAL)
    wanted = np.array([0.3, -0.8, 0.5])
    force = -residual(
        model,
        _moment(model, edges, wanted.tolist(), angles=model.dofs.of_angles(np.array([0]))),
        model.rest,
        np.zeros(model.dofs.n),
    )
    f = model.dofs.positions(force)
    tangent = (x[1] - x[0]) / np.linalg.norm(x[1] - x[0])
    assert_allclose(f.sum(axis=0), 0.0, atol=1e-15)
    assert_allclose(np.cross(x, f).sum(axis=0) + force[12] * tangent, wanted, rtol=1e-14)


def test_planar_edge_moment_has_a_potential() -> None:
    """In the plane -M_y times the edge's angle is its potential: the tangent is symmetric."""
    x, edges = straight(3)
    model = planar_rod(x, edges, UNEQUAL)
    term = _moment(model, edges, [0.0, 1.3, 0.0], angles=np.empty(0, dtype=np.int64))
    q = disturbed(model, 4)
    c = configuration(model, q, np.zeros_like(q), model.frames.rest(q))
    stiffness, _ = Probe.of(term, model, NUMPY).tangents(c)
    assert np.abs(stiffness).max() > 1.0
    assert_allclose(stiffness, stiffness.T, rtol=0, atol=1e-13 * np.abs(stiffness).max())


def test_positive_moment_turns_by_the_right_hand() -> None:
    """A moment about y turns an edge along +x towards -z."""
    x, edges = straight(2, 1.0)
    model = planar_rod(x, edges, UNEQUAL)
    term = _moment(model, chain(2), [0.0, 1.0, 0.0], angles=np.empty(0, dtype=np.int64))
    force = -residual(model, term, model.rest, np.zeros(4))
    assert_allclose(force, [0.0, 1.0, 0.0, -1.0], atol=1e-15)


def test_tangent_of_a_balanced_torque() -> None:
    """A twisted rod held by moments on its ends: elastic and load tangents make up the derivative together.

    Neither does alone: r is a gradient only where the frames are stored, and its derivative has a skew
    part as large as the unbalanced torque on the angle.
    """
    x, edges = helix(4)
    model = framed_rod(x, edges, UNEQUAL)
    dofs = model.dofs
    q = disturbed(model, 1)
    stored = adapted(model, q)
    elastic = [Probe.of(term, model, NUMPY) for term in model.terms]
    torques = sum(probe.residual(configuration(model, q, q, stored)) for probe in elastic)[
        dofs.of_angles(np.arange(3))
    ]
    e = np.diff(dofs.positions(q), axis=0)
    load = EdgeMoment(
        "moment",
        dofs.of_nodes(edges[:, 0]),
        dofs.of_nodes(edges[:, 1]),
        dofs.of_angles(np.arange(3)),
        dofs.axes,
        torques[:, None] * e / np.linalg.norm(e, axis=1)[:, None],
        Constant(1.0),
    )
    probes = [*elastic, Probe.of(load, model, NUMPY)]

    def residual(p: FloatArray) -> FloatArray:
        return sum(probe.residual(configuration(model, p, p, stored)) for probe in probes)

    assert_allclose(residual(q)[dofs.of_angles(np.arange(3))], 0.0, atol=1e-12 * np.abs(torques).max())
    tangent = sum(probe.tangents(configuration(model, q, q, stored))[0] for probe in probes)
    h = 1e-6 * model.length
    steps = h * np.eye(dofs.n)
    slope = np.stack([(residual(q + d) - residual(q - d)) / (2.0 * h) for d in steps], axis=1)
    assert_allclose(tangent, slope, rtol=0, atol=1e-7 * np.abs(slope).max())
