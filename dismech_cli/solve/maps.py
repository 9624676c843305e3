"""Maps of a stage as numbers, and the stage that they make of the states before it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from ..arrays import FloatArray
from ..model.state import State
from .integrators import Integrator
from .stage import Stage, Weights
from .stage_maps import StageMaps


@dataclass(frozen=True, slots=True, eq=False)
class Maps:
    """The affine maps of a stage of a step of some length.

    Attributes:
        slopes: Of the constant parts of q_s, v_s, a_s and of the velocity and acceleration at the end, each
            to q, v, a of the start of the step, then of the latest stage, shape (5, 6).
        numbers: Weights of position, velocity and acceleration, slopes of velocity and acceleration at the
            end, and length of the stage [s].
        weights: The first three.
        balance: Time at which balance is enforced, from the start of the step [s].
    """

    slopes: FloatArray
    numbers: tuple[float, ...]
    weights: Weights
    balance: float

    def stage(self, start: State, before: State, end: State) -> Stage:
        """The stage that led from a state to another, in a step from ``start``."""
        states = np.concatenate((start.q, start.v, start.a, before.q, before.v, before.a))
        q0, v0, a0, velocity, acceleration = self.slopes @ states.reshape(6, -1)
        by_v, by_a = self.numbers[3:5]
        return Stage(
            t_stage=start.law_time + self.balance,
            t_end=end.t,
            predictor=end.q,
            weights=self.weights,
            q0=q0,
            v0=v0,
            a0=a0,
            v_end=(by_v, velocity),
            a_end=(by_a, acceleration),
            inputs=start.inputs,
        )


# Steps of a run have few lengths; the table begins anew before it grows.
_MADE: Final[dict[tuple[Integrator, float], tuple[Maps, ...]]] = {}
_MANY: Final = 64


def maps_of(integrator: Integrator, dt: float) -> tuple[Maps, ...]:
    """Those of all stages of a step of ``dt`` [s]; made once."""
    key = (integrator, dt)
    if key not in _MADE:
        if len(_MADE) >= _MANY:
            _MADE.clear()
        _MADE[key] = _made(integrator, dt)
    return _MADE[key]


def _made(integrator: Integrator, dt: float) -> tuple[Maps, ...]:
    found = StageMaps.of(integrator, dt)
    return tuple(
        Maps(np.ascontiguousarray(vectors[2:]), tuple(numbers), Weights(*numbers[:3]), balance)
        for vectors, numbers, balance in zip(
            found.vectors, found.numbers.tolist(), found.balance, strict=True
        )
    )
