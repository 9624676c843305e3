"""The formulas of docs/theory.md are those of the program."""

from __future__ import annotations

from math import log, pi, sqrt, tan, tanh

import numpy as np
import pytest
from numpy.linalg import det, norm
from numpy.testing import assert_allclose

from dismech_cli.contact.law.quadrature import density
from dismech_cli.contact.law.rubbing import friction_force
from dismech_cli.contact.points.barrier import barrier
from dismech_cli.energies.bend_isotropic import bend_isotropic
from dismech_cli.energies.bend_planar import bend_planar
from dismech_cli.energies.bend_twist import bend_twist
from dismech_cli.energies.hinge import hinge
from dismech_cli.energies.membrane import membrane
from dismech_cli.energies.membrane_neo_hookean import membrane_neo_hookean
from dismech_cli.energies.stretch import stretch
from dismech_cli.energies.stretch_neo_hookean import stretch_neo_hookean
from dismech_cli.forces.aerodynamic import aerodynamic
from dismech_cli.forces.resistive import resistive
from dismech_cli.kinematics.rod_frames import FrameState
from dismech_cli.model.state import State
from dismech_cli.sections.rods import rectangular_section, round_section
from dismech_cli.sections.shells import bending_stiffness, hinge_stiffness, plane_stress_stiffness
from dismech_cli.solve.integrators import (
    GeneralizedAlpha,
    ImplicitEuler,
    ImplicitMidpoint,
    Newmark,
    TrBdf2,
)

RTOL = 1e-12
NONE = FrameState(np.zeros((3, 0)), np.zeros((3, 0)), np.zeros(0))
E_, F_ = np.array([1.0, 0.2, -0.3]), np.array([0.7, 0.5, 0.4])
EI, GJ, LV = 3.0, 0.8, 1.1


def unit(x):
    return x / norm(x)


def binormal():
    te, tf = unit(E_), unit(F_)
    return 2.0 * np.cross(te, tf) / (1.0 + te @ tf)


def transported(x, t0, t1):
    """The vector x turned by the least rotation that takes t0 to t1."""
    b = np.cross(t0, t1)
    c = t0 @ t1
    return c * x + np.cross(b, x) + b * (b @ x) / (1.0 + c)


def turned(x, t, angle):
    return np.cos(angle) * x + np.sin(angle) * np.cross(t, x)


def some_state(seed):
    q, v, a = np.random.default_rng(seed).normal(size=(3, 4))
    return State(q=q, v=v, a=a, t=0.5, frames=NONE)


def test_stretching():
    energy, *_ = stretch(tuple(E_), (), (0.05, 7.0, 0.9))
    assert_allclose(energy, 0.5 * 7.0 * 0.9 * (norm(E_) / 0.9 - 1.0 - 0.05) ** 2, rtol=RTOL)


def test_curvature_binormal():
    phi = np.arccos(unit(E_) @ unit(F_))
    assert_allclose(norm(binormal()), 2.0 * tan(phi / 2.0), rtol=RTOL)
    energy, *_ = bend_isotropic((*E_, *F_), (), (EI, LV))
    assert_allclose(energy, EI * binormal() @ binormal() / (2.0 * LV), rtol=RTOL)


def test_bending_in_the_plane():
    phi = 0.8
    energy, *_ = bend_planar((1.0, 0.0, 0.7 * np.cos(phi), 0.7 * np.sin(phi)), (), (0.1, EI, LV))
    assert_allclose(energy, 0.5 * EI * (2.0 * tan(phi / 2.0) - 0.1) ** 2 / LV, rtol=RTOL)


def test_bending_and_twisting():
    te, tf = unit(E_), unit(F_)
    beta, angle_e, angle_f = 0.3, 0.2, 1.0
    r1e = unit(np.cross(te, [0.0, 0.0, 1.0]))
    r1f = turned(transported(r1e, te, tf), tf, beta)  # reference directors of f, twisted by beta
    m1e, m1f = turned(r1e, te, angle_e), turned(r1f, tf, angle_f)
    m2e, m2f = np.cross(te, m1e), np.cross(tf, m1f)
    twist = angle_f - angle_e + beta
    d1 = turned(m1e, te, 0.5 * twist)
    d2 = np.cross(te, d1)
    assert_allclose(transported(d1, te, tf), turned(m1f, tf, -0.5 * twist), atol=1e-14)
    k1, k2 = binormal() @ d2, -binormal() @ d1
    p = (0.1, -0.2, 0.05, 3.0, 2.0, GJ, LV, 1.0, 1.0, 1.0, 0.0, 0.0)
    energy, *_ = bend_twist((*E_, *F_, angle_e, angle_f), (*m1e, *m2e, *m1f, *m2f, beta), p)
    expected = (3.0 * (k1 - 0.1) ** 2 + 2.0 * (k2 + 0.2) ** 2 + GJ * (twist - 0.05) ** 2) / (2.0 * LV)
    assert_allclose(np.sum(energy), expected, rtol=RTOL)


