"""What to tell when a run goes wrong: what, where, when, what was tried, what to do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from typing import NamedTuple

import numpy as np

from ..frozen import frozen
from ..model.state import State
from ..solve.integrators import INTEGRATORS, Integrator, Static
from ..solve.path import PathFollower
from ..solve.problem import exact
from ..solve.relax import relaxed
from ..solve.status import Status
from ..solve.step import through_stages
from ..solve.step_result import StepResult
from .ambiguity import Ambiguity
from .observables.snapshot import Snapshot
from .simulation import Simulation
from .symmetry import Found


class Attempt(NamedTuple):
    """What is told of a step; no more, for arrays that are kept for a while cost more than the loop.

    Attributes:
        start: Its start [s].
        end: Where it was to end [s].
        status: How it ended.
        iterations: Linear solves.
        residual_norm: Largest free residual [N].
        worst: DOF with the largest residual, or -1.
    """

    start: float
    end: float
    status: Status
    iterations: int
    residual_norm: float
    worst: int

    @classmethod
    def of(cls, start: float, end: float, result: StepResult) -> Attempt:
        """Of a result."""
        return cls(start, end, result.status, result.iterations, result.residual_norm, result.worst)


@frozen
class Failure:
    """Why a run ends before its time.

    Attributes:
        message: One or more lines for the user.
        remedy: A change of the scenario that may help, as ``KEY=VALUE``; empty if none is known.
    """

    message: str
    remedy: str = ""


# Where the time of a run is the share of its loads, steps are load steps.
_STATIC_ADVICE: Mapping[Status, str] = {
    Status.MAX_ITERATIONS: (
        "the next equilibrium is far away: raise integrator.load_steps or numerics.newton.max_iterations"
    ),
    Status.NOT_FINITE: "an edge folded back on itself or collapsed: raise integrator.load_steps",
    Status.LINE_SEARCH_FAILED: (
        "no step lowers the energy: the load is near a fold or snap-through; integrator.path follows the "
        "equilibria through it"
    ),
}
_STATIC_CUT_ADVICE: Mapping[Status, str] = {
    Status.MAX_ITERATIONS: "the next equilibrium is far away: raise numerics.newton.max_iterations",
    Status.LINE_SEARCH_FAILED: _STATIC_ADVICE[Status.LINE_SEARCH_FAILED],
}
# A path finds its own steps, up to the largest.
_SMALLER = "let steps be smaller from the start: numerics.integrator.path.first and largest"
_PATH_ADVICE: Mapping[Status, str] = {
    **dict.fromkeys(
        (Status.MAX_ITERATIONS, Status.LINE_SEARCH_FAILED, Status.TURNED, Status.BRANCHED), _SMALLER
    ),
    Status.NOT_FINITE: f"an edge folded back on itself or collapsed: {_SMALLER}",
    Status.FACTORIZATION_FAILED: (
        "the stiffness is singular where the path stands: a part is free to move without resistance, or a "
        "bifurcation is met head-on, which a small imperfection avoids"
    ),
}
_BREAKS_OFF = (
    "the path breaks off here: look at what is crushed, locks or comes to touch, and at the loads and "
    "motions as functions of the load factor"
)
_PATH_CUT_ADVICE: Mapping[Status, str] = {
    Status.TURNED: (
        "the path of equilibria has a corner or ends here: look at what locks, folds or comes to touch"
    ),
    Status.BRANCHED: (
        "another branch leaves the path at once: give the robot a small imperfection, which chooses one"
    ),
    Status.MAX_ITERATIONS: _BREAKS_OFF,
    Status.LINE_SEARCH_FAILED: _BREAKS_OFF,
    Status.NOT_FINITE: "an edge there folded back on itself or collapsed: look at what acts on it",
    Status.FACTORIZATION_FAILED: _PATH_ADVICE[Status.FACTORIZATION_FAILED],
}
# Failures of Newton's method that damped motion to rest does not share, and how to ask for it.
_RELAXED_AWAY = (Status.MAX_ITERATIONS, Status.LINE_SEARCH_FAILED)
_RELAX = "numerics.integrator.method=relax"
# Where shorter steps have been tried already.
_CUT_ADVICE: Mapping[Status, str] = {
    Status.MAX_ITERATIONS: "look at what is crushed, very stiff or thin there, or apply loads more slowly",
    Status.NOT_FINITE: (
        "an edge there folded back on itself or collapsed: look at the loads and motions on it, "
        "or apply them more slowly"
    ),
    Status.LINE_SEARCH_FAILED: (
        "no step lowers the energy: the state is near a fold that this integrator does not pass"
    ),
}


def describe_failure(simulation: Simulation, last: Sequence[Attempt], *, cut: bool) -> Failure:
    """Several lines that a user can act on, about the last of some attempts.

    Args:
        simulation: What is run.
        last: The attempts.
        cut: Whether shorter steps have been tried.
    """
    result = last[-1]
    start, t = result.start, result.end
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
        f"    {r.end:.6g}{unit}  {r.end - r.start:.3g}{unit}  {r.iterations:3d}  {r.residual_norm:.3g} N  "
        f"{r.status.name.lower()}"
        for r in last
    ]
    if cut:
        lines.append(f"  tried: halving the step down to {t - start:.3g}{unit} did not help")
    remedy = ""
    advice = _advice(simulation, result.status, cut=cut)
    if static and result.status in _RELAXED_AWAY and simulation.advance is through_stages:
        advice += "; or let the robot move to rest, which nets, thin shells and slack strings need: " + _RELAX
        remedy = _RELAX
    lines.append(f"  advice: {advice}")
    if not static:
        remedy = _stronger(simulation) if cut else simulation.control.shorter(t - start)
    return Failure("\n".join(lines), remedy)


def _advice(simulation: Simulation, status: Status, *, cut: bool) -> str:
    """What to do about a failed solve that has not been tried, and that applies."""
    tables: list[Mapping[Status, str]] = [_CUT_ADVICE] if cut else []
    if isinstance(simulation.integrator, Static):
        tables.append(_STATIC_CUT_ADVICE if cut else _STATIC_ADVICE)
    if isinstance(simulation.advance, PathFollower):
        tables.append(_PATH_CUT_ADVICE if cut else _PATH_ADVICE)
    found = [table[status] for table in tables if status in table]
    return found[-1] if found else status.advice


def describe_rounded(simulation: Simulation, state: State) -> Failure:
    """What to say when the loads of a robot at rest are lost in rounding."""
    model = simulation.model
    return Failure(
        f"the solver gave up at t = {state.t:.6g} of the load: lost in rounding\n"
        f"  {model.dofs.n} degrees of freedom: forces between neighbours round by more than the loads that "
        f"bend "
        "the whole, which hardly moved\n"
        "  advice: take a coarser mesh, of at most some 1000 edges per rod that bends as a whole, or let it "
        "come "
        "to rest in time"
    )


def describe_runaway(simulation: Simulation, shown: Snapshot, dt: float) -> Failure:
    """What to say when a run makes energy out of nothing, seen after a step of ``dt`` [s]."""
    message = "\n".join(
        (
            f"the motion blew up by t = {shown.state.t:.6g} s with dt = {dt:.3g} s: "
            f"{shown.energies['error']:.3g} J that nothing gave it",
            f"  fastest at {_where(simulation, int(np.abs(shown.state.v).argmax()))}",
            f"  {simulation.integrator.name} is unstable at this step: "
            "fast axial or bending modes grow without bound",
            f"  advice: {_calmer(simulation)}",
        )
    )
    return Failure(message, _stronger(simulation) or simulation.control.shorter(dt))


def describe_infinite(simulation: Simulation, shown: Snapshot, dt: float) -> Failure:
    """What to say when an energy is no number, seen after a step of ``dt`` [s]; 0 before the first."""
    s, static = shown.state, isinstance(simulation.integrator, Static)
    names = ", ".join(name for name in ("kinetic", "elastic", "gravitational") if not _known(shown, name))
    moved = np.abs(s.q - simulation.model.rest)
    at = f"t = {s.t:.6g}{'' if static else ' s'}"
    lines = [
        f"the {names or 'account of'} energy is infinite or not a number at {at}: no frame is written",
        f"  farthest from rest: {_where(simulation, int(moved.argmax()))}, moved by {moved.max():.3g}",
    ]
    if not dt:
        lines.append(
            "  advice: the scene is so from the start: look at sizes, stiffnesses and natural strains"
        )
        return Failure("\n".join(lines))
    lines.append(
        "  the last step ended in a balance that is none: an edge folded back on itself or collapsed"
    )
    if static:
        path = isinstance(simulation.advance, PathFollower)
        lines.append(f"  advice: {_SMALLER if path else 'raise integrator.load_steps'}")
        return Failure("\n".join(lines))
    lines.append(f"  advice: {_calmer(simulation)}, or apply the loads more slowly")
    return Failure("\n".join(lines), simulation.control.shorter(dt))


def describe_unstable(simulation: Simulation, state: State) -> str:
    """What to say when statics end where the least disturbance would make the robot move away."""
    if state.load is not None:
        return (
            "the path ends in an unstable equilibrium: under a load that is given the robot would snap away "
            "from it"
        )
    told = "the last equilibrium is unstable: the least disturbance makes the robot buckle or snap away; "
    if simulation.newton.factorize is exact and simulation.advance is not relaxed:
        return (
            f"{told}numerics.newton.projection=indefinite goes on to a stable one, where a small force aside "
            "or an imperfection says which"
        )
    return (
        f"{told}it is perfectly straight, round, flat or planar, and nothing says which way to go: a small "
        f"force aside does, or {_deviation(simulation)}"
    )


def _deviation(simulation: Simulation) -> str:
    """The line that gives a robot a small imperfection."""
    extent = float(np.ptp(simulation.model.dofs.positions(simulation.model.rest), axis=0).max())
    return f"--set 'imperfection={{amplitude: {1e-3 * extent:.1g} m}}'"


def describe_symmetry(simulation: Simulation, found: Found) -> str:
    """What to say when a run stays in an unstable balance that nothing disturbs."""
    ways = "1 way" if found.modes == 1 else f"{found.modes} ways"
    return (
        f"at t = {found.t:.4g} s the robot was in an unstable balance, in {ways} that nothing moved it: "
        "perfectly straight, round, flat or planar, it stays so where a real one buckles, within about "
        f"{1.0 / found.rate:.2g} s; let it deviate: {_deviation(simulation)}"
    )


def describe_ambiguity(simulation: Simulation, ambiguity: Ambiguity) -> str:
    """What to say when steps had more than one solution, as where something buckles, and were not cut."""
    first = f"to t = {ambiguity.first:.4g} s"
    which = f"the step {first}" if ambiguity.steps == 1 else f"{ambiguity.steps} steps, the first {first},"
    return (
        f"{which} had more than one solution, as where something thin snaps or buckles, and could not be "
        f"cut: one of them was taken; {simulation.control.finer}, or {simulation.control.calmer}"
    )


def describe_growth(simulation: Simulation, error: float, share: float) -> str:
    """What to say when a run ends with some energy that nothing gave it."""
    return (
        f"{error:.2g} J, {share:.0%} of all that the run held or turned into heat, came from nowhere: "
        f"{simulation.integrator.name} grows or goes astray at this step; {_calmer(simulation)}"
    )


def describe_singular(simulation: Simulation, t: float, dof: int, error: ArithmeticError) -> str:
    """What to say when the negative eigenvalues cannot be counted; ``dof`` is the one to look at."""
    return (
        f"negative_eigenvalues has no value (NaN) at t = {t:.6g}: {error}; "
        f"look at {_where(simulation, dof)}: a part is free to move without resistance, or a stiffness is "
        "out of range"
    )


def _known(shown: Snapshot, name: str) -> bool:
    return isfinite(shown.energies[name])


def _calmer(simulation: Simulation) -> str:
    stronger = [i.name for i in _damping_more(simulation)]
    choice = f", or choose {' or '.join(stronger)}, which damp more" if stronger else ""
    return f"{simulation.control.calmer}{choice}"


def _damping_more(simulation: Simulation) -> list[Integrator]:
    own = simulation.integrator
    return [i for i in sorted(INTEGRATORS, key=lambda i: i.damping) if i.damping > own.damping]


def _stronger(simulation: Simulation) -> str:
    """The change to what damps more, the most accurate of them; empty if nothing does."""
    stronger = max(_damping_more(simulation), key=lambda i: (i.order, i.damping), default=None)
    return f"numerics.integrator={{type: {stronger.name}}}" if stronger else ""


def _where(simulation: Simulation, dof: int) -> str:
    dofs = simulation.model.dofs
    if dof < 0:
        return "no degree of freedom"
    text = dofs.describe(dof)
    if dof < dofs.n_positions and dof // dofs.dimension < dofs.visible:
        return f"{text} ({simulation.places[dof // dofs.dimension]})"
    return text
