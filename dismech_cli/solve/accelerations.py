"""Accelerations that a step starts from, where the last step does not leave the right ones."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from ..arrays import FloatArray
from ..kinematics.motion import Since
from ..model.state import State
from .integrators import ImplicitEuler
from .newton import solve_stage
from .predictor import Predictor
from .problem import NewtonSettings, StageProblem
from .stage import at_state
from .status import Status
from .system import System

LENGTH: Final = "step.length"
"""What a step leaves of its own length [s]."""

SAME: Final = 1e-6
"""By how much lengths of steps may differ by rounding, as a part."""
EULER: Final = ImplicitEuler()
"""Finds what friction leaves."""


def balanced(system: System, state: State) -> FloatArray:
    """A = -M^-1 r(q, v) on the free DOFs: a wrong start costs Newmark its second order."""
    r = system.linearize(at_state(state), state.q, state.frames).residual
    free = system.pattern.free
    mass = system.model.mass
    movable = free[mass[free] > 0.0]
    a = np.zeros(len(state.q))
    a[movable] = -r[movable] / mass[movable]
    return a


def rescaled(system: System, start: State, dt: float) -> State:
    """A start whose acceleration is that of a step of another length.

    Generalised-alpha passes a part of what an impact changes on to later steps, as an acceleration that
    the forces do not explain. It stands for a change of velocity over a step: over a longer one it is
    less, or steps that grow after an impact would make energy.
    """
    if LENGTH not in start.memory:
        return start
    ratio = float(start.memory[LENGTH][0]) / dt
    if abs(ratio - 1.0) < SAME:
        return start
    explained = balanced(system, start)
    free = system.pattern.free
    a = start.a.copy()
    a[free] = explained[free] + ratio * (start.a - explained)[free]
    return replace(start, a=a)


def rubbed(system: System, predictor: Predictor, start: State, dt: float, settings: NewtonSettings) -> State:
    """A start with the acceleration that friction leaves it.

    Friction is nought at rest and full at a slip that is reached within a small part of a step. The
    mean acceleration of a step of Euler's method has it in; it is off by a step's worth of the jerk,
    which costs no order of accuracy.
    """
    if not any(term.velocity_dependent for term in system.model.changing):
        return start
    stage = EULER.stage(0, start, start, dt)
    problem = StageProblem(system, stage, start.frames, settings)
    guess = next(iter(predictor.guesses(problem, Since(start.t, start.q, start.frames))))
    result = solve_stage(problem, problem.reachable(start.q, guess))
    if result.status is not Status.CONVERGED:
        return start
    a = start.a.copy()
    free = system.pattern.free
    a[free] = (stage.finish(result.q)[0] - start.v)[free] / dt
    return replace(start, a=a)
