"""What to tell when the solver gives up: what, where, when, the last steps, what to do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

from ..solve.integrators import INTEGRATORS
from ..solve.step import StepResult
from .simulation import Simulation

Attempt: TypeAlias = tuple[float, float, StepResult]
"""Start and end of a step [s], and what came of it."""


def describe_failure(simulation: Simulation, last: Sequence[Attempt]) -> str:
    """Several lines that a user can act on, about the last of some attempts."""
    start, t, result = last[-1]
    dt, what = t - start, result.status.name.lower().replace("_", " ")
    lines = [
        f"the solver gave up at t = {t:.6g} s with dt = {dt:.3g} s: {what}",
        f"  largest residual {result.residual_norm:.3g} N at {_where(simulation, result.worst)}",
        "  last steps (t, dt, Newton iterations, residual):",
    ]
    lines += [
        f"    {end:.6g} s  {end - begin:.3g} s  {r.iterations:3d}  {r.residual_norm:.3g} N  "
        f"{r.status.name.lower()}"
        for begin, end, r in last
    ]
    lines.append(f"  advice: {result.status.advice}")
    return "\n".join(lines)


def describe_runaway(simulation: Simulation, t: float, dt: float, energies: Mapping[str, float]) -> str:
    """What to say when a run makes energy out of nothing."""
    own = simulation.integrator
    stronger = [i.name for i in sorted(INTEGRATORS, key=lambda i: i.damping) if i.damping > own.damping]
    choice = f", or choose {' or '.join(stronger)}, which damp more" if stronger else ""
    return "\n".join(
        (
            f"the motion blew up by t = {t:.6g} s with dt = {dt:.3g} s: "
            f"{energies['error']:.3g} J that nothing gave it",
            f"  {own.name} is unstable at this step: fast axial or bending modes grow without bound",
            f"  advice: reduce numerics.dt{choice}",
        )
    )


def _where(simulation: Simulation, dof: int) -> str:
    dofs = simulation.model.dofs
    if dof < 0:
        return "no degree of freedom"
    text = dofs.describe(dof)
    if dof < dofs.n_positions and dof // dofs.dimension < dofs.visible:
        return f"{text} ({simulation.places[dof // dofs.dimension]})"
    return text
