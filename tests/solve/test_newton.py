"""Newton: quadratic convergence, rescue by line search, round-off floor, rest, units, failures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from cases import (
    MODELS,
    SILICONE,
    UNEQUAL,
    cantilever,
    clamped,
    framed_rod,
    helix,
    isotropic_rod,
    massless,
    planar_rod,
    properties,
    ring,
    straight,
    weighted,
    with_term,
    y_network,
)
from numpy.testing import assert_allclose, assert_array_equal

from dismech_cli.arrays import FloatArray
from dismech_cli.forces.load import DeadLoad
from dismech_cli.kinematics.motion import Since, held_dofs, prescribe
from dismech_cli.kinematics.rod_frames import FrameState
from dismech_cli.laws.laws import Constant, Table
from dismech_cli.model.model import Model
from dismech_cli.sections.rods import RodProperties, rod_properties, round_section
from dismech_cli.solve.integrators import GeneralizedAlpha, ImplicitEuler, Integrator, Static, TrBdf2
from dismech_cli.solve.linear import pardiso
from dismech_cli.solve.linear.banded import BandedSolver
from dismech_cli.solve.linear.factors import Factors, LinearSolver
from dismech_cli.solve.linear.pardiso import PardisoFactors, pardiso_available
from dismech_cli.solve.newton import solve_stage
from dismech_cli.solve.pattern import SparsityPattern
from dismech_cli.solve.problem import NewtonSettings, StageProblem
from dismech_cli.solve.result import NewtonResult
from dismech_cli.solve.stage import Stage, at_state
from dismech_cli.solve.status import Status
from dismech_cli.solve.step import Stepper
from dismech_cli.solve.system import System
from dismech_cli.solve.tangents import TANGENTS


class RecordingSystem(System):
    """Notes every iterate at which the tangent is asked for."""

    def __init__(self, model: Model) -> None:
        super().__init__(model, ~held_dofs(model.motions, model.dofs.n, 0.0), "banded")
        self.iterates: list[FloatArray] = []

    def linearize(self, stage: Stage, q: FloatArray, stored: FrameState) -> tuple[FloatArray, FloatArray]:
        self.iterates.append(q.copy())
        return super().linearize(stage, q, stored)


def solve(
    model: Model, settings: NewtonSettings, make: Callable[[SparsityPattern], LinearSolver] = BandedSolver
) -> tuple[NewtonResult, RecordingSystem]:
    """One static load step from rest."""
    system = RecordingSystem(model)
    system.solver = make(system.pattern)
    stepper = Stepper(model, Static(), settings, "banded")
    state = stepper.rest_state()
    stage = Static().stage(0, state, state, 1.0)
    guess = stage.predictor.copy()
    prescribe(model.motions, guess, stage.t_end, Since(state.t, state.q, state.frames))
    return solve_stage(StageProblem(system, stage, state.frames, settings), guess), system


def loaded(kind: str, gravity: float) -> Model:
    return massless(weighted(cantilever(kind), (0.0, 0.0, -gravity), Constant(1.0)))


# Thick: EA l^2 / EI is of order one, so that the constant of quadratic convergence is, too.
THICK = properties(axial=50.0, bending=1.0, torsional=1.0, mass_per_length=1.0)


@pytest.mark.parametrize("kind", MODELS)
def test_quadratic_convergence(kind: str) -> None:
    """Near the solution the error is squared by every iteration."""
    model = massless(
        weighted(cantilever(kind, nodes=8, length=1.0, rod=THICK), (0.0, 0.0, -3.0), Constant(1.0))
    )
    result, system = solve(model, NewtonSettings(tolerance=1e-14))
    assert result.status is Status.CONVERGED
    errors = np.array([np.abs(q - result.q).max() for q in system.iterates])
    errors = errors[errors < 0.1]
    assert len(errors) >= 4
    # The constant is of order one; linear convergence would miss this bound by 1e5.
    assert (errors[1:] < 20.0 * errors[:-1] ** 2 + 1e-14).all(), errors


def _push(model: Model, degrees: FloatArray) -> Model:
    """A tip force of 1000 EI / L^2 whose direction follows the given angles from x, one per unit of time."""
    tip = model.dofs.of_nodes(np.array([20]))[0]
    for dof, part in ((tip[0], np.cos), (tip[-1], np.sin)):
        force = np.zeros(model.dofs.n)
        force[dof] = 1000.0 * SILICONE.bending_1 / 0.095**2
        times = tuple(float(t) for t in range(1, len(degrees) + 1))
        law = Table(times=times, values=tuple(part(np.deg2rad(degrees))))
        model = with_term(model, DeadLoad(f"push {dof}", force, law))
    return massless(model)


@pytest.mark.parametrize("kind", MODELS)
def test_line_search_rescues_a_hard_load(kind: str) -> None:
    """A huge force almost straight against the rod: full steps wander, the energy leads down.

    The answer is the one reached by turning the same force slowly, where full steps succeed.
    """
    result, _ = solve(_push(cantilever(kind), np.array([178.0])), NewtonSettings())
    assert result.status is Status.CONVERGED
    assert result.iterations > 20, "full steps sufficed: this tests nothing"
    stepper = Stepper(
        _push(cantilever(kind), np.linspace(90.0, 178.0, 9)), Static(), NewtonSettings(), "auto"
    )
    state = stepper.prepare(stepper.rest_state())
    for _ in range(9):
        step = stepper.step(state, 1.0)
        assert step.status is Status.CONVERGED
        assert step.iterations <= 20
        state = step.state
    assert_allclose(result.q, state.q, rtol=0, atol=1e-9)


def test_unstable_equilibrium_is_counted() -> None:
    """A column pushed along its axis stays straight; each of Euler's loads passed makes a mode unstable.

    With the joint count of 40 edges Euler's loads are met to 1 %; L is the free length and half
    an edge of the clamp.
    """
    nodes = 41
    model = massless(cantilever("planar", nodes=nodes))
    length = 0.1 * (1.0 - 1.0 / 40.0)
    for modes in (0, 1, 2):
        # Euler: P_k = (2k - 1)^2 pi^2 EI / (4 L^2); halfway between two of them
        load = (2 * modes) ** 2 * np.pi**2 / 4.0 * SILICONE.bending_1 / length**2
        load = max(load, 0.5 * np.pi**2 / 4.0 * SILICONE.bending_1 / length**2)
        force = np.zeros(model.dofs.n)
        force[-2] = -load
        stepper = Stepper(
            with_term(model, DeadLoad("push", force, Constant(1.0))), Static(), NewtonSettings(), "auto"
        )
        step = stepper.step(stepper.prepare(stepper.rest_state()), 1.0)
        assert step.status is Status.CONVERGED
        assert stepper.stability.negative_eigenvalues(step.state) == modes


@pytest.mark.skipif(not pardiso_available(), reason="no MKL")
def test_pattern_is_analysed_once_for_all_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """A probe of stability at every step keeps its symbolic factors until the model is bound anew."""
    analysed: list[SparsityPattern] = []

    class Recording(PardisoFactors):
        def __init__(self, kind: int, pattern: SparsityPattern) -> None:
            analysed.append(pattern)
            super().__init__(kind, pattern)

    monkeypatch.setattr(pardiso, "PardisoFactors", Recording)
    model = massless(clamped(cantilever("planar", nodes=400), (399,)))
    *held, end = model.motions
    model = replace(model, motions=(*held, replace(end, release=1.0)))
    stepper = Stepper(model, Static(), NewtonSettings(), "banded")
    state = stepper.prepare(stepper.rest_state())
    for _ in range(3):
        state = stepper.step(state, 0.1).state
        assert stepper.stability.negative_eigenvalues(state) == 0
    assert len(analysed) == 1
    state = stepper.prepare(replace(state, t=1.0))
    assert stepper.stability.negative_eigenvalues(state) == 0
    assert len(analysed) == 2


@pytest.mark.parametrize("kind", MODELS)
def test_round_off_floor_of_a_stiff_rod(kind: str) -> None:
    """EA / l = 1e9 N/m: positions carry 1e-8 N of round-off, above the tolerance; yet few iterations."""
    rod = RodProperties(
        axial=5e6,
        bending_1=1e-3,
        bending_2=1e-3,
        torsional=1e-3,
        mass_per_length=1e-3,
        polar_per_length=1e-9,
        area=1e-6,
        radius=1e-3,
    )
    model = weighted(cantilever(kind, rod=rod), (0.0, 0.0, -9.81), Constant(1.0))
    result, _ = solve(massless(model), NewtonSettings(tolerance=1e-12))
    assert result.status is Status.CONVERGED
    assert result.iterations <= 12
    stepper = Stepper(model, GeneralizedAlpha(), NewtonSettings(tolerance=1e-12), "auto")
    state = stepper.prepare(stepper.rest_state())
    for _ in range(20):
        step = stepper.step(state, 1e-3)
        assert step.status is Status.CONVERGED
        assert step.iterations <= 7  # six to the floor, one more from there
        state = step.state


SHAPES = {"straight": straight(9, 1.0), "helix": helix(8), "ring": ring(9), "network": y_network()}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("integrator", [ImplicitEuler(), GeneralizedAlpha(), Static()], ids=lambda i: i.name)
def test_rest_stays_at_rest(integrator: object, shape: str) -> None:
    """No load, curved natural shape: nothing moves over many steps.

    A residual below the round-off of positions, eps EA / l x = 1e-12 N, may stay; the softest modes
    have 0.1 N/m.
    """
    model = clamped(framed_rod(*SHAPES[shape], UNEQUAL), (0, 1), (0,))
    model = massless(model) if isinstance(integrator, Static) else model
    stepper = Stepper(model, integrator, NewtonSettings(), "auto")
    state = stepper.prepare(stepper.rest_state())
    for _ in range(100):
        step = stepper.step(state, 0.01)
        assert step.status is Status.CONVERGED
        state = step.state
    assert_allclose(state.q, model.rest, rtol=0, atol=1e-11)
    assert_allclose(state.v, 0.0, rtol=0, atol=1e-10)


def _in_units(length: float, mass: float) -> tuple[Model, float]:
    """The same cantilever and load with other units of length and mass; returns its unit of length."""
    rod = rod_properties(
        round_section(1e-3 * length),
        youngs_modulus=2e6 * mass / length,
        poisson_ratio=0.5,
        density=1200.0 * mass / length**3,
    )
    x, edges = straight(15, 0.1 * length)
    model = clamped(framed_rod(x, edges, rod), (0, 1), (0,))
    model = weighted(model, (0.0, 3.0 * length, -9.81 * length), Constant(1.0))
    force = np.zeros(model.dofs.n)
    force[-1] = 5e-6 * mass * length**2
    return with_term(model, DeadLoad("torque", force, Constant(1.0))), length


@pytest.mark.parametrize(
    ("length", "mass"), [(1e3, 1e3), (1e6, 1.0), (1e-3, 1e-3)], ids=["mm-g", "um-kg", "km-t"]
)
@pytest.mark.parametrize("integrator", [GeneralizedAlpha(), Static()], ids=lambda i: i.name)
def test_units_do_not_matter(integrator: object, length: float, mass: float) -> None:
    """Same dimensionless answer to 1e-9: no tolerance has a hidden unit."""
    answers = []
    for units in ((1.0, 1.0), (length, mass)):
        model, size = _in_units(*units)
        model = massless(model) if isinstance(integrator, Static) else model
        stepper = Stepper(model, integrator, NewtonSettings(tolerance=1e-11), "auto")
        state = stepper.prepare(stepper.rest_state())
        for _ in range(5):
            step = stepper.step(state, 0.01)
            assert step.status is Status.CONVERGED
            state = step.state
        split = model.dofs.n_positions
        answers.append(np.concatenate((state.q[:split] / size, state.q[split:])))
    assert np.abs(answers[0] - _in_units(1.0, 1.0)[0].rest).max() > 1e-2
    assert_allclose(answers[1], answers[0], rtol=0, atol=1e-9)


# ---------------------------------------------------------------- failing is a result


def test_free_static_rod_is_refused() -> None:
    """Nothing holds it: no equilibrium, said so, and the old state comes back."""
    model = massless(weighted(isotropic_rod(*straight(6), SILICONE), (0.0, 0.0, -9.81), Constant(1.0)))
    stepper = Stepper(model, Static(), NewtonSettings(), "auto")
    start = stepper.prepare(stepper.rest_state())
    result = stepper.step(start, 0.1)
    assert result.status is Status.FACTORIZATION_FAILED
    assert result.state is start
    assert 0 <= result.worst < model.dofs.n
    assert "clamp" in result.status.advice


@pytest.mark.parametrize("kind", MODELS)
def test_nan_in_a_load_is_named(kind: str) -> None:
    model = cantilever(kind)
    force = np.zeros(model.dofs.n)
    bad = model.dofs.of_nodes(np.array([7]))[0, -1]
    force[bad] = np.nan
    stepper = Stepper(
        with_term(model, DeadLoad("bad", force, Constant(1.0))), ImplicitEuler(), NewtonSettings(), "auto"
    )
    start = stepper.prepare(stepper.rest_state())
    kept = start.q.copy()
    result = stepper.step(start, 0.01)
    assert result.status is Status.NOT_FINITE
    assert result.worst == bad
    assert model.dofs.describe(result.worst) == "z of node 7"
    assert result.state is start
    assert_array_equal(start.q, kept)


class CountingSolver(BandedSolver):
    """Counts the matrices it is given."""

    def __init__(self, pattern: SparsityPattern) -> None:
        super().__init__(pattern)
        self.factorisations = 0

    def factorize(self, values: FloatArray) -> Factors:
        self.factorisations += 1
        return super().factorize(values)


@pytest.mark.parametrize(("degrees", "projection"), [(90.0, "none"), (178.0, "none"), (178.0, "indefinite")])
def test_iterations_are_one_budget(degrees: float, projection: str) -> None:
    """Full steps, line search and projections draw from it; it ends their way and does not bend it."""
    model = _push(cantilever("planar"), np.array([degrees]))
    settings = NewtonSettings(factorize=TANGENTS[projection])
    whole, system = solve(model, settings, CountingSolver)
    needed = whole.iterations
    assert whole.status is Status.CONVERGED
    assert needed == system.solver.factorisations
    for allowed in (1, 5, 20, needed - 1, needed, needed + 1):
        result, system = solve(model, replace(settings, max_iterations=allowed), CountingSolver)
        assert result.iterations == system.solver.factorisations == min(allowed, needed)
        assert result.status is (Status.CONVERGED if allowed >= needed else Status.MAX_ITERATIONS)
        if allowed >= needed:
            assert_array_equal(result.q, whole.q)


@pytest.mark.parametrize("allowed", [1, 2, 10, 25])
def test_shifts_draw_from_the_budget(allowed: int) -> None:
    """Nothing holds this rod: the full step finds it singular, then the diagonal is raised."""
    model = massless(weighted(isotropic_rod(*straight(6), SILICONE), (0.0, 0.0, -9.81), Constant(1.0)))
    result, system = solve(model, NewtonSettings(max_iterations=allowed), CountingSolver)
    assert result.iterations == system.solver.factorisations == allowed
    assert result.status is Status.FACTORIZATION_FAILED


def test_reactions_balance_the_weight() -> None:
    """The residual on held DOFs is the reaction: their sum carries the free nodes' weight."""
    model = weighted(cantilever("framed"), (0.0, 0.0, -9.81), Constant(1.0))
    result, _ = solve(massless(model), NewtonSettings(tolerance=1e-12))
    held = model.motions[0].dofs[:6]
    reaction = result.residual[held].reshape(2, 3).sum(axis=0)
    # Held nodes carry their own weight in the residual, too.
    weight = 9.81 * model.mass[: model.dofs.n_positions : 3].sum()
    assert_allclose(reaction, [0.0, 0.0, weight], rtol=0, atol=1e-10 * weight)


