"""The slowest and the fastest swing of a scene, and what its integrator makes of them."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from ..kinematics.motion import held_dofs
from ..run.simulation import Simulation
from ..solve.linear.factors import FactorizationError
from ..solve.linear.modes import softest_modes
from ..solve.oscillator import respond
from ..solve.pattern import SparsityPattern
from ..solve.step import Stepper

# Beyond this many free DOFs modes take longer than a check should.
_MOST = 20_000
# Modes looked at: six are those of a free body.
_COUNT = 8
_ROUNDING = 1e-9
# Squares of frequencies below this share of the largest are rigid motions, rounded.
_RIGID = 1e-12


@frozen(kw_only=True)
class Modes:
    """Swings about the start as it is held and loaded then.

    Attributes:
        slowest: Period [s].
        fastest: Period [s].
        step: Time step [s]; None where steps adapt.
        kept: Share of the slowest swing that is left after its period; None without a step.
        late: By how much its period is too long, as a share; None likewise.
        kept_fastest: Share of the fastest swing that is left after a step; None likewise.
    """

    slowest: float
    fastest: float
    step: float | None
    kept: float | None
    late: float | None
    kept_fastest: float | None

    def __str__(self) -> str:
        told = f"modes at the start: periods from {self.slowest:.3g} s to {self.fastest:.3g} s"
        if self.step is None or self.kept is None or self.late is None or self.kept_fastest is None:
            return told
        lost = 1.0 - self.kept if self.kept < 1.0 - _ROUNDING else 0.0
        return (
            f"{told}; the slowest takes {self.slowest / self.step:.3g} steps, {100 * self.late:.2g} % too "
            f"long, and loses {100 * lost:.2g} % of its swing in a period; of the fastest "
            f"{100 * min(self.kept_fastest, 1.0):.2g} % is left after a step"
        )


def find_modes(simulation: Simulation, step: float | None) -> Modes | None:
    """The modes; None where there are none: statics, large scenes, stiffnesses that are not symmetric.

    Args:
        simulation: A scene ready to step.
        step: Its time step [s]; None where steps adapt.
    """
    model = simulation.model
    free = ~held_dofs(model.motions, model.dofs.n, 0.0)
    if not model.mass.any() or not 1 < np.count_nonzero(free) <= _MOST:
        return None
    stepper = Stepper(model, simulation.integrator, simulation.newton, simulation.linear_solver)
    state, pattern = stepper.prepare(simulation.start), stepper.system.pattern
    mass = model.mass[pattern.free]
    if not pattern.symmetric or not (mass > 0.0).all():
        return None
    values = stepper.stability.stiffness(state)
    with np.errstate(all="ignore"):
        try:
            largest = _largest(pattern, values, mass)
            sizes, _ = softest_modes(pattern, stepper.system.solver, values.copy(), mass, _COUNT)
        except FactorizationError:
            return None
    swings = sizes[sizes > _RIGID * largest]
    if not swings.size or not largest > 0.0:
        return None
    slow, fast = sqrt(float(swings[0])), sqrt(largest)
    if step is None:
        return Modes(
            slowest=2 * pi / slow, fastest=2 * pi / fast, step=None, kept=None, late=None, kept_fastest=None
        )
    response = respond(simulation.integrator, slow * step)
    steps = 2.0 * pi / (slow * step)
    return Modes(
        slowest=2 * pi / slow,
        fastest=2 * pi / fast,
        step=step,
        kept=min(response.kept**steps, 1.0),
        late=slow * step / response.turned - 1.0 if response.turned > 0.0 else float("inf"),
        kept_fastest=respond(simulation.integrator, fast * step).kept,
    )


def _largest(pattern: SparsityPattern, values: FloatArray, mass: FloatArray) -> float:
    """The largest eigenvalue of K x = mu M x."""
    from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

    root = np.sqrt(mass)
    operator = LinearOperator(
        (pattern.m, pattern.m),
        matvec=lambda x: pattern.product(values, np.ravel(x) / root) / root,
        dtype=np.float64,
    )
    start = np.random.default_rng(0).standard_normal(pattern.m)
    try:
        found = eigsh(operator, k=1, which="LA", v0=start, tol=1e-3, return_eigenvectors=False)
    except ArpackError as error:
        raise FactorizationError(str(error)) from error
    return float(found[0])
