"""Fit values of a scenario to measured curves, and say what the curves cannot tell; ``dismech calibrate``."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ...arrays import FloatArray
from ...errors import ScenarioError
from ...scenario.language.numerics import Static
from ...session.narrator import Narrator
from ..gradient.run import start_run
from ..source import Source
from .fit import Fit
from .problem import Problem
from .verdict import judged


def calibrate(source: Source, folder: Path, narrator: Narrator, *, finer: bool = True) -> Fit:
    """Fit what ``calibrate:`` of a scenario says.

    Args:
        source: The scenario.
        folder: Where evaluations are kept; what is there already is not run again.
        narrator: Told what happens.
        finer: Whether the fit is repeated at half the time step.

    Raises:
        ScenarioError: The scenario or its data cannot be used.
        SolverError: The run at the start fails.
    """
    loaded, _ = start_run(source, narrator)
    if loaded.scenario.calibrate is None:
        raise ScenarioError(f"{source.path}: has no 'calibrate': docs/calibration.md shows one")
    problem = Problem.of(source, loaded, folder, narrator)
    x, fit = _fitted(problem, problem.start())
    still = isinstance(loaded.scenario.numerics.integrator, Static)
    if not finer or still or not problem.knobs:
        return fit
    dt = loaded.scenario.numerics.dt
    assert dt is not None
    narrator.say(f"again at half the time step, {dt / 2:.6g} s")
    halved = source.having(f"numerics.dt={dt / 2!r}")
    again = Problem.of(halved, halved.load(), folder, narrator)
    y, other = _fitted(again, x)
    n = len(problem.knobs)
    change = (y[:n] - x[:n]) / np.where(fit.deviations > 0.0, fit.deviations, np.inf)
    return replace(fit, finer=change, runs=fit.runs + other.runs)


def _fitted(problem: Problem, start: FloatArray) -> tuple[FloatArray, Fit]:
    """Where a fit ends, and what it is worth."""
    found = problem.solve(start)
    return found.x, judged(problem, found.x, np.asarray(found.jac), found.active_mask, str(found.message))