@pytest.mark.parametrize("integrator", [ImplicitEuler(), TrBdf2(), Static()])
def test_what_terms_do_to_held_dofs_at_the_end_of_a_step(integrator: Integrator) -> None:
    model = weighted(cantilever("framed"), (0.0, 0.0, -9.81), Constant(1.0))
    model = massless(model) if isinstance(integrator, Static) else model
    stepper = Stepper(model, integrator, NewtonSettings(tolerance=1e-12), "auto")
    step = stepper.step(stepper.prepare(stepper.rest_state()), 0.02)
    end = at_state(step.state)
    forces = stepper.system.residual(end, step.state.q, step.state.frames)[stepper.held]
    assert_allclose(step.reactions, forces, rtol=0, atol=1e-9 * np.abs(forces).max())


def test_they_are_not_known_where_steps_end_out_of_balance() -> None:
    model = weighted(cantilever("framed"), (0.0, 0.0, -9.81), Constant(1.0))
    stepper = Stepper(model, GeneralizedAlpha(), NewtonSettings(), "auto")
    assert stepper.step(stepper.prepare(stepper.rest_state()), 0.02).reactions is None


def test_released_motion_frees_its_dofs() -> None:
    """After the release the pattern has them, and the rod falls with its consistent acceleration."""
    model = weighted(planar_rod(*straight(4), SILICONE), (0.0, 0.0, -9.81), Constant(1.0))
    model = clamped(model, (0, 1, 2, 3))
    motion = replace(model.motions[0], release=0.05)
    stepper = Stepper(replace(model, motions=(motion,)), GeneralizedAlpha(), NewtonSettings(), "auto")
    state = stepper.prepare(stepper.rest_state())
    for _ in range(5):
        step = stepper.step(state, 0.01)
        assert step.status is Status.CONVERGED
        state = stepper.prepare(step.state)
    assert_array_equal(state.q, model.rest)
    state = stepper.prepare(replace(state, t=0.05))
    for _ in range(10):
        state = stepper.step(state, 0.01).state
    fall = model.dofs.positions(state.q - model.rest)[:, 1]
    assert_allclose(fall, -0.5 * 9.81 * 0.1**2, rtol=1e-10)
    assert stepper.analyses == 2
