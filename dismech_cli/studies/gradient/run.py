"""A run that leaves a tape, and what can be differentiated along it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ...compose.compose import Composition, compose
from ...errors import ScenarioError, SolverError, UnfinishedError
from ...frozen import frozen
from ...kernels.driver import Driver
from ...kernels.kept import missing
from ...kernels.loop_text import call_text
from ...kernels.numpy_driver import NumpyDriver
from ...model.alike import alike
from ...run.adaptive import Adaptive
from ...run.interrupt import StopRequest
from ...run.loop import End, Outcome, run
from ...run.observables.probes import Probe
from ...run.simulation import Simulation
from ...scenario.load import LoadedScenario
from ...session.composing import composed
from ...session.narrator import Narrator
from ...session.sinks import Latest, Several, Telling
from ...solve.accelerations import SAME
from ...solve.differentiated import Differentiated
from ...solve.neighbours import UnlikeError
from ...solve.sweep import LOOPS
from ...solve.tape import THROUGH_STAGES, Tape, TapedStep
from ..source import Source
from .nearby import Nearby

# Derivatives are those of exact balances: what Newton's method may leave is no more than this share.
_TOLERANCE = 1e-10
# A tape keeps six vectors of the size of the model per stage.
_TAPE_BYTES = 4e9


@frozen
class TapedRun:
    """A run that came to its end.

    Attributes:
        simulation: What was run.
        outcome: How it ended.
        steps: Its steps.
    """

    simulation: Simulation
    outcome: Outcome
    steps: tuple[TapedStep, ...]


def exactly(composition: Composition, watched: Mapping[str, Probe]) -> Simulation:
    """A simulation whose balances are solved as well as rounding allows, and that watches some probes."""
    simulation = composition.simulation
    newton = simulation.newton
    return replace(
        simulation,
        newton=replace(newton, tolerance=min(newton.tolerance, _TOLERANCE)),
        frame_every=1e300,
        fields=(),
        probes={},
        topology=replace(simulation.topology, scalars={}),
        watched=watched,
    )


def run_taped(simulation: Simulation, narrator: Narrator, stop: StopRequest | None = None) -> TapedRun:
    """Run a simulation to its end and keep its steps, if they can be.

    Raises:
        SolverError: It did not come to its end.
        UnfinishedError: It was stopped.
    """
    tape = Tape(simulation.advance)
    taped = replace(simulation, advance=tape)
    outcome = run(taped, Several((Latest(), Telling(narrator))), stop=stop, announce=narrator.detail)
    finished(outcome)
    return TapedRun(simulation, outcome, tuple(tape.steps))


def finished(outcome: Outcome) -> None:
    """Refuse a run that did not come to its end.

    Raises:
        SolverError: It failed.
        UnfinishedError: It was stopped.
    """
    if outcome.end is End.FAILED:
        raise SolverError(f"the run has no end to differentiate: {outcome.message}")
    if outcome.end is End.INTERRUPTED:
        raise UnfinishedError(outcome.message)


def why_not(simulation: Simulation) -> str:
    """Why a run has no exact derivative; empty if it has one."""
    model = simulation.model
    if simulation.advance not in THROUGH_STAGES:
        return "the load factor of a path of equilibria is an unknown"
    if isinstance(simulation.control, Adaptive):
        return "the lengths of adaptive steps depend on all values; 'numerics.dt' makes them fixed"
    if why := next((why for term in model.changing if (why := term.untold(()))), ""):
        return why
    if any(edges.shared for edges in model.frames.turning):
        return "shells that are welded share their normals"
    stages = simulation.integrator.stages * simulation.control.steps
    if 48.0 * stages * model.dofs.n > _TAPE_BYTES:
        return "the run is too long to keep all its steps in memory"
    return ""


def why_not_after(run: TapedRun) -> str:
    """The same of what a run has come to; empty if it has an exact derivative."""
    left = [step.result.state.memory for step in run.steps]
    why = next((why for term in run.simulation.model.changing if (why := term.untold(left))), "")
    if why or not run.simulation.model.changing or not run.simulation.integrator.needs_acceleration:
        return why
    lengths = np.array([step.dt for step in run.steps])
    if (np.abs(lengths / lengths.mean() - 1.0) > SAME).any():
        return "a step was cut, and contact hands its accelerations on by the lengths of steps"
    return ""


def why_not_by(simulation: Simulation, near: Sequence[Nearby]) -> str:
    """Why some value has no exact derivative; empty if all have one."""
    for one in near:
        if not all(alike(simulation.control, other.control) for other in one.simulations):
            return f"{one.setting.path} changes the times at which steps end"
    return ""


def sweeper(loaded: LoadedScenario, simulation: Simulation) -> Driver:
    """What runs the sweeps of derivatives: their loops are compiled once, for all scenes.

    That takes longer than most sweeps: it is done where compiled kernels are asked for.
    """
    asked = loaded.scenario.numerics.kernels == "numba"
    kept = asked or not missing([call_text(loop) for loop in LOOPS])
    return simulation.model.driver if kept else NumpyDriver()


def differentiated(run: TapedRun, near: Sequence[Nearby], sweeps: Driver) -> Differentiated:
    """What was run with its slopes to parameters, and what runs sweeps.

    Raises:
        ScenarioError: A parameter changes the structure of the model.
    """
    try:
        parameters, simulation = [one.neighbours for one in near], run.simulation
        return Differentiated(simulation.model, simulation.integrator, parameters, sweeps, run.steps)
    except UnlikeError as error:
        path = near[error.index].setting.path
        raise ScenarioError(f"{path} changes what the model is made of: it has no derivative") from None


def start_run(source: Source, narrator: Narrator, *changes: str) -> tuple[LoadedScenario, Composition]:
    """Read and compose a scenario, telling its doubts.

    Raises:
        ScenarioError: It cannot be read or composed.
    """
    loaded = source.load(*changes)
    for warning in loaded.warnings:
        narrator.warn(warning)
    composition = composed(loaded, None, narrator)
    for warning in composition.plan.warnings:
        narrator.warn(warning)
    return loaded, composition


def quietly(source: Source, *changes: str) -> Composition:
    """The same of a neighbour of a scenario, which has nothing new to tell."""
    return compose(source.load(*changes))
