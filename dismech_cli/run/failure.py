"""What to tell when the solver gives up: what, where, when, the last steps, what to do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

from ..solve.integrators import INTEGRATORS, Static
from ..solve.status import Status
from ..solve.step import StepResult
from .simulation import Simulation

Attempt: TypeAlias = tuple[float, float, StepResult]
"""Start and end of a step [s], and what came of it."""


# Where the time of a run is the share of its loads, steps are load steps.
_STATIC_ADVICE: Mapping[Status, str] = {
    Status.MAX_ITERATIONS: (
        "the next equilibrium is far away: raise integrator.load_steps or numerics.newton.max_iterations; "
        "thin shells and slack strings settle in a dynamic run with implicit_euler and damping instead"
    ),
    Status.NOT_FINITE: "an edge folded back on itself or collapsed: raise integrator.load_steps",
    Status.LINE_SEARCH_FAILED: (
        "no step lowers the energy: the load is near a fold or snap-through; pass it dynamically"
    ),
}


def describe_failure(simulation: Simulation, last: Sequence[Attempt]) -> str:
    """Several lines that a user can act on, about the last of some attempts."""
    start, t, result = last[-1]
    static = isinstance(simulation.integrator, Static)
    unit = "" if static else " s"
    step = "a step of" if static else "dt ="
    where = "of the load " if static else ""
    lines = [
        f"the solver gave up at t = {t:.6g}{unit} {where}with {step} {t - start:.3g}{unit}: "
        f"{result.status.name.lower().replace('_', ' ')}",
        f"  largest residual {result.residual_norm:.3g} N at {_where(simulation, result.worst)}",
        "  last steps (t, dt, Newton iterations, residual):",
    ]
    lines += [
        f"    {end:.6g}{unit}  {end - begin:.3g}{unit}  {r.iterations:3d}  {r.residual_norm:.3g} N  "
        f"{r.status.name.lower()}"
        for begin, end, r in last
    ]
    advice = _STATIC_ADVICE.get(result.status, result.status.advice) if static else result.status.advice
    lines.append(f"  advice: {advice}")
    return "\n".join(lines)


def describe_runaway(simulation: Simulation, t: float, dt: float, energies: Mapping[str, float]) -> str:
    """What to say when a run makes energy out of nothing."""
    return "\n".join(
        (
            f"the motion blew up by t = {t:.6g} s with dt = {dt:.3g} s: "
            f"{energies['error']:.3g} J that nothing gave it",
            f"  {simulation.integrator.name} is unstable at this step: "
            "fast axial or bending modes grow without bound",
            f"  advice: {_calmer(simulation)}",
        )
    )


UNSTABLE = (
    "the last equilibrium is unstable: the least disturbance makes the robot buckle or snap away from it; "
    "--set numerics.newton.projection=indefinite goes on to a stable one, and a small force aside says which"
)


def describe_growth(simulation: Simulation, error: float, share: float) -> str:
    """What to say when a run ends with some energy that nothing gave it."""
    return (
        f"{error:.2g} J, {share:.0%} of all that the run held or turned into heat, came from nowhere: "
        f"{simulation.integrator.name} grows or goes astray at this step; {_calmer(simulation)}"
    )


def _calmer(simulation: Simulation) -> str:
    own = simulation.integrator
    stronger = [i.name for i in sorted(INTEGRATORS, key=lambda i: i.damping) if i.damping > own.damping]
    choice = f", or choose {' or '.join(stronger)}, which damp more" if stronger else ""
    return f"reduce numerics.dt{choice}"


def _where(simulation: Simulation, dof: int) -> str:
    dofs = simulation.model.dofs
    if dof < 0:
        return "no degree of freedom"
    text = dofs.describe(dof)
    if dof < dofs.n_positions and dof // dofs.dimension < dofs.visible:
        return f"{text} ({simulation.places[dof // dofs.dimension]})"
    return text
