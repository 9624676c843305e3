"""Every integrator knows the error of its own step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cases import clamped, planar_rod, properties, straight
from numpy.testing import assert_allclose
from order import observed_order

from dismech_cli.arrays import FloatArray
from dismech_cli.model.model import Model
from dismech_cli.model.state import State
from dismech_cli.solve.integrators import (
    GeneralizedAlpha,
    ImplicitEuler,
    ImplicitMidpoint,
    Integrator,
    Newmark,
    TrBdf2,
)
from dismech_cli.solve.problem import NewtonSettings
from dismech_cli.solve.status import Status
from dismech_cli.solve.step import Stepper
from dismech_cli.solve.step_result import StepResult

TIGHT = NewtonSettings(tolerance=1e-13)
SOFT = properties(axial=3.0, bending=0.05, torsional=0.01, mass_per_length=1.0)
ONE_OF_EACH: list[Integrator] = [
    ImplicitEuler(),
    ImplicitMidpoint(),
    Newmark(),
    GeneralizedAlpha(),
    GeneralizedAlpha(spectral_radius=0.0),
    TrBdf2(),
]


def _swinging() -> tuple[Model, FloatArray]:
    model = clamped(planar_rod(*straight(6, 1.0), SOFT), (0, 1))
    x = model.dofs.positions(model.rest)[:, 0]
    v = np.zeros(model.dofs.n)
    v[1 : model.dofs.n_positions : 2] = 2.0 * (x - x[1]).clip(0.0) ** 2
    return model, v


def _step(stepper: Stepper, state: State, dt: float) -> StepResult:
    result = stepper.step(stepper.prepare(state), dt)
    assert result.status is Status.CONVERGED
    return result


def _estimated_and_true(integrator: Integrator, dt: float) -> tuple[FloatArray, FloatArray]:
    """Of a step in the middle of a swing, after others of the same length."""
    model, velocity = _swinging()
    stepper, exact = (Stepper(model, one, TIGHT, "auto") for one in (integrator, TrBdf2()))
    state = stepper.rest_state(velocity)
    for _ in range(round(0.2 / dt)):
        state = _step(stepper, state, dt).state
    result = _step(stepper, state, dt)
    parts = 12
    right = exact.prepare(replace(state, t=0.0))  # with an acceleration of its own
    for _ in range(parts):
        right = _step(exact, right, dt / parts).state
    free = stepper.system.pattern.free
    return integrator.error(result.trail, dt)[free], (result.state.q - right.q)[free]


@pytest.mark.parametrize(
    "integrator", ONE_OF_EACH, ids=lambda one: f"{one.name}-{getattr(one, 'spectral_radius', '')}"
)
def test_the_estimate_is_the_error(integrator: Integrator) -> None:
    """In the limit of short steps, up to terms that are one order smaller; and it falls as declared."""
    steps = np.array([4e-3, 2e-3, 1e-3])
    sizes, misses = [], []
    for dt in steps.tolist():
        estimated, true = _estimated_and_true(integrator, dt)
        sizes.append(np.linalg.norm(estimated))
        misses.append(min(np.linalg.norm(estimated - true), np.linalg.norm(estimated + true)))
    assert observed_order(steps, np.array(sizes)) == pytest.approx(integrator.error_order, abs=0.15)
    assert misses[-1] < 0.1 * sizes[-1]
    assert misses[-1] < 0.7 * misses[-2] * 0.5 ** (integrator.error_order - 1)


def test_a_newmark_scheme_without_an_error_of_positions_has_one_of_velocities() -> None:
    """With beta = 1/6 the positions' own term vanishes: steps must not grow without bound for that."""
    estimated, _ = _estimated_and_true(Newmark(beta=1.0 / 6.0), 1e-3)
    usual, _ = _estimated_and_true(Newmark(), 1e-3)
    assert_allclose(np.linalg.norm(estimated), np.linalg.norm(usual), rtol=0.05)
