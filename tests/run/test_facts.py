"""What terms say of themselves, and what the account makes of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cases import NUMPY, adapted, cantilever, configuration, disturbed, energy_of, term_cases, weighted
from derivatives import Probe
from numpy.testing import assert_array_equal

from dismech_cli.arrays import FloatArray
from dismech_cli.laws.laws import Constant, Expression, Ramp
from dismech_cli.laws.signal import Signal
from dismech_cli.model.driven import Drive, DrivenEnergy
from dismech_cli.model.elastic import Elastic
from dismech_cli.model.model import Model
from dismech_cli.model.stencil import StencilEnergy
from dismech_cli.run.account import EnergyAccount
from dismech_cli.run.roles import Roles
from dismech_cli.solve.integrators import GeneralizedAlpha
from dismech_cli.solve.problem import NewtonSettings
from dismech_cli.solve.step import Stepper

RAMP = Ramp(before=0.0, after=1.0, start=0.0, end=1e-2)
ELASTIC = {name: case for name, case in term_cases().items() if isinstance(case.term, StencilEnergy)}


def driven(energy: StencilEnergy, signal: Signal) -> DrivenEnergy:
    count = len(energy.dofs)
    return DrivenEnergy(energy, (Drive(0, np.arange(count), signal, np.zeros(count), np.full(count, 0.01)),))


def residual(term: Elastic, model: Model, q: FloatArray) -> FloatArray:
    c = configuration(model, q, np.zeros_like(q), adapted(model, q))
    return Probe.of(term, model, NUMPY).residual(c)


@pytest.mark.parametrize("drive", [False, True], ids=["plain", "driven"])
@pytest.mark.parametrize("name", ELASTIC)
def test_what_touches_some_dofs_is_all_of_the_residual_there(name: str, drive: bool) -> None:
    case = ELASTIC[name]
    assert isinstance(case.term, StencilEnergy)
    can_be_driven = bool(case.term.kernel.naturals)
    term = driven(case.term, Constant(0.5)) if drive and can_be_driven else case.term
    q, mask = disturbed(case.model, 1), np.zeros(case.model.dofs.n, dtype=bool)
    mask[case.term.dofs[-1]] = True
    near = term.touching(mask)
    assert near is not None
    assert_array_equal(residual(near, case.model, q)[mask], residual(term, case.model, q)[mask])
    assert term.touching(np.zeros_like(mask)) is None


@pytest.mark.parametrize(
    ("signal", "steady"), [(Constant(2.0), True), (Expression("3*s"), True), (RAMP, False)]
)
def test_a_term_is_steady_where_its_signals_are(signal: Signal, steady: bool) -> None:
    model = weighted(cantilever("planar"), (0.0, 0.0, -9.81), signal)
    bend = driven(energy_of(model, "bend"), signal)
    bound = stepper_of(replace(model, terms=(bend, *model.terms[-1:]))).system.energies
    assert {term.name: term.steady for term in bound} == {"bend": steady, "gravity": steady}


def stepper_of(model: Model) -> Stepper:
    stepper = Stepper(model, GeneralizedAlpha(), NewtonSettings(), "auto")
    stepper.prepare(stepper.rest_state())
    return stepper


@pytest.mark.parametrize("ramped", ["bend", "gravity"])
def test_only_what_changes_in_time_works_in_time(ramped: str) -> None:
    """Its work makes the books balance as well as they do under constant signals, and nothing else works."""
    books = {}
    for signal in (Constant(0.3), RAMP):
        base = cantilever("planar")
        model = weighted(base, (0.0, 0.0, -9.81), signal if ramped == "gravity" else Constant(1.0))
        bend = driven(energy_of(model, "bend"), signal if ramped == "bend" else Constant(0.3))
        model = replace(model, terms=tuple(bend if t.name == "bend" else t for t in model.terms))
        stretch = energy_of(model, "stretch")
        stepper = stepper_of(model)
        roles = Roles(elastic=(stretch, bend), gravitational=("gravity",), loads=(), dissipative=())
        account = EnergyAccount(model, roles, stepper.rest_state())
        state = stepper.prepare(stepper.rest_state())
        account.bind(stepper.system, 0.0)
        account.start(state)
        for _ in range(20):
            result = stepper.step(stepper.prepare(state), 5e-4)
            account.advance(state, result)
            state = result.state
        books[signal] = dict(account.sums), account.measure(state)
    (steady, _), (moving, entries) = books.values()
    assert steady["actuation_work"] == steady["external_work"] == 0.0
    done = {"bend": "actuation_work", "gravity": "external_work"}[ramped]
    other = {"bend": "external_work", "gravity": "actuation_work"}[ramped]
    assert moving[other] == 0.0
    assert abs(moving[done]) > 20.0 * abs(entries["error"])
