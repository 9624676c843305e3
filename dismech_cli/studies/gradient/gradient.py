"""The gradient of a number that a run gives, to values of its scenario; what ``dismech gradient`` prints."""

from __future__ import annotations

import time
from collections.abc import Sequence
from enum import Enum
from typing import Final

import numpy as np

from ...arrays import FloatArray
from ...compose.compose import Composition
from ...control.loop import UNCONTROLLED
from ...errors import ScenarioError
from ...frozen import frozen
from ...model.alike import alike
from ...run.observables.probes import Probe
from ...run.simulation import Simulation
from ...scenario.language.expect import measured
from ...scenario.language.probe import ContactProbe, EnergyProbe, StabilityProbe
from ...scenario.language.probe import Probe as ProbeSpec
from ...scenario.load import LoadedScenario
from ...session.narrator import Narrator, Silent
from ...solve.adjoint import adjoint
from ...solve.differentiated import Differentiated
from ...solve.linear.factors import FactorizationError
from ...solve.neighbours import DIFFERENCES
from ...solve.sensitivity import NOWHERE, forward
from ...units import KINDS
from ...words import hint
from ..source import Source
from .acting import acting_of
from .nearby import Nearby, nearby
from .reading import Readings, Reduced, states
from .run import (
    TapedRun,
    differentiated,
    exactly,
    quietly,
    run_taped,
    start_run,
    sweeper,
    why_not,
    why_not_after,
    why_not_by,
)
from .setting import Setting, expanded

# Up to as many parameters forward sensitivities are used, which give more; beyond, the adjoint costs less.
_MANY: Final = 30
# Steps of differences of runs, of each value, and the part of a directional derivative by which it may miss
# them, beyond what curvature leaves. Long runs of what swings turn by their phase: of long steps their higher
# derivatives leave more than is seen.
_STEPS: Final = ((1e-3, 1e-6), (1e-4, 1e-6))
# Extremes and periods have kinks where another step of the run becomes the extreme, which few so short pass.
_PAST_KINKS: Final = ((1e-5, 1e-4),)
# What a difference may leave open however small the derivative is, of the number.
_NOTHING: Final = 1e-6


class Method(Enum):
    """How a gradient was found."""

    AUTO = "auto"
    FORWARD = "forward"
    ADJOINT = "adjoint"
    DIFFERENCES = "differences"


@frozen
class Check:
    """A directional derivative beside the difference of runs.

    Attributes:
        gradient: Of the gradient, along the direction that changes every value up the slope by its size.
        difference: Of runs.
        uncertainty: What curvature may have left in the difference.
        agrees: Whether they do.
    """

    gradient: float
    difference: float
    uncertainty: float
    agrees: bool


@frozen
class Gradient:
    """A gradient.

    Attributes:
        of: Name of the number.
        unit: Its SI unit.
        value: The number.
        settings: The parameters.
        slopes: The derivatives, one per parameter.
        method: How they were found.
        why: Why not otherwise, or empty.
        check: Against a difference of runs; None where it was not asked for.
        seconds: Wall time of the run, and of the derivatives [s].
    """

    of: str
    unit: str
    value: float
    settings: tuple[Setting, ...]
    slopes: FloatArray
    method: Method
    why: str
    check: Check | None
    seconds: tuple[float, float]


