"""The gains of sampled loops, before a run and by ``dismech check``."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from ..control.controller import Linear
from ..control.loop import SampledLoop
from ..frozen import frozen
from ..run.clock import time_grid
from ..run.simulation import Simulation
from ..scenario.language.numerics import Numerics
from ..solve.step import Stepper
from ..words import listed

if TYPE_CHECKING:
    from ..control.gain import Gain

# Steps that may be spent on loops, and the share of those of a run that does it unasked.
_MOST_STEPS, _SHARE = 4000, 0.05
# Balance is found this well, in shares of the largest force: responses are differences.
_TOLERANCE = 1e-12
# Into so many steps a period is parted where steps adapt themselves.
_PARTS = 8
# Loops nearer than this to their limit are doubtful.
_NEAR = 2.0


@frozen
class LoopFinding:
    """What is known of the sampled loops of one period.

    Attributes:
        name: Name of the first of their controllers.
        text: For the user.
        error: Why they cannot work; empty if they may.
        warning: What is doubtful; empty if nothing is.
    """

    name: str
    text: str
    error: str = ""
    warning: str = ""


def nominal_step(numerics: Numerics) -> float | None:
    """The time step [s]; None where steps adapt themselves."""
    return None if numerics.adapts else numerics.dt


def doubtful_loops(simulation: Simulation, dt: float | None) -> tuple[str, ...]:
    """What to tell of loops before a run; nothing of those that would take long to look at."""
    found = look_at_loops(simulation, dt, most=int(_SHARE * simulation.control.steps))
    return tuple(loop.error or loop.warning for loop in found if loop.error or loop.warning)


def look_at_loops(
    simulation: Simulation, dt: float | None, *, most: int = _MOST_STEPS
) -> tuple[LoopFinding, ...]:
    """Look at the sampled loops with linear laws, those of one period together.

    Args:
        simulation: With its controllers.
        dt: Time step [s]; None where steps adapt themselves.
        most: Time steps that this may take; what would take more is only named.
    """
    groups: dict[float, list[SampledLoop]] = {}
    found: list[LoopFinding] = []
    for loop in simulation.controls.loops:
        if not isinstance(loop, SampledLoop):
            continue
        if isinstance(loop.controller, Linear):
            groups.setdefault(loop.period, []).append(loop)
        else:
            found.append(LoopFinding(loop.name, f"gain of {loop.name!r}: of a plugin, not looked at"))
    looked = (finding for loops in groups.values() for finding in _findings(simulation, loops, dt, most))
    return (*found, *looked)


def _findings(
    simulation: Simulation, loops: list[SampledLoop], dt: float | None, most: int
) -> Iterator[LoopFinding]:
    from ..control.gain import loop_gain, steps_needed

    newton = replace(simulation.newton, tolerance=_TOLERANCE)
    stepper = Stepper(
        simulation.model, simulation.integrator, newton, simulation.linear_solver, simulation.advance
    )
    period = loops[0].period
    times = time_grid(dt or period / _PARTS, period)
    names = listed([loop.name for loop in loops], "and")
    needed = steps_needed(loops, stepper.system.pattern.m, len(times) - 1)
    if needed > most:
        text = f"gain of {names}: not looked at, which would take {needed} steps"
        yield LoopFinding(loops[0].name, text)
        return
    gain = loop_gain(loops, stepper, simulation.start, times)
    if gain is None:
        yield LoopFinding(loops[0].name, f"gain of {names}: unknown, for the first period cannot be stepped")
        return
    yield _told(gain, loops, names)


def _told(gain: Gain, loops: list[SampledLoop], names: str) -> LoopFinding:
    late = max(loop.sensors[0].late * loop.period for loop in loops)
    told = f", readings are {late:g} s late" if late else ""
    text = (
        f"gain of {names}: in a period of {loops[0].period:g} s a place goes up to {gain.reach:.2g} of the "
        f"way to its command{told}; errors grow by {gain.growth:.4g} "
        f"from sample to sample at last, and without end from {gain.margin:.3g} times these gains on"
    )
    name = loops[0].name
    if not gain.stable:
        advice = "lower p and i, smooth more, or take a shorter period or delay"
        return LoopFinding(
            name, text, error=f"{names} cannot be stable where the run starts; {text}; {advice}"
        )
    if gain.margin < _NEAR:
        return LoopFinding(name, text, warning=f"{names} may swing; {text}")
    return LoopFinding(name, text)