def test_sections():
    assert_allclose(round_section(2.0).torsion, 2.0 * pi * 16.0 / 4.0, rtol=RTOL)
    a, b = 3.0, 1.0
    expected = a * b**3 * (1.0 / 3.0 - 0.21 * b / a * (1.0 - b**4 / (12.0 * a**4)))
    assert_allclose(rectangular_section(a, b).torsion, expected, rtol=RTOL)


A_, B_ = np.array([1.0, 0.0]), np.array([0.3, 0.8])
STRETCHED = np.array([[1.2, 0.1], [-0.05, 0.9]])


def metric():
    return A_ @ A_, B_ @ B_, A_ @ B_


def test_membrane():
    young, nu, h = 5.0, 0.3, 0.1
    area = 0.5 * abs(det([A_, B_]))
    stiffness = plane_stress_stiffness(np.array(metric())[:, None], young, nu, h)[:, 0]
    a, b = STRETCHED @ A_, STRETCHED @ B_
    energy, *_ = membrane((*a, 0.0, *b, 0.0), (), (0.0, *metric(), *stiffness))
    green = 0.5 * (STRETCHED.T @ STRETCHED - np.eye(2))
    lam, mu = young * nu / (1.0 - nu**2), young / (2.0 * (1.0 + nu))
    expected = h * area * (0.5 * lam * np.trace(green) ** 2 + mu * (green * green).sum())
    assert_allclose(energy, expected, rtol=RTOL)


def test_rubber():
    cauchy = STRETCHED.T @ STRETCHED
    a, b = STRETCHED @ A_, STRETCHED @ B_
    energy, *_ = membrane_neo_hookean((*a, 0.0, *b, 0.0), (), (0.0, *metric(), 2.0))
    assert_allclose(energy, 2.0 / 2.0 * (np.trace(cauchy) - 3.0 + 1.0 / det(cauchy)), rtol=RTOL)
    stretched = 1.7
    energy, *_ = stretch_neo_hookean((0.9 * stretched, 0.0, 0.0), (), (0.0, 0.0, 2.0, 0.9))
    assert_allclose(energy, 2.0 / 2.0 * 0.9 * (stretched**2 + 2.0 / stretched - 3.0), rtol=RTOL)


def test_mid_edge_normals():
    nodes = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.3, 0.8, 0.0]])
    young, nu, h = 5.0, 0.3, 0.1
    upper = bending_stiffness(nodes, np.array([[0, 1, 2]]), young, nu, h)[:, 0]
    m = np.zeros((3, 3))
    m[np.triu_indices(3)] = upper
    m = m + np.triu(m, 1).T
    alpha = np.array([0.1, -0.2, 0.3])
    area = 0.5 * det([A_, B_])
    shape = np.zeros((2, 2))
    for i in range(3):
        side = (nodes[(i + 2) % 3] - nodes[(i + 1) % 3])[:2]
        t = np.array([side[1], -side[0]])
        shape += alpha[i] * np.outer(t, t) / (area * norm(side))
    rigidity = young * h**3 / (12.0 * (1.0 - nu**2))
    trace = np.trace(shape)
    expected = 0.5 * rigidity * area * ((1.0 - nu) * np.trace(shape @ shape) + nu * trace**2)
    assert_allclose(0.5 * alpha @ m @ alpha, expected, rtol=RTOL)


def test_hinges():
    angle = 0.6
    corner = (0.5, -np.cos(angle), np.sin(angle))
    energy, *_ = hinge((1.0, 0.0, 0.0, 0.5, 1.0, 0.0, *corner), (), (0.0, 4.0))
    assert_allclose(energy, 0.5 * 4.0 * angle**2, rtol=RTOL)
    assert_allclose(hinge_stiffness(5.0, 0.1, 1), 2.0 / sqrt(3.0) * 5.0 * 0.1**3 / 12.0, rtol=RTOL)


