"""Material damping: slopes and curvatures of strains, tangents, rigid motions, both drivers."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from cases import NUMPY, adapted, disturbed, term_cases
from derivatives import STEPS, Probe
from hybrid_cases import hybrid
from numpy.testing import assert_allclose
from order import assert_remainder
from shell_cases import Material, shell

from dismech_cli.arrays import FloatArray
from dismech_cli.energies.membrane import MEMBRANE
from dismech_cli.energies.strain_rates import RATES, damping_term
from dismech_cli.kernels.driver import Driver
from dismech_cli.kinematics.rod_frames import FrameState
from dismech_cli.mesh.generate.sheets import Pattern, sheet
from dismech_cli.model.configuration import Configuration
from dismech_cli.model.model import Model
from dismech_cli.model.stencil import StencilEnergy

TAU = 0.3


def cases() -> dict[str, tuple[StencilEnergy, Model]]:
    """Every energy that has a damping."""
    found = {
        name: (case.term, case.model)
        for name, case in term_cases().items()
        if isinstance(case.term, StencilEnergy) and case.term.kernel in RATES
    }
    mesh = sheet(1.0, 0.7, 2, Pattern.RIGHT)
    for bending, membrane in (("midedge", "cst"), ("hinge", "springs"), ("averaged", "cst")):
        model = shell(mesh, bending, membrane, Material(youngs_modulus=2.0, thickness=0.3)).model
        for term in model.terms:
            assert isinstance(term, StencilEnergy)
            found[membrane if term.name == "membrane" else bending] = term, model
    for way, toward in (("", True), (", away", False)):
        joined = hybrid(toward)
        found[f"rod_on_face{way}"] = joined.on, joined.model
        found[f"rod_beside_face{way}"] = joined.beside, joined.model
    return found


CASES = cases()


def test_every_damping_has_a_case() -> None:
    assert {term.kernel for term, _ in CASES.values()} == set(RATES)


def state(model: Model, seed: int) -> tuple[FloatArray, FloatArray, FrameState]:
    q = disturbed(model, seed)
    v = np.random.default_rng(seed).normal(size=len(q))
    return q, v, adapted(model, q)


def at(model: Model, frames: FrameState) -> Callable[[FloatArray, FloatArray], Configuration]:
    return lambda q, v: Configuration(0.0, q, v, model.frames.transport(frames, q))


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("seed", [1, 2])
def test_rates_are_those_of_the_strains(name: str, seed: int) -> None:
    """The power r.v is tau times the second derivative of the energy along the motion, stress-free there.

    Without stress the energy of a near shape is e.C.e / 2 of its strains from here: so no derivative of
    a strain enters the test but along a motion, where frames are transported.
    """
    energy, model = CASES[name]
    q, v, frames = state(model, seed)
    term, c = damping_term(energy, TAU), at(model, frames)(q, v)
    power = float(Probe.of(term, model, NUMPY).residual(c) @ v)
    assert power > 0.0
    relaxed = stress_free(energy, model, c)
    stiffness, _ = Probe.of(relaxed, model, NUMPY).tangents(c)
    assert_allclose(power, TAU * (v @ stiffness @ v), rtol=1e-9)


def stress_free(energy: StencilEnergy, model: Model, c: Configuration) -> StencilEnergy:
    """The same energy with its natural strains where the state is: by Newton's step, for E is quadratic."""
    if energy.kernel is MEMBRANE:
        x = model.dofs.positions(c.q)[energy.dofs[:, ::3] // 3]
        return energy.having(dict(zip(("A11", "A22", "A12"), metric(x), strict=True)))
    names = energy.kernel.naturals

    def values(natural: FloatArray) -> FloatArray:
        potential = Probe.of(
            energy.having(dict(zip(names, natural, strict=True))), model, NUMPY
        ).bound.potential
        assert potential is not None
        return np.asarray(potential.energy(c).sum(axis=0))

    here, h = energy.natural.copy(), 0.25
    count, stencils = here.shape
    for _ in range(2):
        unit = np.eye(count)[:, :, None] * h * np.ones(stencils)
        middle = values(here)
        plus = np.array([values(here + step) for step in unit])
        minus = np.array([values(here - step) for step in unit])
        both = np.array([[values(here + one + two) for one in unit] for two in unit])
        slope = (plus - minus) / (2.0 * h)
        curvature = (both - plus[:, None] - plus[None, :] + middle) / h**2
        for s in range(stencils):
            here[:, s] -= np.linalg.lstsq(curvature[:, :, s], slope[:, s], rcond=1e-9)[0]
    return energy.having(dict(zip(names, here, strict=True)))


def metric(x: FloatArray) -> FloatArray:
    """Of triangles (T, 3, 3), shape (3, T)."""
    a, b = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]
    return np.stack([(a * a).sum(axis=1), (b * b).sum(axis=1), (a * b).sum(axis=1)])


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("seed", [3, 4])
def test_tangents(name: str, seed: int) -> None:
    """r(q + h d, v + h w) = r + h (K d + C w) + O(h^2).

    Where frames are transported along rods, second derivatives are those along straight paths: there the
    power of the stress is watched along the motion, where the turn of frames on closed paths drops out.
    """
    energy, model = CASES[name]
    q, v, frames = state(model, seed)
    probe, here = Probe.of(damping_term(energy, TAU), model, NUMPY), at(model, frames)
    residual = probe.residual(here(q, v))
    stiffness, damping = probe.tangents(here(q, v))
    assert_allclose(damping, damping.T, atol=1e-12 * np.abs(damping).max())
    assert np.linalg.eigvalsh(damping).min() > -1e-12 * np.abs(damping).max()
    assert_allclose(damping @ v, residual, atol=1e-12 * np.abs(residual).max())
    along_rods = energy.kernel.auxiliaries in (6, 12, 13)
    d = v * 0.02 if along_rods else 0.02 * np.random.default_rng(seed + 10).normal(size=len(q))
    watched = v[None] / np.linalg.norm(v) if along_rods else np.eye(len(q))

    def remainder(h: float) -> float:
        change = probe.residual(here(q + h * d, v)) - residual - h * stiffness @ d
        return float(np.abs(watched @ change).max())

    scale = np.abs(residual).max() + np.abs(stiffness).max()
    assert_remainder(remainder, STEPS, 2.0, 1e-13 * scale)