def gradient(
    source: Source,
    of: str,
    by: Sequence[str],
    narrator: Narrator,
    *,
    method: Method = Method.AUTO,
    checked: bool = True,
) -> Gradient:
    """Run a scenario and differentiate a number of it.

    Args:
        source: The scenario.
        of: Name of a probe of the output, read at the end, or of an expectation, reduced as that says.
        by: Key paths of values; none for all declared parameters.
        narrator: Told what happens.
        method: How.
        checked: Whether a directional derivative is compared with runs.

    Raises:
        ScenarioError: Something asked for is not there or has no derivative.
        SolverError: A run did not come to its end.
    """
    loaded, composition = start_run(source, narrator)
    target, unit = find(loaded, composition, of)
    paths = tuple(by) or tuple(f"parameters.{name}" for name in loaded.parameters)
    if not paths:
        raise ScenarioError("the scenario declares no parameters: say by what to differentiate, --by KEY")
    paths = tuple(path for text in paths for path in expanded(loaded, text))
    settings = tuple(Setting.of(loaded, path) for path in dict.fromkeys(paths))
    simulation = exactly(composition, {of: target.probe})
    why = why_not(simulation) or _history(_spec(loaded, of))
    tick = time.perf_counter()
    exactly_asked = not why and method is not Method.DIFFERENCES
    near = nearby(source, settings, composition) if exactly_asked else []
    composing = time.perf_counter() - tick
    why = why or why_not_by(simulation, near)
    _refuse(method, why)
    tick = time.perf_counter()
    run = run_taped(simulation, narrator)
    value = target(run.outcome.times, run.outcome.watched[of])
    tock = time.perf_counter()
    why = why or why_not_after(run)
    _refuse(method, why)
    if why or method is Method.DIFFERENCES:
        sizes = np.array([setting.size for setting in settings])
        slopes = np.array([_by_runs(source, target, (one,), np.array([one.size]))[0] for one in settings])
        slopes /= sizes
        chosen = Method.DIFFERENCES
    else:
        model = differentiated(run, near, sweeper(loaded, simulation))
        for setting, one, beside in zip(settings, model.parameters, near, strict=True):
            acts = not all(alike(simulation.controls, other.controls) for other in beside.simulations)
            if one.nothing and not acts:
                narrator.warn(f"{setting.path} changes nothing in the model: its derivative is zero")
        chosen = _method(method, target, model, free=simulation.controls is UNCONTROLLED)
        slopes = exact(chosen, simulation, target, run, model, near)
    seconds = (tock - tick, composing + time.perf_counter() - tock)
    check = _check(source, target, settings, slopes, value) if checked and not why else None
    return Gradient(of, unit, value, settings, slopes, chosen, why, check, seconds)


def _refuse(method: Method, why: str) -> None:
    """Refuse exact derivatives that were asked for and are not there.

    Raises:
        ScenarioError: They are not.
    """
    if why and method in (Method.FORWARD, Method.ADJOINT):
        raise ScenarioError(f"no {method.value} derivative: {why}; take --method differences")


def find(loaded: LoadedScenario, composition: Composition, name: str) -> tuple[Reduced, str]:
    """A number of a scenario by the name of a probe or an expectation, and its unit.

    Raises:
        ScenarioError: There is none.
    """
    scenario, simulation = loaded.scenario, composition.simulation
    if name in simulation.probes:
        probe = simulation.probes[name]
        return Reduced(name, probe), probe.unit
    if name in scenario.expect:
        e = scenario.expect[name]
        unit = KINDS[measured(e.probe, e.reduce)].unit
        return Reduced(name, simulation.watched[name], e.reduce, e.at, e.after), unit
    names = (*scenario.output.probes, *scenario.expect)
    known = hint(name, names) or (f"; there are {', '.join(names)}" if names else "; there are none")
    raise ScenarioError(f"--of {name}: no probe of the output and no expectation has this name{known}")


def _spec(loaded: LoadedScenario, name: str) -> ProbeSpec:
    probes = loaded.scenario.output.probes
    return probes[name] if name in probes else loaded.scenario.expect[name].probe


def _history(probe: ProbeSpec) -> str:
    """Why a probe is no function of the state; empty if it is one.

    Raises:
        ScenarioError: It is a whole number.
    """
    match probe:
        case StabilityProbe():
            raise ScenarioError("a number of eigenvalues has no derivative")
        case ContactProbe(measure="places"):
            raise ScenarioError("a number of edges that touch has no derivative")
        case EnergyProbe(energy="error" | "friction" | "contact" as name):
            return f"the energy {name!r} is summed over the run"
        case _:
            return ""


def _method(wanted: Method, target: Reduced, model: Differentiated, *, free: bool) -> Method:
    """How to differentiate a run, which may be free of controllers.

    Raises:
        ScenarioError: The adjoint was asked for and cannot.
    """
    able = target.of_end and model.retraceable and target.probe.unit in ("m", "m/s", "rad") and free
    if wanted is Method.ADJOINT and not able:
        raise ScenarioError(
            "the adjoint is for positions, velocities and angles at the end of a run, under motions whose "
            "law alone says where they go, without controllers: take --method forward"
        )
    if wanted is Method.AUTO:
        return Method.ADJOINT if able and len(model.parameters) > _MANY else Method.FORWARD
    return wanted


