"""Stages that were solved: where they were in balance, one after another."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from typing import Final

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from ..model.state import State
from .integrators import Integrator
from .maps import Maps, maps_of
from .stage import Weights
from .tape import TapedStep


@frozen
class Solved:
    """C stages of steps of one length in a row, each with its solution.

    Attributes:
        maps: Of the stages of a step.
        points: Position, velocity and acceleration in balance, shape (C, 3, n).
        times: When that is [s].
        before: States that the stages start from; their frames are carried to the points.
        ends: States that they end in; the positions there are the solutions.
    """

    maps: Maps
    points: FloatArray
    times: tuple[float, ...]
    before: tuple[State, ...]
    ends: tuple[State, ...]

    @property
    def count(self) -> int:
        """How many."""
        return len(self.ends)

    @classmethod
    def of(cls, maps: Maps, trails: Sequence[Sequence[State]]) -> Solved:
        """Those of steps that went through some states: where each starts, and the end of each stage."""
        states = [x for state in chain.from_iterable(trails) for x in (state.q, state.v, state.a)]
        through = np.concatenate(states).reshape(len(trails), maps.points.shape[1], -1)
        return cls(
            maps,
            (maps.points @ through).reshape(-1, 3, through.shape[-1]),
            tuple([trail[0].law_time + t for trail in trails for t in maps.balance]),
            tuple([state for trail in trails for state in trail[:-1]]),
            tuple([state for trail in trails for state in trail[1:]]),
        )

    @classmethod
    def at(cls, state: State) -> Solved:
        """The balance of forces at a state, as it moves: a stage of no duration."""
        return cls(_STILL, np.stack((state.q, state.v, state.a))[None], (state.law_time,), (state,), (state,))


_STILL: Final = Maps(
    slopes=np.zeros((1, 5, 6)),
    numbers=np.array([[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]]),
    weights=(Weights(1.0, 0.0, 0.0),),
    balance=(0.0,),
    points=np.eye(3, 6, 3),
    at_ends=True,
)


def solved(integrator: Integrator, steps: Sequence[TapedStep]) -> Solved:
    """What was solved in some steps of one length, in order."""
    return Solved.of(maps_of(integrator, steps[0].dt), [step.result.trail for step in steps])
