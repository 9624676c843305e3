"""Terms whose stencils come and go: equal to terms that were there from the start, free where absent."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from cases import (
    UNEQUAL,
    cantilever,
    clamped,
    configuration,
    framed_rod,
    helix,
    massless,
    properties,
    term_cases,
    weighted,
)
from derivatives import assert_derivatives
from numpy.testing import assert_allclose, assert_array_equal
from shell_cases import shell
from springs_on_touch import AlwaysThere, ComingAndGoing, Springs

from dismech_cli.arrays import FloatArray
from dismech_cli.forces.resistive import resistive_force
from dismech_cli.kernels.linearization import Coupling, all_symmetric
from dismech_cli.laws.laws import Constant
from dismech_cli.mesh.generate.sheets import sheet
from dismech_cli.model.configuration import Configuration
from dismech_cli.model.model import Model
from dismech_cli.solve.integrators import GeneralizedAlpha, ImplicitEuler, Static
from dismech_cli.solve.linear.pardiso import pardiso_available
from dismech_cli.solve.pattern import SparsityPattern
from dismech_cli.solve.problem import NewtonSettings
from dismech_cli.solve.status import Status
from dismech_cli.solve.step import Stepper
from dismech_cli.solve.system import System

# Thick, so that the matrices are well conditioned and rounding stays rounding.
THICK = properties(axial=50.0, bending=1.0, torsional=1.0, mass_per_length=1.0)
TIGHT = NewtonSettings(tolerance=1e-12)


def curling_rod(kind: str) -> tuple[Model, FloatArray]:
    """A rod of 15 edges thrown so that it curls up; third neighbours touch as soon as it bends."""
    model = cantilever(kind, nodes=16, length=1.5, rod=THICK)
    velocity = np.zeros(model.dofs.n)
    model.dofs.positions(velocity)[2:, -1] = np.linspace(0.0, 3.0, 14)
    return model, velocity


def dragged_rod(kind: str) -> tuple[Model, FloatArray]:
    """The same in a fluid, whose drag makes the pattern unsymmetric."""
    model, velocity = curling_rod(kind)
    edges = np.column_stack((np.arange(15), np.arange(1, 16)))
    drag = resistive_force("drag", model.dofs, edges, np.full(15, 0.1), tangential=0.3, normal=1.1)
    return replace(model, terms=(*model.terms, drag)), velocity


def folding_sheet(kind: str) -> tuple[Model, FloatArray]:
    """A square held along one side and thrown so that the other comes over."""
    mesh = sheet(1.0, 1.0, 4)
    model = shell(mesh, kind).model
    x = mesh.nodes[:, 0]
    model = clamped(model, tuple(np.flatnonzero(x < x.min() + 1e-9).tolist()))
    velocity = np.zeros(model.dofs.n)
    model.dofs.positions(velocity)[:, 2] = 4.0 * (x - x.min()) ** 2
    return model, velocity


SCENES: dict[str, tuple[Callable[[str], tuple[Model, FloatArray]], str, int, float, float]] = {
    "planar rod": (curling_rod, "planar", 2, 0.304, 0.02),
    "framed rod": (curling_rod, "framed", 2, 0.304, 0.02),
    "rod in a fluid": (dragged_rod, "isotropic", 2, 0.304, 0.02),
    "hinges": (folding_sheet, "hinge", 0, 0.2, 0.01),
    "mid-edge normals": (folding_sheet, "midedge", 0, 0.2, 0.01),
}


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("integrator", [ImplicitEuler(), GeneralizedAlpha()], ids=lambda i: i.name)
def test_equal_to_springs_that_were_there_from_the_start(integrator: object, scene: str) -> None:
    make, kind, apart, reach, dt = SCENES[scene]
    model, velocity = make(kind)
    springs = Springs.among(model.dofs, apart, reach, 300.0)
    coming = Stepper(replace(model, changing=(springs,)), integrator, TIGHT, "superlu")
    always = Stepper(replace(model, terms=(*model.terms, AlwaysThere(springs))), integrator, TIGHT, "superlu")
    never = Stepper(model, integrator, TIGHT, "superlu")
    states = [stepper.prepare(stepper.rest_state(velocity)) for stepper in (coming, always, never)]
    for _ in range(20):
        results = [s.step(state, dt) for s, state in zip((coming, always, never), states, strict=True)]
        assert [r.status for r in results] == [Status.CONVERGED] * 3
        assert results[0].iterations == results[1].iterations
        # nothing remembered where nothing comes and goes: the same guesses for all
        states = [results[0].state, *[replace(r.state, memory={}) for r in results[1:]]]
    term = coming.system.terms[-1]
    assert isinstance(term, ComingAndGoing)
    assert term.changes > 3
    size = np.abs(states[0].q).max()
    assert np.abs(states[2].q - states[0].q).max() > 1e-3 * size
    assert_allclose(states[0].q, states[1].q, rtol=0, atol=1e-12 * size)


def test_without_such_terms_nothing_is_extended() -> None:
    """The same pattern object all along, the solver of the band, one analysis."""
    model, velocity = curling_rod("framed")
    stepper = Stepper(model, ImplicitEuler(), TIGHT, "auto")
    pattern, solver = stepper.system.pattern, stepper.system.solver
    state = stepper.prepare(stepper.rest_state(velocity))
    for _ in range(5):
        state = stepper.step(state, 0.02).state
    assert stepper.system.pattern is pattern
    assert stepper.system.solver is solver
    assert solver.name == "banded"
    assert stepper.analyses == 1


def test_within_a_step_places_stay_and_the_next_step_lets_them_go() -> None:
    """The matrix is analysed where a coupling is new, and where a step begins with others than the last."""
    model, _ = curling_rod("planar")
    springs = Springs.among(model.dofs, 2, 0.25, 30.0)
    system = System(replace(model, changing=(springs,)), np.ones(model.dofs.n, dtype=bool), "superlu")
    state = Stepper(model, Static(), TIGHT, "superlu").rest_state()
    stage = Static().stage(0, state, state, 1.0)
    bent, straight = state.q.copy(), state.q
    model.dofs.positions(bent)[-1] = model.dofs.positions(bent)[5] + 0.1
    sizes, analyses = [], []
    for q in (straight, bent, straight, bent):
        system.linearize(stage, q, state.frames)
        sizes.append(system.pattern.nnz)
        analyses.append(system.analyses)
    assert sizes[0] < sizes[1] == sizes[2] == sizes[3]
    assert analyses == [1, 2, 2, 2]
    grown = system.pattern
    system.recall(state)
    system.linearize(stage, bent, state.frames)
    assert system.pattern is grown
    system.recall(state)
    system.linearize(stage, straight, state.frames)
    assert system.pattern.nnz == sizes[0]
    assert system.analyses == 3


@pytest.mark.parametrize("solver", ["auto", "superlu"])
@pytest.mark.parametrize("scene", SCENES)
def test_a_step_depends_on_its_start_alone(scene: str, solver: str) -> None:
    """A stepper made anew takes each step to the same bits: so does a resumed run."""
    make, kind, apart, reach, dt = SCENES[scene]
    model, velocity = make(kind)
    model = replace(model, changing=(Springs.among(model.dofs, apart, reach, 300.0),))
    stepper = Stepper(model, GeneralizedAlpha(), TIGHT, solver)
    state = stepper.step(stepper.prepare(stepper.rest_state(velocity)), dt).state
    for _ in range(15):
        fresh = Stepper(model, GeneralizedAlpha(), TIGHT, solver)
        again = fresh.step(fresh.prepare(state), dt).state
        state = stepper.step(stepper.prepare(state), dt).state
        assert_array_equal(again.q, state.q)
        assert_array_equal(again.v, state.v)


@pytest.mark.parametrize("spreads", [True, False])
def test_solver_is_chosen_before_anything_touches(spreads: bool) -> None:
    class Ground(Springs):
        pass

    Ground.spreads = spreads
    model, _ = curling_rod("framed")
    ground = Ground.among(model.dofs, 2, 0.29, 1.0)
    system = System(replace(model, changing=(ground,)), np.ones(model.dofs.n, dtype=bool))
    sparse = "pardiso" if pardiso_available() else "superlu"
    assert system.solver.name == (sparse if spreads else "banded")


@pytest.mark.parametrize("load", [0.3, 40.0], ids=["full steps", "line search"])
def test_newton_goes_no_farther_than_the_terms_allow(load: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Half steps arrive later at the same place; each is asked for with both of its ends."""
    model, _ = curling_rod("planar")
    model = massless(weighted(model, (0.0, 0.0, -load), Constant(1.0)))
    asked: list[tuple[FloatArray, FloatArray]] = []
    part = 1.0

    def longest_step(self: ComingAndGoing, start: Configuration, end: Configuration) -> float:
        asked.append((start.q.copy(), end.q.copy()))
        return part

    monkeypatch.setattr(ComingAndGoing, "longest_step", longest_step)
    springs = Springs.among(model.dofs, 2, 0.2, 1.0)
    ends = []
    for part in (1.0, 0.5):
        asked.clear()
        stepper = Stepper(replace(model, changing=(springs,)), Static(), TIGHT, "superlu")
        result = stepper.step(stepper.prepare(stepper.rest_state()), 1.0)
        assert result.status is Status.CONVERGED
        # while full steps go on, each starts on the way that the last one was asked for
        for (start, end), (after, _) in pairwise(asked[:20]):
            assert_allclose(after, start + part * (end - start), rtol=0, atol=1e-14)
        ends.append((result.iterations, result.state.q))
    assert ends[1][0] > ends[0][0]
    assert_allclose(ends[1][1], ends[0][1], rtol=0, atol=1e-9)