@pytest.mark.parametrize("name", CASES)
def test_rigid_motions_meet_no_force(name: str) -> None:
    """A rotation about any axis through any point, of a deformed shape: to rounding."""
    energy, model = CASES[name]
    q, _, frames = state(model, 5)
    dofs, spin = model.dofs, np.random.default_rng(7).normal(size=3)
    if dofs.dimension == 2:
        (normal,) = {0, 1, 2}.difference(dofs.axes)
        spin = np.eye(3)[normal]
    v = np.zeros_like(q)
    x = np.zeros((dofs.n_nodes, 3))
    x[:, dofs.axes] = dofs.positions(q)
    moved = np.cross(spin, x) + np.array([0.3, -0.2, 0.7])
    dofs.positions(v)[:] = moved[:, dofs.axes]
    ends, angles = turning(energy, model)
    tangent = x[ends[:, 1]] - x[ends[:, 0]]
    v[angles] = tangent @ spin / np.linalg.norm(tangent, axis=1)
    probe = Probe.of(damping_term(energy, TAU), model, NUMPY)
    c = at(model, frames)(q, v)
    _, damping = probe.tangents(c)
    # forces of a motion as fast that strains
    scale = np.abs(damping).max() * np.abs(v).max()
    assert_allclose(probe.residual(c), 0.0, atol=1e-13 * scale)


def turning(energy: StencilEnergy, model: Model) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of the edges that carry an angle, and these angles."""
    dofs, kernel = model.dofs, energy.kernel
    nodes = energy.dofs[:, : kernel.dimension * kernel.nodes : kernel.dimension] // dofs.dimension
    angles = energy.dofs[:, kernel.dimension * kernel.nodes :]
    if not kernel.angles:
        return np.empty((0, 2), dtype=np.int64), np.empty(0, dtype=np.int64)
    if kernel.angles == 1:
        signs, pairs = energy.parameter("sign")[:, None], nodes[:, None, :2]
    elif kernel.angles == 2:
        signs = np.stack([energy.parameter("sign_e"), energy.parameter("sign_f")], axis=1)
        pairs = np.stack([nodes[:, [0, 1]], nodes[:, [1, 2]]], axis=1)
    else:
        signs = np.stack([energy.parameter(f"sign_{k}") for k in range(3)], axis=1)
        pairs = np.stack([nodes[:, [1, 2]], nodes[:, [2, 0]], nodes[:, [0, 1]]], axis=1)
    ends = np.where(signs[:, :, None] > 0, pairs, pairs[:, :, ::-1])
    return ends.reshape(-1, 2), angles.reshape(-1)


# one of one strain, one of three with frames; the others compile for half a minute each
QUICK = ("bend_planar", "stretch", "bend_twist")


@pytest.mark.parametrize(
    "name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in CASES]
)
def test_both_drivers(name: str) -> None:
    pytest.importorskip("numba")
    from dismech_cli.kernels.numba_driver import NumbaDriver

    energy, model = CASES[name]
    q, v, frames = state(model, 6)
    term, c = damping_term(energy, TAU), at(model, frames)(q, v)

    def results(driver: Driver) -> list[FloatArray]:
        probe = Probe.of(term, model, driver)
        return [probe.residual(c), *probe.tangents(c)]

    for one, two in zip(results(NUMPY), results(NumbaDriver()), strict=True):
        assert_allclose(two, one, rtol=0, atol=1e-12 * np.abs(one).max())
