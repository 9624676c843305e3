"""How long a run takes: from its steps, and from what an iteration takes here, which is measured."""

from __future__ import annotations

import time
from contextlib import suppress
from typing import Final

from ..compose.compose import Composition
from ..compose.price import Work
from ..compose.structure.plan import Bending
from ..control.loop import UNCONTROLLED
from ..kinematics.motion import held_dofs
from ..run.simulation import Simulation
from ..scenario.language.numerics import Numerics, Static
from ..solve.linear.factors import FactorizationError
from ..solve.stage import at_state
from ..solve.system import System

# Calibrated on the gallery, `python -m benchmarks check_times`: products, checks and searches of an iteration
# in units of its assembly and factors; of those of contact, what rods and shells that touch add [s].
_ALL, _RODS, _SHELLS = 1.85, 1.1e-3, 4.0e-3
# What a step takes besides [s], more than the rough price says.
_STEP = 0.1e-3
# Iterations of a step that touches; what the rough price says too many of in one that does not.
_OF_CONTACT, _SMOOTH = 2.3, 0.85
# Paths of equilibria come to their end after such a share of the steps that they may take.
_PATH: Final = 0.28
_LOOKS: Final = 3
# Degrees of freedom of models that are not analysed for a look.
_LARGE: Final = 20_000
# A look at a model this large is enough [s].
_LONG: Final = 0.3


def work_of(composition: Composition, numerics: Numerics) -> Work:
    """What a run has to do.

    Args:
        composition: What would be run.
        numerics: Of its scenario.
    """
    simulation = composition.simulation
    follows = isinstance(numerics.integrator, Static) and numerics.integrator.path is not None
    return Work.of(
        numerics,
        composition.geometry,
        touching=bool(simulation.model.changing),
        framed=composition.plan.bending is Bending.FRAMED,
        controlled=simulation.controls is not UNCONTROLLED,
        steps=simulation.control.steps * (_PATH if follows else 1.0),
    )


def iteration_time(simulation: Simulation) -> float:
    """CPU time to assemble and factorize the start, the least of some looks [s]; 0 of what is large."""
    model, state = simulation.model, simulation.start
    if model.dofs.n > _LARGE:
        return 0.0
    system = System(model, ~held_dofs(model.motions, model.dofs.n, state.t), simulation.linear_solver)
    system.recall(state)
    least = float("inf")
    for look in range(_LOOKS):
        began = time.process_time()
        now = system.linearize(at_state(state), state.q, state.frames)
        # what is free to move takes as long
        with suppress(FactorizationError):
            system.solver.factorize(now.values).solve(now.residual[system.pattern.free])
        least = min(least, time.process_time() - began)
        # the first look may compile
        if look and least > _LONG:
            break
    return least


def seconds(work: Work, kernels: str, iteration: float, *, whole: bool = False) -> float:
    """Rough time of a run [s].

    Args:
        work: What it has to do.
        kernels: What runs them: ``numpy`` or ``numba``.
        iteration: Time to assemble and factorize, call by call [s].
        whole: Whether steps are compiled whole: then a look at an iteration says nothing of them.
    """
    price = work.seconds(kernels, whole=whole)
    if whole:
        return price
    if not work.touching:
        return work.steps * _STEP + max(_SMOOTH * price, work.steps * work.iterations * _ALL * iteration)
    each = _ALL * iteration + (_SHELLS if work.triangles else _RODS)
    return max(price, work.steps * _OF_CONTACT * each)
