"""NumPy batches and compiled loops give the same numbers."""

from __future__ import annotations

import numpy as np
import pytest
from cases import (
    NUMPY,
    UNEQUAL,
    adapted,
    configuration,
    disturbed,
    framed_rod,
    helix,
    straight,
    term_cases,
    y_network,
)
from derivatives import Probe
from numpy.testing import assert_allclose
from shell_force_checks import shell_load_cases

from dismech_cli.kernels import batches
from dismech_cli.kernels.driver import Driver
from dismech_cli.kernels.numba_driver import NumbaDriver
from dismech_cli.kinematics.rod_frames import edge_frame, joint_reference_twist
from dismech_cli.model.configuration import Configuration

CASES = term_cases() | shell_load_cases()


@pytest.fixture(scope="module")
def compiled() -> Driver:
    """The compiled driver; loops are built once per process, about 5 s each, and cached on disk."""
    pytest.importorskip("numba")
    return NumbaDriver()


@pytest.mark.parametrize("name", CASES)
def test_drivers_agree(name: str, compiled: Driver) -> None:
    """Energy, residual, stiffness and damping to 1e-12: compiled code reorders sums, no more."""
    case = CASES[name]
    model = case.model
    q = disturbed(model, seed=21)
    v = np.random.default_rng(22).normal(size=model.dofs.n)
    c = configuration(model, q, v, adapted(model, q))
    plain, fast = Probe.of(case.term, model, NUMPY), Probe.of(case.term, model, compiled)
    if plain.bound.potential is not None:
        e = plain.bound.energy(c)
        assert fast.bound.potential is not None
        assert_allclose(fast.bound.energy(c), e, rtol=0, atol=1e-12 * np.abs(e).max())
    pairs = [(plain.residual(c), fast.residual(c)), *zip(plain.tangents(c), fast.tangents(c), strict=True)]
    assert any(np.abs(a).max() > 0.0 for a, _ in pairs)
    for a, b in pairs:
        assert_allclose(b, a, rtol=0, atol=1e-12 * max(np.abs(a).max(), 1e-300))


@pytest.mark.parametrize("shape", [straight(6), helix(6), y_network()], ids=["straight", "helix", "network"])
def test_frames_agree(shape: tuple, compiled: Driver) -> None:
    plain, fast = (framed_rod(*shape, UNEQUAL, driver=driver) for driver in (NUMPY, compiled))
    q = disturbed(plain, seed=23)
    one, two = (m.frames.transport(m.frames.rest(m.rest), q) for m in (plain, fast))
    assert_allclose(two.auxiliary, one.auxiliary, rtol=0, atol=1e-14)
    assert_allclose(two.state.director, one.state.director, rtol=0, atol=1e-14)
    assert_allclose(two.state.tangent, one.state.tangent, rtol=0, atol=1e-15)


def test_compiled_transport_keeps_nan(compiled: Driver) -> None:
    """Optimisation must not delete NaN: a bad position must show in every frame it touches."""
    x = np.ones((10, 2))
    x[0, 1] = np.nan
    out = compiled.map(edge_frame, x, 12)
    assert np.isfinite(out[:, 0]).all()
    assert np.isnan(out[:9, 1]).all()
    y = np.ones((13, 1))
    y[3] = np.nan
    assert np.isnan(compiled.map(joint_reference_twist, y, 1)).all()


def test_compiled_energy_keeps_nan(compiled: Driver) -> None:
    case = CASES["stretch"]
    q = case.model.rest.copy()
    q[0] = np.nan
    stored = case.model.frames.rest(case.model.rest)
    trial = case.model.frames.transport(stored, case.model.rest)
    c = Configuration(0.0, q, np.zeros_like(q), trial)
    bound = Probe.of(case.term, case.model, compiled).bound
    assert bound.potential is not None
    # node 0 ends three of the six edges
    assert np.isnan(bound.energy(c)).sum() == 3
    r = np.zeros_like(q)
    bound.add_residual(c, r)
    assert np.isnan(r[:3]).all()


def test_chunks_do_not_show(monkeypatch: pytest.MonkeyPatch) -> None:
    """Batches are cut to fit the cache: cutting them elsewhere changes no bit."""
    case = CASES["bend_framed_network"]
    q = disturbed(case.model, seed=24)
    c = configuration(case.model, q, np.zeros_like(q), adapted(case.model, q))
    whole = Probe.of(case.term, case.model, NUMPY).tangents(c)[0]
    monkeypatch.setattr(batches, "_CHUNK", 2)
    assert np.array_equal(Probe.of(case.term, case.model, NUMPY).tangents(c)[0], whole)


@pytest.mark.parametrize("name", CASES)
def test_terms_add_into_what_is_there(name: str) -> None:
    """A term adds its share and overwrites nothing, and asking twice gives the same."""
    case = CASES[name]
    q = disturbed(case.model, seed=25)
    v = np.random.default_rng(26).normal(size=case.model.dofs.n)
    c = configuration(case.model, q, v, adapted(case.model, q))
    probe = Probe.of(case.term, case.model, NUMPY)
    first = probe.residual(c)
    r = np.full(case.model.dofs.n, 100.0)
    probe.bound.add_residual(c, r)
    # 100 + r rounds to 1e-14
    assert_allclose(r - 100.0, first, rtol=0, atol=1e-13)
    assert np.array_equal(probe.residual(c), first)
