"""Steps in one compiled function end where Python's steps end, to round-off, and fail as they fail."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dismech_cli.compose.compose import compose
from dismech_cli.kernels.numba_driver import NumbaDriver
from dismech_cli.run.loop import Limits, Outcome, run
from dismech_cli.run.simulation import Simulation
from dismech_cli.scenario.load import load
from dismech_cli.session.sinks import Memory
from dismech_cli.solve.status import Status
from dismech_cli.solve.step import Stepper
from dismech_cli.solve.system import System
from dismech_cli.solve.woven import Woven
from dismech_cli.solve.woven_iteration import iteration_text

pytest.importorskip("numba")
SCENARIOS = Path(__file__).parents[2] / "scenarios"


def _simulation(name: str) -> Simulation:
    return compose(load(SCENARIOS / f"{name}.yaml"), "numba").simulation


def _ran(simulation: Simulation, until: float) -> tuple[Outcome, Memory, list[Any]]:
    """A run, and what its compiled steps gave."""
    found: list[Any] = []
    original = Woven._run
    with pytest.MonkeyPatch.context() as patch:

        def noting(self: Woven, *arguments: Any) -> Any:
            found.append(original(self, *arguments))
            return found[-1]

        patch.setattr(Woven, "_run", noting)
        memory = Memory()
        return run(simulation, memory, limits=Limits(until=until)), memory, found


# planar, isotropic and framed; driven strains; statics; unsymmetric: resistive drag, follower loads, moments
# and damping of materials
@pytest.mark.parametrize(
    ("name", "until"),
    [
        ("cantilever_dynamic_1e6", 0.05),
        ("snake_21", 0.3),
        ("s_shape", 0.2),
        ("sinking_arc", 0.2),
        ("helix_soft", 0.2),
        ("snake", 0.3),
        ("l_frame", np.inf),
        ("two_limb", 0.2),
        ("helix_soft_static", np.inf),
        ("becks_column", 0.72),
        ("roll_up", np.inf),
        ("bouncing_weight", 0.3),
    ],
)
def test_runs_are_equal_to_round_off(name: str, until: float, monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = _simulation(name)
    woven, frames, found = _ran(simulation, until)
    monkeypatch.setattr(System, "woven", lambda self, at: None)
    plain, others, none = _ran(simulation, until)
    assert not none
    assert found, "the scene has a compiled step"
    # where one is in doubt Python asks again
    assert sum(one.steps < len(one.norms) for one in found) < 0.5 * len(found)
    assert woven.counters == plain.counters
    one, two = (np.array([frame.positions for frame in memory.frames]) for memory in (frames, others))
    size = float(np.ptp(two[0], axis=0).max())
    assert_allclose(one, two, rtol=0.0, atol=1e-10 * size)
    assert np.abs(one[-1] - one[0]).max() > 1e-4 * size


def test_a_run_compiles_its_step_once() -> None:
    """Arrays of another layout would be compiled for anew, for seconds and without a word."""
    simulation = _simulation("snake")
    stepper = Stepper(simulation.model, simulation.integrator, simulation.newton, simulation.linear_solver)
    state = stepper.prepare(simulation.start)
    for _ in range(3):
        state = stepper.step(state, 0.01).state
    woven = stepper.system._woven
    assert woven is not None
    module = woven._march.func.__self__._module
    assert len(module.march.signatures) == 1


@pytest.mark.parametrize("name", ["jellyfish", "rod_drop", "parachute_updraught", "gridshell"])
def test_what_cannot_be_woven_is_not(name: str) -> None:
    """Shells, contact, flow that varies and wide nets step in Python."""
    simulation = _simulation(name)
    stepper = Stepper(
        simulation.model,
        simulation.integrator,
        simulation.newton,
        simulation.linear_solver,
        simulation.advance,
    )
    stepper.step(stepper.prepare(simulation.start), 1e-4)
    assert stepper.system._woven is None


def test_a_step_that_fails_fails_as_it_did(monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = _simulation("helix_soft")
    ends = []
    for _ in range(2):
        few = replace(simulation.newton, max_iterations=1, tolerance=1e-13)
        stepper = Stepper(simulation.model, simulation.integrator, few, simulation.linear_solver)
        ends.append(stepper.step(stepper.prepare(simulation.start), 0.05))
        nowhere = replace(simulation.start, v=np.full_like(simulation.start.v, np.nan))
        ends.append(stepper.step(stepper.prepare(nowhere), 1e-3))
        monkeypatch.setattr(System, "woven", lambda self, at: None)
    assert ends[0].status is ends[2].status is not Status.CONVERGED
    assert ends[1].status is ends[3].status is Status.NOT_FINITE
    assert (ends[0].iterations, ends[0].worst) == (ends[2].iterations, ends[2].worst)


def _factors(width: int, *, symmetric: bool) -> Any:
    """The compiled factors of a band, made to be called from here."""
    from numba import njit

    text = iteration_text(width, symmetric=symmetric)
    NumbaDriver().woven(text, ())
    band = sys.modules[f"dismech_loops_{text.name}"]
    factorize, substitute = band.factorize, band.substitute
    return SimpleNamespace(
        factorize=njit(lambda a, factors, pivots, x, m: factorize(a, factors, pivots, x, m)),
        substitute=njit(
            lambda a, factors, pivots, x, b, out, m: substitute(a, factors, pivots, x, b, out, m)
        ),
    )


@pytest.mark.parametrize(("m", "width"), [(1, 0), (3, 5), (40, 6)])
@pytest.mark.parametrize("symmetric", [True, False])
def test_factors_of_bands(m: int, width: int, symmetric: bool) -> None:
    """Solutions have a residual of rounding; a matrix that is singular or indefinite is told."""
    rng = np.random.default_rng(m)
    full = rng.standard_normal((m, m))
    i, j = np.indices((m, m))
    full[np.abs(i - j) > width] = 0.0
    if symmetric:
        full = full + full.T + 4.0 * (width + 1) * np.eye(m)
    step, left = (width + 1, 0) if symmetric else (3 * width + 1, width)
    keep = (j >= i) & (j - i <= width) if symmetric else np.abs(i - j) <= width
    a = np.zeros((m + width) * step + 1)
    a[(i * step + j - i + left)[keep]] = full[keep]
    # what is fixed adds up beyond the matrix
    a[-1] = np.nan
    b = rng.standard_normal(m)

    band = _factors(width, symmetric=symmetric)
    room, out, pivots = np.empty_like(a), np.empty(m + width), np.empty(m, dtype=np.int64)
    x = np.concatenate((b, np.zeros(2 * width)))
    assert band.factorize(a, room, pivots, x, m)
    found = band.substitute(a, room, pivots, x, b, out, m)
    rounding = 1e-15 * m**2 * np.abs(full).max() * np.abs(x).max()
    assert_allclose(full @ x[:m], b, rtol=0.0, atol=rounding)
    assert_allclose(out[:m], b - full @ x[:m], rtol=0.0, atol=rounding)
    assert found == np.abs(out[:m]).max()
    assert symmetric or m == 1 or (pivots != np.arange(m)).any()

    bad = a.copy()
    if symmetric:
        bad[(m // 2) * step] *= -1.0
    else:
        bad[:-1] = 0.0
    assert not band.factorize(bad, room, pivots, x.copy(), m)
    # a defect that is no number is not lost among numbers
    b[m - 1] = np.nan
    assert np.isnan(band.substitute(a, room, pivots, x, b, out, m))