def exact(
    method: Method,
    simulation: Simulation,
    target: Reduced,
    run: TapedRun,
    model: Differentiated,
    near: Sequence[Nearby],
) -> FloatArray:
    """Derivatives along the tape."""
    readings = Readings(simulation, target.probe, near, [_probes(one, target.name) for one in near])
    seen = states(simulation.start, run.steps)
    try:
        if method is Method.ADJOINT:
            owed = readings.owed(*seen[-1])
            return adjoint(model, simulation.start, run.steps, owed) + readings.by_scene(*seen[-1])
        courses = []
        wanted = np.arange(len(simulation.start.q)) if readings.of_forces else NOWHERE
        along = forward(model, simulation.start, run.steps, wanted, acting_of(simulation, near))
        for (state, residual), d in zip(seen, along, strict=True):
            if not target.of_end or state is seen[-1][0]:
                courses.append(readings.slopes(state, residual, d))
    except FactorizationError as error:
        raise ScenarioError(f"the run passes a state without a derivative: {error}") from None
    if target.of_end:
        return courses[-1]
    times, values = run.outcome.times, run.outcome.watched[target.name]
    return np.array([target.slope(times, values, change) for change in np.stack(courses, axis=1)])


def _probes(near: Nearby, name: str) -> list[Probe]:
    return [one.probes[name] if name in one.probes else one.watched[name] for one in near.simulations]


def _check(
    source: Source,
    target: Reduced,
    settings: Sequence[Setting],
    slopes: FloatArray,
    value: float,
) -> Check:
    """Compare up the slope: every value changes by its own size, so that no two changes cancel.

    A difference that is known to less than a third of itself, as that of a run that is unstable, agrees
    with nothing: unless both are next to nothing beside the number.
    """
    sizes = np.array([setting.size for setting in settings]) * np.where(slopes < 0.0, -1.0, 1.0)
    along = float(slopes @ sizes)
    for step, share in _STEPS if target.smooth else _STEPS + _PAST_KINKS:
        difference, uncertainty = _by_runs(source, target, settings, sizes, step)
        told = 3.0 * uncertainty <= max(along, abs(difference)) or uncertainty <= _NOTHING * abs(value)
        agrees = told and abs(along - difference) <= share * along + 3.0 * uncertainty
        if agrees:
            break
    return Check(along, difference, uncertainty, bool(agrees))


def _by_runs(
    source: Source,
    target: Reduced,
    settings: Sequence[Setting],
    sizes: FloatArray,
    step: float = _STEPS[0][0],
) -> tuple[float, float]:
    """Derivative by runs along changes of all settings, and what curvature may have left in it.

    Raises:
        ScenarioError: The scenario cannot be changed so.
        SolverError: A run fails.
    """
    refused: ScenarioError | None = None
    for difference in DIFFERENCES:
        try:
            values = [_run(source, target, settings, k * step * sizes) for k in difference.offsets]
        except ScenarioError as error:
            refused = refused or error
            continue
        best = float(difference([np.asarray(value) for value in values], step))
        one, other = (abs(k) == 1 for k in difference.offsets), (k == 0 for k in difference.offsets)
        near = [(k, x) for k, x, a, b in zip(difference.offsets, values, one, other, strict=True) if a or b]
        plain = (near[0][1] - near[-1][1]) / ((near[0][0] - near[-1][0]) * step)
        # the plain quotient is off by the square of the step, or by the step; the better one by its square
        left = abs(plain - best)
        scale = max(map(abs, values)) or 1.0
        return best, left**2 / max(abs(best), left, 1e-300) + 1e-13 * scale / step
    assert refused is not None
    raise refused


def _run(source: Source, target: Reduced, settings: Sequence[Setting], changes: FloatArray) -> float:
    """The number of a run whose settings are greater by some changes."""
    changed = [one.to(one.value + change) for one, change in zip(settings, changes, strict=True)]
    composition = quietly(source, *changed)
    simulation = composition.simulation
    probe = {**simulation.watched, **simulation.probes}[target.name]
    outcome = run_taped(exactly(composition, {target.name: probe}), Silent()).outcome
    return target(outcome.times, outcome.watched[target.name])