def test_fluids():
    u, t = np.array([0.3, -0.5, 0.2]), unit(E_)
    r, *_ = resistive(tuple(E_), tuple(u), (0.9, 2.0, 5.0))
    assert_allclose(r, 0.9 * (5.0 * u + (2.0 - 5.0) * t * (t @ u)), rtol=RTOL)
    a, b, share = (1.0, 0.0, 0.0), (0.3, 0.8, 0.0), 0.7 * 0.4 / 6.0
    r, *_ = aerodynamic((*a, *b), (0.0, 0.1, -2.0, 0.0, 0.0, 3.0, 1.0, 0.0, 0.0), (share,))
    assert_allclose(np.reshape(r, (3, 3))[:, 2], [-share * 4.0, share * 9.0, 0.0], atol=1e-15)


@pytest.mark.parametrize("distance", [0.1, 0.7, 0.99])
def test_density_of_contact(distance):
    reach = 1.0
    energy, *_ = density(np.array(distance**2), reach, 1.0)
    assert_allclose(energy, (reach**2 - distance**2) ** 2 / (4.0 * reach**2), rtol=RTOL)


def test_barrier():
    reach, k = 0.4, 3.0
    energy, *_ = barrier(np.array([0.3, 0.05]), reach, k)
    h = reach / 2.0
    assert_allclose(energy, [k * (reach - 0.3) ** 2, 2.0 * k * h**2 * (0.5 - log(0.05 / h))], rtol=RTOL)


def test_friction():
    u, slip_speed = np.array([0.02, -0.01, 0.0]), 0.05
    force = friction_force(2.0, 7.5 / slip_speed, tuple(u))
    assert_allclose(force, 2.0 * tanh(7.5 * norm(u) / slip_speed) * u / norm(u), rtol=RTOL)


START, MIDDLE, END = some_state(1), some_state(2), some_state(3)
H = 0.02
ALPHAS = {0.8: (1.0 / 3.0, 4.0 / 9.0), 0.0: (-1.0, 0.0)}  # alpha_m, alpha_f


@pytest.mark.parametrize("rho", ALPHAS)
def test_generalised_alpha(rho):
    m, f = ALPHAS[rho]
    gamma, beta = 0.5 - m + f, 0.25 * (1.0 - m + f) ** 2
    integrator = GeneralizedAlpha(spectral_radius=rho)
    stage = integrator.stage(0, START, START, H)
    v, a = stage.finish(END.q)
    assert_allclose(
        END.q, START.q + H * START.v + H**2 * ((0.5 - beta) * START.a + beta * a), rtol=RTOL, atol=1e-12
    )
    assert_allclose(v, START.v + H * ((1.0 - gamma) * START.a + gamma * a), rtol=1e-10)
    assert_allclose(stage.acceleration(END.q), (1.0 - m) * a + m * START.a, rtol=1e-10)
    assert_allclose(stage.position(END.q), (1.0 - f) * END.q + f * START.q, rtol=RTOL)
    assert_allclose(stage.velocity(END.q), (1.0 - f) * v + f * START.v, rtol=1e-10)
    expected = (beta - 1.0 / 6.0 - 0.5 * (f - m)) * H**2 * (END.a - START.a)
    assert_allclose(integrator.error((START, END), H), expected, rtol=1e-10)


def test_tr_bdf2():
    g = 2.0 - sqrt(2.0)
    stage = TrBdf2().stage(1, START, MIDDLE, H)
    scale = (2.0 - g) / ((1.0 - g) * H)

    def backwards(end, middle, start):
        return scale * (end - middle / (g * (2.0 - g)) + (1.0 - g) ** 2 / (g * (2.0 - g)) * start)

    v = backwards(END.q, MIDDLE.q, START.q)
    assert_allclose(stage.velocity(END.q), v, rtol=1e-10)
    assert_allclose(stage.acceleration(END.q), backwards(v, MIDDLE.v, START.v), rtol=1e-9)
    trapezoid = TrBdf2().stage(0, START, START, H)
    assert_allclose(trapezoid.t_end, START.t + g * H, rtol=RTOL)
    w = sqrt(2.0) / 4.0
    early, late = w - (1.0 - w) / 3.0, w - (3.0 * w + 1.0) / 3.0
    expected = H * (early * START.v + late * MIDDLE.v + g / 3.0 * END.v)
    assert_allclose(TrBdf2().error((START, MIDDLE, END), H), expected, rtol=1e-10)


@pytest.mark.parametrize(
    ("integrator", "error"),
    [
        (ImplicitEuler(), 0.5 * H * (END.v - START.v)),
        (ImplicitMidpoint(), H**2 / 12.0 * (END.a - START.a)),
        (Newmark(), H**2 / 12.0 * (END.a - START.a)),
    ],
)
def test_errors_of_the_others(integrator, error):
    assert_allclose(integrator.error((START, END), H), error, rtol=1e-10)
