"""How far the steps of a run go, and when it is looked at."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf

import numpy as np

from ..arrays import FloatArray, union
from ..frozen import frozen
from ..laws.laws import Law
from ..model.model import Model
from ..run.clock import Clock, time_grid
from ..run.looks import Looks, at_ends, within
from ..run.step_control import StepControl
from ..run.tolerance import LENGTHS, RTOL, Tolerance
from ..scenario.language.numerics import Numerics, Static
from ..scenario.load import LoadedScenario
from ..scenario.values.law import PLACES, ExpressionLaw, RampLaw, SawtoothLaw, SineLaw, TableLaw
from ..scenario.values.runtime_law import to_law
from ..scenario.views.walk import walk
from .numerics import build_integrator

# Where laws of places are looked at: next to the origin, and within a metre.
_SOMEWHERE = np.array([0.0, 0.03, 1.0])


@frozen
class Stepping:
    """How a run goes on in time.

    Attributes:
        control: Decides how far each step goes; here, as the run starts.
        every: Time between frames [s].
        looks: When it is looked at.
    """

    control: StepControl
    every: float
    looks: Looks = at_ends


def make_stepping(
    loaded: LoadedScenario, model: Model, start: FloatArray, samples: tuple[float, ...] = ()
) -> Stepping:
    """What decides on steps and frames.

    Args:
        loaded: The scenario.
        model: What is stepped.
        start: Shape (n,) that motion is counted from.
        samples: Times at which steps must end [s]: those at which controllers sample.
    """
    numerics, every = loaded.scenario.numerics, loaded.scenario.output.every
    cuts, integrator = numerics.step.max_cuts, numerics.integrator
    if isinstance(integrator, Static):
        if integrator.path is not None:
            from ..run.path_control import PathControl

            path = integrator.path
            first = min(path.first, path.largest)
            return Stepping(PathControl(first, path.largest, path.steps, cuts), every or 0.0)
        return Stepping(Clock(time_grid(1.0 / integrator.steps, 1.0), cuts), every or 0.0)
    t_end = numerics.t_end
    assert t_end is not None
    every = every or t_end / 100.0
    releases = tuple(m.release for m in loaded.scenario.motions if m.release is not None)
    if not numerics.adapts:
        assert numerics.dt is not None
        return Stepping(Clock(time_grid(numerics.dt, t_end, (*releases, *samples)), cuts), every)
    return _adaptive(loaded, model, start, samples, releases, every, t_end)


def _adaptive(
    loaded: LoadedScenario,
    model: Model,
    start: FloatArray,
    samples: tuple[float, ...],
    releases: tuple[float, ...],
    every: float,
    t_end: float,
) -> Stepping:
    """Steps as long as a tolerance allows, between releases of motions and samples."""
    from ..run.accuracy import Accuracy
    from ..run.adaptive import Adaptive
    from ..run.error_norm import ErrorNorm
    from ..run.pace import find_pace
    from ..run.stops import Stops

    numerics = loaded.scenario.numerics
    tolerance, scheme = _tolerance(numerics, t_end), build_integrator(numerics.integrator)
    # what rings, or touches, moves in a step as no cubic does: frames, and times that expectations ask for,
    # then lie at the ends of steps
    smooth = scheme.damping > 0 and loaded.scenario.contact is None
    norm = ErrorNorm(model, start, float(np.ptp(model.dofs.positions(model.rest), axis=0).max()))
    pace = find_pace(tuple(_laws(loaded)), releases, t_end)
    control = Adaptive(
        tolerance=tolerance,
        stops=(
            Stops(pace, inf, np.array(samples))
            if smooth
            else Stops(
                pace, every, union(np.array(samples), _asked(loaded, every, np.append(pace.events, samples)))
            )
        ),
        accuracy=Accuracy(norm, scheme, tolerance.rtol, t_end),
        step=tolerance.first,
    )
    return Stepping(control, every, within if smooth else at_ends)


def _asked(loaded: LoadedScenario, every: float, stops: FloatArray) -> FloatArray:
    """Times of expectations [s] at which no frame is, and nothing else that ends a step: (K,)."""
    asked = np.array([one.at for one in loaded.scenario.expect.values() if one.at is not None])
    apart = np.abs(asked - every * np.round(asked / every)) > 1e-9 * every
    return asked[apart & (np.abs(asked[:, None] - stops) > 1e-9 * every).all(axis=1)]


def _tolerance(numerics: Numerics, t_end: float) -> Tolerance:
    """What adaptive steps have to keep, with defaults by the length of the run."""
    step, (first, shortest, longest) = numerics.step, (share * t_end for share in LENGTHS)
    longest = step.dt_max or max(longest, numerics.dt or 0.0)
    first = numerics.dt or max(min(first, longest), step.dt_min or 0.0)
    return Tolerance(step.rtol or RTOL, first, step.dt_min or min(shortest, first), longest)


def _laws(loaded: LoadedScenario) -> Iterator[Law]:
    """Every law of the scenario, wherever it stands."""
    places = dict.fromkeys(PLACES, _SOMEWHERE)
    for _, value in walk(loaded.scenario):
        if isinstance(value, TableLaw | RampLaw | SineLaw | SawtoothLaw | ExpressionLaw):
            yield to_law(value, loaded.directory, places)
