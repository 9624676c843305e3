"""Energies: derivatives of every term at rest, random and near-degenerate states; closed forms."""

from __future__ import annotations

from collections.abc import Callable
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
    energy_of,
    framed_rod,
    helix,
    isotropic_rod,
    only_bending,
    only_twist,
    planar_rod,
    term_cases,
)
from derivatives import Probe, assert_derivatives, complex_gradient, complex_hessian, unpacked
from numpy.testing import assert_allclose

from dismech_cli.arrays import FloatArray
from dismech_cli.energies.bend_isotropic import BEND_ISOTROPIC
from dismech_cli.energies.bend_planar import BEND_PLANAR
from dismech_cli.energies.bend_twist import BEND_TWIST
from dismech_cli.energies.stretch import STRETCH, STRETCH_PLANAR
from dismech_cli.geometry.rotation import orthonormal_to, parallel_transport, signed_angle
from dismech_cli.kernels.shape import Kernel
from dismech_cli.model.model import Model
from dismech_cli.model.stencil import StencilEnergy

CASES = {name: case for name, case in term_cases().items() if isinstance(case.term, StencilEnergy)}

# Two edge vectors, in units of their own lengths, that strain the formulas.
SHAPES = {
    "straight": ([1.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
    "almost_straight": ([0.6, 0.8, 0.0], [0.6 + 1e-9, 0.8 - 2e-9, 1e-9]),
    "bent": ([1.0, 0.2, -0.1], [0.3, 0.9, 0.4]),
    "bent_170_degrees": ([1.0, 0.0, 0.0], [np.cos(2.967), 0.6 * np.sin(2.967), 0.8 * np.sin(2.967)]),
}
LENGTHS = {"unit": (1.0, 1.0), "short": (1e-6, 1.3e-6), "long": (1e6, 0.8e6), "unequal": (1e-6, 2.0)}


def edge_pairs() -> list[object]:
    return [
        pytest.param(np.array(e) * a, np.array(f) * b, id=f"{shape}-{length}")
        for shape, (e, f) in SHAPES.items()
        for length, (a, b) in LENGTHS.items()
    ]


def node_scale(model: Model, q: FloatArray, part: float = 1.0) -> FloatArray:
    """Size of a perturbation: the shortest edge for nodes, one radian for angles, times ``part``."""
    x = model.dofs.positions(q)
    edges = next(t for t in model.terms if t.name == "stretch").couplings[0].dofs
    width = edges.shape[1] // 2
    ends = edges[:, [0, width]] // model.dofs.dimension
    lengths = np.linalg.norm(x[ends[:, 1]] - x[ends[:, 0]], axis=1)
    shortest = np.full(model.dofs.n_nodes, np.inf)
    np.minimum.at(shortest, ends.reshape(-1), np.repeat(lengths, 2))
    return part * np.concatenate((np.repeat(shortest, model.dofs.dimension), np.ones(model.dofs.n_angles)))


def check(term: StencilEnergy, model: Model, q: FloatArray, part: float = 0.3) -> None:
    stored = adapted(model, q)
    assert_derivatives(
        term,
        lambda q, v: configuration(model, q, v, stored),
        q,
        np.zeros_like(q),
        model,
        driver=NUMPY,
        scale=node_scale(model, q, part),
    )


@pytest.mark.parametrize("name", CASES)
def test_derivatives_at_rest(name: str) -> None:
    case = CASES[name]
    check(case.term, case.model, case.model.rest)


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("name", CASES)
def test_derivatives_at_random_states(name: str, seed: int) -> None:
    case = CASES[name]
    check(case.term, case.model, disturbed(case.model, seed))


def test_random_framed_states_have_reference_twist() -> None:
    """Else the derivative tests would not see it."""
    case = CASES["twist_network"]
    assert np.abs(adapted(case.model, disturbed(case.model, 1)).reference_twist).min() > 0.01


def _stressed(term: StencilEnergy) -> StencilEnergy:
    """The energy with natural strains off by 0.3, so that no Hessian term is multiplied by zero."""
    return term.having({name: term.parameter(name) + 0.3 for name in term.kernel.naturals})


@pytest.mark.parametrize("part", [only_bending, only_twist], ids=["bending", "twist"])
@pytest.mark.parametrize(("e", "f"), edge_pairs())
def test_framed_derivatives_at_degenerate_states(
    part: Callable[[StencilEnergy], StencilEnergy], e: FloatArray, f: FloatArray
) -> None:
    """Third-order remainder of the energy, frames stored at the twisted and bent state."""
    nodes = np.stack((np.zeros(3), e, e + f))
    model = framed_rod(nodes, np.array([[0, 1], [2, 1]]), UNEQUAL)
    q = model.rest.copy()
    q[-2:] = 0.4, -0.9
    stored = model.frames.transport(model.frames.rest(model.rest), q).state
    # At 170 degrees the energy has a pole 0.17 rad away: stay well inside.
    cosine = e @ f / np.linalg.norm(e) / np.linalg.norm(f)
    assert_derivatives(
        _stressed(part(energy_of(model, "bend_twist"))),
        lambda q, v: configuration(model, q, v, stored),
        q,
        np.zeros_like(q),
        model,
        driver=NUMPY,
        scale=node_scale(model, q, 0.3 if cosine > 0.0 else 0.03),
    )


@pytest.mark.parametrize("spin", [0.5, 2.0, 5.0])
def test_derivatives_far_from_the_rest_twist(spin: float) -> None:
    """Unequal stiffnesses, angles that turn each joint of a helix by ``spin`` [rad]."""
    nodes, edges = helix(7)
    model = framed_rod(nodes, edges, UNEQUAL)
    q = model.rest.copy()
    q[model.dofs.n_positions :] = spin * np.arange(len(edges))
    stored = adapted(model, q)
    assert_derivatives(
        _stressed(energy_of(model, "bend_twist")),
        lambda x, v: configuration(model, x, v, stored),
        q,
        np.zeros_like(q),
        model,
        driver=NUMPY,
        scale=node_scale(model, q, 0.3),
    )


def _assert_kernel(kernel: Kernel, y: FloatArray, a: FloatArray, p: FloatArray, variables: int) -> None:
    """Gradient (and Hessian of frameless kernels) against complex steps, made dimensionless."""
    _, gradient, packed = kernel.function(tuple(y), tuple(a), tuple(p))
    hessian = unpacked(packed, kernel.reduced)
    d = kernel.dimension
    size = np.array(
        [np.linalg.norm(y[k * d : (k + 1) * d]) for k in range(len(kernel.vectors)) for _ in range(d)]
    )
    size = np.concatenate((size, np.ones(kernel.angles)))
    g = np.array(gradient) * size
    h = hessian * np.outer(size, size)
    # Round-off of y moves the gradient by h eps; chi = 1 + cos loses log10(2/chi) = 2 digits at 170 degrees.
    unit = 1e-12 * max(np.abs(h).max(), np.abs(g).max())
    assert unit > 0.0
    assert_allclose(g[:variables], (complex_gradient(kernel, y, a, p) * size)[:variables], rtol=0, atol=unit)
    if not kernel.auxiliaries:
        assert_allclose(h, complex_hessian(kernel, y, a, p) * np.outer(size, size), rtol=0, atol=unit)


@pytest.mark.parametrize(("e", "f"), edge_pairs())
@pytest.mark.parametrize(
    "kernel", [BEND_ISOTROPIC, BEND_PLANAR, BEND_TWIST], ids=lambda k: k.function.__name__
)
def test_bending_kernels_by_complex_step(kernel: Kernel, e: FloatArray, f: FloatArray) -> None:
    """To first order the directors turn only along the tangent, so they may be held in the gradient."""
    d = kernel.dimension
    if d == 2:
        e, f = (np.array([x[0], np.copysign(np.linalg.norm(x[1:]), x[1])]) for x in (e, f))
    y = np.concatenate((e, f, np.zeros(kernel.angles)))
    directors: list[float] = []
    if kernel.auxiliaries:
        te, tf = (x / np.linalg.norm(x) for x in (e, f))
        m1e, m1f = (orthonormal_to(np.array([0.3, 0.5, -0.7]), t) for t in (te, tf))
        twist = signed_angle(parallel_transport(m1e, te, tf), m1f, tf)
        directors = [*m1e, *np.cross(te, m1e), *m1f, *-np.cross(tf, m1f), twist]
    p = {
        "bend_planar": [0.4, 1.7, 0.9],
        "bend_isotropic": [1.7, 0.9],
        "bend_twist": [0.4, -0.2, 0.0, 1.7, 0.6, 0.0, 0.9, 1.0, -1.0, np.cos(0.3), np.sin(0.3), 0.3],
    }
    _assert_kernel(kernel, y, np.array(directors), np.array(p[kernel.function.__name__]), 2 * d)


@pytest.mark.parametrize("length", [1e-6, 0.3, 1.0, 1.0 + 1e-9, 1e6])
@pytest.mark.parametrize("kernel", [STRETCH, STRETCH_PLANAR], ids=lambda k: k.function.__name__)
def test_stretching_kernels_by_complex_step(kernel: Kernel, length: float) -> None:
    y = length * np.array([0.6, 0.8]) if kernel.dimension == 2 else length * np.array([0.48, 0.6, 0.64])
    _assert_kernel(kernel, y, np.empty(0), np.array([0.05, 3.0, 1.0]), kernel.reduced)


def test_twist_kernel_angles_by_complex_step() -> None:
    """The angles enter the twist directly; the positions through the reference twist, tested above.

    They enter the bending through the directors, which do not turn here: it has no stiffness.
    """
    y = np.array([1.0, 0.2, -0.1, 0.3, 0.9, 0.4, 0.5, -1.1])
    a = np.array([0.0, 0.0, 1.0, 0.0, -1.0, 0.0] * 2 + [0.7])
    p = np.array([0.0, 0.0, 0.2, 0.0, 0.0, 1.3, 0.8, 1.0, -1.0, 1.0, 0.0, 0.0])
    gradient = np.array(BEND_TWIST.function(tuple(y), tuple(a), tuple(p))[1])
    assert np.abs(gradient[6:]).min() > 0.1
    assert_allclose(complex_gradient(BEND_TWIST, y, a, p)[6:], gradient[6:], rtol=1e-14)


# ---------------------------------------------------------------- closed forms


def test_stretch_of_a_bar() -> None:
    """E = EA l eps^2 / 2 and force EA eps at both ends."""
    model = planar_rod(np.array([[0.0, 0, 0], [2.0, 0, 0]]), chain(2), UNEQUAL)
    q = model.rest.copy()
    q[2] = 2.5
    c = configuration(model, q, np.zeros_like(q), model.frames.rest(q))
    probe = Probe.of(model.terms[0], model, NUMPY)
    assert_allclose(probe.energy(c), 0.5 * 3.0 * 2.0 * 0.25**2, rtol=1e-15)
    assert_allclose(probe.residual(c), [-0.75, 0.0, 0.75, 0.0], rtol=1e-15)


@pytest.mark.parametrize("kind", ["planar", "isotropic", "framed"])
def test_bend_of_a_joint(kind: str) -> None:
    """E = EI (2 tan(phi/2))^2 / (2 l_v) at 60 degrees, in all three models."""
    build = {"planar": planar_rod, "isotropic": isotropic_rod, "framed": framed_rod}[kind]
    x = np.array([[0.0, 0, 0], [1.0, 0, 0], [3.0, 0, 0]])
    rod = replace(UNEQUAL, bending_2=UNEQUAL.bending_1)
    model = build(x, chain(3), rod)
    bent = x.copy()
    bent[2] = [1.0 + 2.0 * np.cos(np.pi / 3), 0.0, 2.0 * np.sin(np.pi / 3)]
    q = model.rest.copy()
    q[: model.dofs.n_positions] = model.dofs.project(bent).reshape(-1)
    c = configuration(model, q, np.zeros_like(q), model.frames.rest(model.rest))
    energy = Probe.of(model.terms[1], model, NUMPY).energy(c)
    assert_allclose(energy, 0.5 * 0.7 / 1.5 * 4.0 / 3.0, rtol=1e-14)


def test_curvature_signs_of_the_framed_rod() -> None:
    """A rod along +x has m1 = +z, m2 = -y: a bend towards z is curvature 1, one towards -y curvature 2."""
    x = np.array([[0.0, 0, 0], [1.0, 0, 0], [2.0, 0, 0]])
    model = framed_rod(x, chain(3), UNEQUAL)
    for direction, stiffness, natural in (
        ([0, 0, 1.0], 0.7, "kappa_1"),
        ([0, -1.0, 0], 1.9, "kappa_2"),
    ):
        q = model.rest.copy()
        q[6:9] = np.add([1.0, 0.0, 0.0], direction)
        term = energy_of(model, "bend_twist").having({natural: 0.5})
        c = configuration(model, q, np.zeros_like(q), model.frames.rest(model.rest))
        energy = Probe.of(term, model, NUMPY).energy(c)
        assert_allclose(energy, 0.5 * stiffness * (2.0 * np.tan(np.pi / 4) - 0.5) ** 2, rtol=1e-14)