@pytest.mark.parametrize("symmetric", [True, False])
def test_extension_holds_the_base_and_the_new(symmetric: bool) -> None:
    """Entries are those of both, in the order of the base; base slots find the base's entries."""
    model = framed_rod(*helix(9), UNEQUAL)
    free = np.ones(model.dofs.n, dtype=bool)
    free[[0, 4, 30]] = False
    couplings = [c for t in model.terms for c in t.couplings]
    base = SparsityPattern.build(model.dofs, free, couplings, symmetric=symmetric)
    # far nodes, a node with a fixed DOF, and a node with an angle far away
    clique = np.concatenate(
        (model.dofs.of_nodes(np.array([0, 8])).ravel(), model.dofs.of_angles(np.array([3])))
    )
    extra = Coupling(clique[None])
    extension = base.extended(base.entries([extra]))
    larger = extension.pattern
    assert_array_equal(larger.free, base.free)
    wanted = base.csr(np.ones(base.slots)).toarray() > 0.0
    local = base.order[clique]
    for a in local[local >= 0]:
        for b in local[local >= 0]:
            if not symmetric or a <= b:
                wanted[a, b] = True
    assert_array_equal(larger.csr(np.ones(larger.slots)).toarray() > 0.0, wanted)
    assert larger.nnz > base.nnz
    values = np.arange(1.0, base.slots + 1.0)
    spread = np.zeros(larger.slots)
    spread[extension.base_slots] = values
    moved = larger.csr(spread).toarray()
    assert_array_equal(moved, np.where(moved > 0.0, base.csr(values).toarray(), 0.0))
    assert spread[-1] == values[-1]
    assert_array_equal(larger.indices[larger.diagonal], np.arange(larger.m))
    assert larger.holds(base.entries([extra]))
    assert not base.holds(base.entries([extra]))
    lower, upper = extension.mirror()
    assert len(lower) == (0 if symmetric else len(local[local >= 0]) * (len(local[local >= 0]) - 1) // 2)
    assert_array_equal(larger.rows[lower], larger.indices[upper])
    assert_array_equal(larger.indices[lower], larger.rows[upper])


def test_nothing_to_add_changes_nothing() -> None:
    model = framed_rod(*helix(9), UNEQUAL)
    couplings = [c for t in model.terms for c in t.couplings]
    base = SparsityPattern.build(
        model.dofs, np.ones(model.dofs.n, dtype=bool), couplings, symmetric=all_symmetric(couplings)
    )
    extension = base.extended(base.entries([]))
    assert_array_equal(extension.pattern.keys, base.keys)
    assert_array_equal(extension.base_slots, np.arange(base.slots))


def test_the_springs_have_the_derivatives_they_say() -> None:
    model = next(iter(term_cases().values())).model
    springs = Springs.among(model.dofs, 0, 1.5, 2.0)
    rng = np.random.default_rng(0)
    q = model.rest + 0.05 * rng.normal(size=model.dofs.n)
    stored = model.frames.rest(model.rest)
    assert_derivatives(
        AlwaysThere(springs),
        lambda x, v: configuration(model, x, v, stored),
        q,
        np.zeros_like(q),
        model,
        driver=model.driver,
        scale=np.full(len(q), 0.01),
    )
