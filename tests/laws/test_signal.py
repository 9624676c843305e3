"""What loads and natural strains follow: laws of time, which ignore inputs, or inputs themselves."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
from cases import cantilever, energy_of, weighted, with_term
from numpy.testing import assert_array_equal

from dismech_cli.arrays import FloatArray
from dismech_cli.forces.load import DeadLoad
from dismech_cli.kinematics.dofs import DofMap
from dismech_cli.laws.laws import Constant, Expression, Ramp
from dismech_cli.laws.signal import NO_INPUTS, Signal, Value
from dismech_cli.model.driven import Drive, DrivenEnergy
from dismech_cli.model.model import Model
from dismech_cli.model.state import State
from dismech_cli.solve.integrators import GeneralizedAlpha, Integrator, TrBdf2
from dismech_cli.solve.problem import NewtonSettings
from dismech_cli.solve.status import Status
from dismech_cli.solve.step import Stepper

DT = 1e-3


@dataclass(frozen=True, slots=True)
class Channel:
    """One input of the system, the same at all places."""

    index: int
    constant: ClassVar[bool] = False

    def value(self, t: float, inputs: FloatArray, places: Value = 0.0) -> Value:
        x = float(inputs[self.index])
        return np.full(places.shape, x) if isinstance(places, np.ndarray) else x


def pushed(dofs: DofMap) -> FloatArray:
    force = np.zeros(dofs.n)
    force[dofs.n_positions - 1] = 1e-3
    return force


def actuated(signal: Signal, load: Signal) -> Model:
    """A framed cantilever under gravity, its first curvature driven and its end pushed."""
    model = weighted(cantilever("framed", nodes=9), (0.0, 0.0, -9.81), Constant(1.0))
    bend = energy_of(model, "bend_twist")
    count = len(bend.dofs)
    drive = Drive(0, np.arange(count), signal, np.linspace(0.0, 1.0, count), np.full(count, 0.01))
    terms = tuple(DrivenEnergy(bend, (drive,)) if term is bend else term for term in model.terms)
    return with_term(replace(model, terms=terms), DeadLoad("push", pushed(model.dofs), load))


def steps(model: Model, integrator: Integrator, inputs: list[FloatArray]) -> State:
    """One step under each of the inputs."""
    stepper = Stepper(model, integrator, NewtonSettings(), "auto")
    state = replace(stepper.rest_state(), memory={"kept": np.arange(3.0)})
    for values in inputs:
        result = stepper.step(stepper.prepare(replace(state, inputs=values)), DT)
        assert result.status is Status.CONVERGED
        state = result.state
    return state


def assert_same(one: State, other: State) -> None:
    for name in ("q", "v", "a"):
        assert_array_equal(getattr(one, name), getattr(other, name))


@pytest.mark.parametrize(
    "law", [Constant(2.0), Ramp(before=0.0, after=1.0, start=0.0, end=2.0), Expression("t*s")]
)
def test_a_law_is_a_signal_that_ignores_inputs(law: Signal) -> None:
    s = np.linspace(0.0, 1.0, 5)
    for inputs in (NO_INPUTS, np.array([7.0])):
        assert_array_equal(law.value(0.6, inputs, s), law(0.6, s))
        assert law.value(0.6, inputs) == law(0.6)


@pytest.mark.parametrize("integrator", [GeneralizedAlpha(), TrBdf2()], ids=lambda i: i.name)
def test_inputs_reach_every_term_at_every_stage(integrator: Integrator) -> None:
    by_inputs = steps(actuated(Channel(1), Channel(0)), integrator, [np.array([1.5, 40.0])] * 3)
    by_laws = steps(actuated(Constant(40.0), Constant(1.5)), integrator, [NO_INPUTS] * 3)
    at_rest = steps(actuated(Constant(0.0), Constant(0.0)), integrator, [NO_INPUTS] * 3)
    assert_same(by_inputs, by_laws)
    assert np.abs(by_inputs.q - at_rest.q).max() > 1e-5


def test_new_inputs_at_the_same_time_are_seen() -> None:
    """A natural strain is remembered for its time and its inputs."""
    model = actuated(Channel(0), Constant(0.0))
    stepper = Stepper(model, GeneralizedAlpha(), NewtonSettings(), "auto")
    rest = stepper.rest_state()
    small, large, again = (
        stepper.step(stepper.prepare(replace(rest, inputs=np.array([value]))), DT).state
        for value in (1.0, 100.0, 1.0)
    )
    assert_same(again, small)
    assert np.abs(large.q - small.q).max() > 1e-5


def test_steps_carry_inputs_and_memory_and_a_state_saves_them() -> None:
    inputs = np.array([0.3, 2.0])
    state = steps(actuated(Channel(1), Channel(0)), GeneralizedAlpha(), [inputs] * 2)
    assert state.inputs is inputs
    assert_array_equal(state.memory["kept"], np.arange(3.0))
    fresh = Stepper(cantilever("framed", nodes=9), GeneralizedAlpha(), NewtonSettings(), "auto").rest_state()
    restored = fresh.restore(state.arrays(), state.numbers())
    assert_same(restored, state)
    assert restored.t == state.t
    assert_array_equal(restored.inputs, inputs)
    assert restored.memory.keys() == {"kept"}
    assert_array_equal(restored.frames.director, state.frames.director)


def test_nothing_is_made_where_nothing_is_controlled() -> None:
    model = cantilever("planar", nodes=5)
    stepper = Stepper(model, TrBdf2(), NewtonSettings(), "auto")
    assert stepper.step(stepper.prepare(stepper.rest_state()), DT).state.inputs is NO_INPUTS
    assert not NO_INPUTS.flags.writeable
