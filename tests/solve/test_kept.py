"""Factors kept within a step, guesses that learn from the last: the same motion for less."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cases import SILICONE, clamped, framed_rod, isotropic_rod, straight, weighted
from derivatives import dense
from linear_systems import system
from numpy.testing import assert_allclose, assert_array_equal
from shell_cases import shell

from dismech_cli.arrays import FloatArray
from dismech_cli.laws.laws import Constant
from dismech_cli.mesh.generate.sheets import sheet
from dismech_cli.model.model import Model
from dismech_cli.model.state import State
from dismech_cli.solve import kept, problem
from dismech_cli.solve.integrators import GeneralizedAlpha, ImplicitEuler, Integrator, TrBdf2
from dismech_cli.solve.linear import pardiso
from dismech_cli.solve.linear.choice import LINEAR_SOLVERS
from dismech_cli.solve.linear.iterations import conjugate_gradients, conjugate_residuals
from dismech_cli.solve.linear.pardiso import PardisoSolver, pardiso_available
from dismech_cli.solve.linear.superlu import SuperLuSolver
from dismech_cli.solve.problem import NewtonSettings
from dismech_cli.solve.status import Status
from dismech_cli.solve.step import Stepper
from dismech_cli.solve.step_result import StepResult

WEIGHT = (0.0, 0.0, -9.81)
RNG = np.random.default_rng(5)
TIGHT = NewtonSettings(tolerance=1e-12)
LARGE = ["superlu", *(["pardiso"] if pardiso_available() else [])]


def near(m: int, change: float) -> tuple[FloatArray, FloatArray]:
    """A symmetric positive definite matrix, and another that differs by a share of it."""
    half = RNG.normal(size=(m, m))
    matrix = half @ half.T + m * np.eye(m)
    root = np.linalg.cholesky(matrix)
    other = RNG.normal(size=(m, m))
    other = 0.5 * (other + other.T)
    return matrix, matrix + change * root @ (other / np.linalg.norm(other, 2)) @ root.T


@pytest.mark.parametrize("iterate", [conjugate_gradients, conjugate_residuals])
def test_a_matrix_near_the_factorised_one_is_solved(iterate) -> None:  # type: ignore[no-untyped-def]
    """Conjugate gradients gain a factor of 2 ((1 - r) / (1 + r))^k or better, in their own norm."""
    factorised, matrix = near(40, 0.1)
    rhs = RNG.normal(size=40)
    x = iterate(lambda b: np.linalg.solve(factorised, b), lambda y: matrix @ y, rhs, 1e-3, 5)
    assert x is not None
    left = rhs - matrix @ x
    assert left @ np.linalg.solve(factorised, left) <= (1e-2) ** 2 * (rhs @ np.linalg.solve(factorised, rhs))
    assert iterate(lambda b: np.linalg.solve(factorised, b), lambda y: matrix @ y, rhs, 1e-9, 3) is None


def test_a_matrix_that_turns_indefinite_is_left_to_factors_of_its_own() -> None:
    factorised, _ = near(20, 0.0)
    direction = RNG.normal(size=20)
    softer = factorised - 1.2 * np.outer(factorised @ direction, factorised @ direction) / (
        direction @ factorised @ direction
    )
    rhs = softer @ direction
    assert (
        conjugate_gradients(lambda b: np.linalg.solve(factorised, b), lambda y: softer @ y, rhs, 1e-3, 20)
        is None
    )


def falling_sheet() -> Model:
    """A square held along one side, under its weight."""
    mesh = sheet(1.0, 1.0, 5)
    x = mesh.nodes[:, 0]
    model = weighted(shell(mesh, "hinge").model, WEIGHT, Constant(1.0))
    return clamped(model, tuple(np.flatnonzero(x < x.min() + 1e-9).tolist()))


def moved(
    stepper: Stepper, steps: int, start: State | None = None, dt: float = 5e-3
) -> tuple[State, list[StepResult]]:
    state = stepper.prepare(stepper.rest_state() if start is None else start)
    results = []
    for _ in range(steps):
        results.append(stepper.step(state, dt))
        assert results[-1].status is Status.CONVERGED
        state = results[-1].state
    return state, results


@pytest.mark.parametrize("solver", LARGE)
@pytest.mark.parametrize("integrator", [GeneralizedAlpha(), TrBdf2()], ids=lambda i: i.name)
def test_the_same_motion_with_one_factorisation_a_step(
    integrator: Integrator, solver: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = falling_sheet()
    known, _ = moved(Stepper(model, integrator, TIGHT, solver), 8, dt=0.03)
    anew, _ = moved(Stepper(model, integrator, NewtonSettings(), solver), 8, dt=0.03)
    monkeypatch.setattr(kept, "_CHEAP", 0.0)
    monkeypatch.setattr(kept, "int", lambda price: 12, raising=False)
    made, kind = [0], LINEAR_SOLVERS[solver]
    original = kind.factorize  # type: ignore[attr-defined]

    def counted(self, values):  # type: ignore[no-untyped-def]
        made[0] += 1
        return original(self, values)

    monkeypatch.setattr(kind, "factorize", counted)
    state, results = moved(Stepper(model, integrator, NewtonSettings(), solver), 8, dt=0.03)
    assert sum(r.iterations for r in results) >= 12
    assert made[0] == 8
    size = np.abs(known.q - model.rest).max()
    error, before = np.abs(state.q - known.q).max(), np.abs(anew.q - known.q).max()
    assert error <= 2.0 * before + 1e-9 * size
    # a step knows nothing of those before it
    half, _ = moved(Stepper(model, integrator, NewtonSettings(), solver), 4, dt=0.03)
    end, _ = moved(Stepper(model, integrator, NewtonSettings(), solver), 4, half, 0.03)
    assert_array_equal(end.q, state.q)


needs_pardiso = pytest.mark.skipif(not pardiso_available(), reason="MKL is not installed")


@needs_pardiso
def test_rough_factors_are_right_to_single_precision(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pardiso, "_SMALL", 0)
    pattern, values = system("positive", framed_rod(*straight(20), SILICONE))
    solver = PardisoSolver(pattern)
    # least numbers of single precision are larger
    rhs = 1e-60 * RNG.normal(size=pattern.m)
    rough = solver.nearly(values, 0.0)
    assert rough is not None
    matrix = dense(pattern, values)
    error = np.linalg.norm(matrix @ rough.solve(rhs) - rhs) / np.linalg.norm(rhs)
    assert 1e-12 < error < 1e-6 * np.linalg.cond(matrix)
    assert solver.nearly(values, 1e9) is None
    assert solver.nearly(-values, 0.0) is None
    for kind in ("indefinite", "unsymmetric"):
        pattern, values = system(kind, framed_rod(*straight(20), SILICONE))
        assert PardisoSolver(pattern).nearly(values, 0.0) is None


@needs_pardiso
def test_the_same_motion_on_rough_factors(monkeypatch: pytest.MonkeyPatch) -> None:
    """One a step where inertia counts; where all is stiff beside it, and in what is small, none."""
    model = falling_sheet()
    known, _ = moved(Stepper(model, TrBdf2(), TIGHT, "pardiso"), 8, dt=0.03)
    anew, _ = moved(Stepper(model, TrBdf2(), NewtonSettings(), "pardiso"), 8, dt=0.03)
    monkeypatch.setattr(pardiso, "_SMALL", 0)
    monkeypatch.setattr(kept, "_CHEAP", 0.0)
    monkeypatch.setattr(kept, "int", lambda price: 12, raising=False)
    made = {PardisoSolver.factorize: 0, PardisoSolver.nearly: 0}

    def counted(original):  # type: ignore[no-untyped-def]
        def call(*arguments):  # type: ignore[no-untyped-def]
            made[original] += 1
            return original(*arguments)

        return call

    exact, nearly = made
    monkeypatch.setattr(PardisoSolver, "factorize", counted(exact))
    monkeypatch.setattr(PardisoSolver, "nearly", counted(nearly))
    stepper = Stepper(model, TrBdf2(), NewtonSettings(), "pardiso")
    first = stepper.prepare(stepper.rest_state())
    made[exact] = 0  # the start has its accelerations by exact factors
    state, results = moved(stepper, 8, first, dt=0.03)
    assert sum(r.iterations for r in results) >= 12
    assert made[nearly] == 8
    assert made[exact] <= 1
    size = np.abs(known.q - model.rest).max()
    error, before = np.abs(state.q - known.q).max(), np.abs(anew.q - known.q).max()
    assert error <= 2.0 * before + 1e-9 * size
    half, _ = moved(Stepper(model, TrBdf2(), NewtonSettings(), "pardiso"), 4, dt=0.03)
    end, _ = moved(Stepper(model, TrBdf2(), NewtonSettings(), "pardiso"), 4, half, 0.03)
    assert_array_equal(end.q, state.q)
    monkeypatch.setattr(problem, "_STIFF", 0.1)
    made[nearly] = 0
    moved(Stepper(model, TrBdf2(), NewtonSettings(), "pardiso"), 2, dt=0.03)
    assert made[nearly] == 0


def test_cheap_factors_are_made_anew() -> None:
    """No small scene, and no band, iterates."""
    model = falling_sheet()
    stepper = Stepper(model, TrBdf2(), NewtonSettings(), "superlu")
    start = stepper.prepare(stepper.rest_state())
    stage = stepper.integrator.stage(0, start, start, 5e-3)
    values = stepper.system.linearize(stage, stage.predictor, start.frames).values
    factors = SuperLuSolver(stepper.system.pattern).factorize(values)
    assert 0.0 < factors.price < kept._CHEAP
    holder = kept.Kept()
    holder.keep(stepper.system.solver, factors)
    assert holder.factors is None


def falling_rod() -> Model:
    return weighted(isotropic_rod(*straight(11), SILICONE), WEIGHT, Constant(1.0))


def test_a_guess_learns_that_the_acceleration_lasts() -> None:
    """In free fall the guess is the answer from the third step on: one solve each, as one is always made."""
    stepper = Stepper(falling_rod(), ImplicitEuler(), NewtonSettings(), "auto")
    state, results = moved(stepper, 6)
    assert state.memory["lead.share"][0] == pytest.approx(1.0, abs=1e-9)
    stage = stepper.integrator.stage(0, state, state, 5e-3)
    assert stage.lead is not None
    end = stepper.step(state, 5e-3).state
    assert_allclose(end.q, stage.predictor + stage.lead, rtol=0, atol=1e-9 * np.abs(stage.lead).max())
    assert [r.iterations for r in results[2:]] == [1] * 4


def test_a_guess_learns_that_it_does_not() -> None:
    """An acceleration that turns round: nothing of it is to go on by."""
    stepper = Stepper(falling_rod(), ImplicitEuler(), NewtonSettings(), "auto")
    state, _ = moved(stepper, 3)
    thrown = replace(state, a=-state.a)
    assert stepper.step(thrown, 5e-3).state.memory["lead.share"][0] == 0.0
