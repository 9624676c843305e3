"""Balances at rest that rounding only pretends.

Newton's method takes a residual for small that the rounding of positions explains: so much stiff
stretching hides. It hides the loads as well where rods are cut into so many edges that bending forces of
one edge, E I / l^3, round by more than what bends the whole. Energies do not cancel like that: along the
way that a run has gone, the slope of the potential tells whether the loads did the work that the robot
holds.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from ..arrays import FloatArray
from ..model.configuration import Configuration
from ..model.state import State
from ..solve.stage import at_state
from ..solve.system import System

# Part of the way over which a slope is taken, and the share of that at the start which may be left at the
# end.
_PART: Final = 1e-6
_LEFT: Final = 0.05


def rounded_away(system: System, start: State, end: State) -> bool:
    """Whether what loads a robot at rest is lost in rounding.

    Args:
        system: Its equations.
        start: Where a static run started.
        end: Where it ended.
    """
    stage, free = at_state(end), system.pattern.free
    floor = system.round_off(system.linearize(stage, end.q, end.frames).values, end.q)
    # what is held is where it ends: moving it is a load too
    held = end.q.copy()
    held[free] = start.q[free]
    with np.errstate(all="ignore"):  # which may crush what is beside it: no small load
        load = system.residual(stage, held, start.frames)[free]
        pushed = _pushed(system, system.configuration(stage, held, start.frames))[free]
    # where nothing pushes, what is left is rounding itself
    if not 0.0 < float(np.linalg.norm(pushed)) < floor or not float(np.linalg.norm(load)) < floor:
        return False
    way = np.zeros_like(end.q)
    way[free] = (end.q - start.q)[free]
    before = float(load @ way[free])
    (up, _), (down, _) = (system.potential(stage, end.q + part * way, end.frames) for part in (_PART, -_PART))
    _, rest = system.potential(stage, end.q, end.frames)
    after = (up - down) / (2.0 * _PART) + float(rest @ way)
    return not abs(after) <= _LEFT * abs(before)


def _pushed(system: System, c: Configuration) -> FloatArray:
    """The residual of loads alone, of those that push and of those that have a potential, shape (n,)."""
    pushed = np.zeros_like(c.q)
    for bound in system.terms:
        if bound.potential is None:
            bound.add_residual(c, pushed)
    for term in system.model.terms:
        if (
            not term.couplings
            and (bound := term.bind(system.pattern, system.model.driver)).potential is not None
        ):
            bound.add_residual(c, pushed)
    return pushed
