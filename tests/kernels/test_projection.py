"""Projected tangents: what they keep, what they change, and that Newton gets past buckling by them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cases import NUMPY, adapted, configuration, disturbed, term_cases
from derivatives import dense
from linear_systems import SOLVERS, system
from numpy.testing import assert_allclose
from shell_cases import shell

from dismech_cli.compose.compose import compose
from dismech_cli.kernels.linearization import Linearization
from dismech_cli.kernels.projection import ProjectedDriver, clamped
from dismech_cli.mesh.generate.sheets import sheet
from dismech_cli.run.simulation import Simulation
from dismech_cli.scenario.load import load
from dismech_cli.solve.linear.choice import LINEAR_SOLVERS
from dismech_cli.solve.pattern import SparsityPattern
from dismech_cli.solve.status import Status
from dismech_cli.solve.step import Stepper
from dismech_cli.solve.step_result import StepResult
from dismech_cli.solve.tangents import TANGENTS

STRIP = Path(__file__).parents[2] / "scenarios" / "buckled_strip.yaml"
ROWS, COLUMNS = np.triu_indices(5)


def full(packed: np.ndarray) -> np.ndarray:
    """Matrices (S, 5, 5) of packed columns."""
    out = np.zeros((packed.shape[1], 5, 5))
    out[:, ROWS, COLUMNS] = out[:, COLUMNS, ROWS] = packed.T
    return out


def test_clamp_is_the_nearest_semidefinite_matrix() -> None:
    """Higham 1988: the rest is the negative part, orthogonal to the result."""
    packed = np.random.default_rng(1).normal(size=(15, 40))
    before, after = full(packed), full(clamped(packed, 5))
    assert (np.linalg.eigvalsh(before)[:, 0] < 0.0).any()
    scale = np.abs(before).max()
    assert np.linalg.eigvalsh(after).min() > -1e-14 * scale
    assert np.linalg.eigvalsh(before - after).max() < 1e-14 * scale
    assert np.abs(after @ (before - after)).max() < 1e-13 * scale**2


def test_clamp_leaves_definite_matrices_and_nan_as_they_are() -> None:
    factors = np.random.default_rng(2).normal(size=(6, 5, 5))
    packed = (factors @ factors.transpose(0, 2, 1))[:, ROWS, COLUMNS].T.copy()
    packed[3, 2] = np.nan
    assert np.array_equal(clamped(packed, 5), packed, equal_nan=True)


@pytest.mark.parametrize("bending", ["hinge", "midedge", "averaged"])
def test_only_the_tangent_changes_and_it_is_semidefinite(bending: str) -> None:
    model = shell(sheet(1.0, 1.0, 3), bending).model
    q = disturbed(model, seed=4)
    c = configuration(model, q, np.zeros_like(q), adapted(model, q))
    pattern = SparsityPattern.build(
        model.dofs,
        np.ones(model.dofs.n, dtype=bool),
        [k for t in model.terms for k in t.couplings],
        symmetric=True,
    )
    for term in model.terms:
        results = []
        for driver in (NUMPY, ProjectedDriver(NUMPY)):
            into = Linearization.of(model.dofs.n, pattern.slots)
            bound = term.bind(pattern, driver)
            bound.add_linearization(c, into)
            results.append((bound.energy(c), into.residual, dense(pattern, into.stiffness)))
        (e0, r0, k0), (e1, r1, k1) = results
        assert np.array_equal(e0, e1)
        assert np.array_equal(r0, r1)
        scale = np.abs(k0).max()
        assert np.linalg.eigvalsh(k0)[0] < -1e-6 * scale
        # rounding of a sum over at most eight stencils per node
        assert np.linalg.eigvalsh(k1)[0] > -1e-13 * scale


@pytest.mark.parametrize("kind", ["positive", "indefinite", "unsymmetric"])
@pytest.mark.parametrize("name", SOLVERS)
def test_solvers_know_an_indefinite_matrix(name: str, kind: str) -> None:
    model = next(iter(term_cases().values())).model
    pattern, values = system(kind, model)
    factors = LINEAR_SOLVERS[name](pattern).factorize(values)
    assert factors.indefinite == (kind == "indefinite")


def strip(projection: str) -> Simulation:
    return compose(
        load(STRIP, overrides=[f"numerics.newton.projection={projection}"]), kernels="numpy"
    ).simulation


def pushed(simulation: Simulation) -> tuple[StepResult, Stepper]:
    """The first load step: two per cent, sixty times the shortening at which the strip buckles."""
    stepper = Stepper(simulation.model, simulation.integrator, simulation.newton, simulation.linear_solver)
    return stepper.step(stepper.prepare(stepper.rest_state()), 0.2), stepper


def test_newton_leaves_the_unstable_branch_only_if_projected() -> None:
    flat, stepper = pushed(strip("none"))
    assert flat.status is Status.CONVERGED
    assert stepper.stability.negative_eigenvalues(flat.state) > 0
    bent, stepper = pushed(strip("indefinite"))
    assert bent.status is Status.CONVERGED
    assert stepper.stability.negative_eigenvalues(bent.state) == 0
    z = [r.state.q[2 : stepper.model.dofs.n_positions : 3] for r in (flat, bent)]
    assert np.abs(z[0]).max() < 1e-6
    assert z[1].min() < -8e-3


def test_projection_does_nothing_where_the_tangent_is_definite() -> None:
    """A plate that sags a little is stable all the way: the same iterates to the last bit."""
    folder = STRIP.parent
    results = []
    for projection in TANGENTS:
        loaded = load(folder / "plate.yaml", overrides=["geometry[0].generate.divisions=4"])
        simulation = compose(loaded, kernels="numpy").simulation
        settings = replace(simulation.newton, factorize=TANGENTS[projection])
        stepper = Stepper(simulation.model, simulation.integrator, settings, simulation.linear_solver)
        results.append(stepper.step(stepper.prepare(stepper.rest_state()), 1.0))
    assert results[0].iterations == results[1].iterations
    assert np.array_equal(results[0].state.q, results[1].state.q)
    assert_allclose(results[0].residual, results[1].residual, rtol=0, atol=0)
