"""Maps of all stages of a step as numbers: what they make of the states that the step went through."""

from __future__ import annotations

from typing import Final

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from .integrators import Integrator
from .stage import Weights
from .stage_maps import StageMaps


@frozen(eq=False)
class Maps:
    """The affine maps of the S stages of a step of some length.

    Attributes:
        slopes: Of the constant parts of q_s, v_s, a_s and of the velocity and acceleration at the end, each
            to q, v, a of the start of the step, then of the latest stage, shape (S, 5, 6).
        numbers: Weights of position, velocity and acceleration, slopes of velocity and acceleration at the
            end, and length of the stage [s], shape (S, 6).
        weights: The first three.
        balance: Times at which balance is enforced, from the start of the step [s].
        points: What q_s, v_s, a_s of all stages are made of: q, v, a of the start of the step and of the end
            of each stage, shape (3 S, 3 S + 3).
        at_ends: Whether all balances are where their stages end.
    """

    slopes: FloatArray
    numbers: FloatArray
    weights: tuple[Weights, ...]
    balance: tuple[float, ...]
    points: FloatArray
    at_ends: bool

    @property
    def stages(self) -> int:
        """How many."""
        return len(self.weights)


# Steps of a run have few lengths; the table begins anew before it grows.
_MADE: Final[dict[tuple[Integrator, float], Maps]] = {}
_MANY: Final = 64


def maps_of(integrator: Integrator, dt: float) -> Maps:
    """Those of a step of ``dt`` [s]; made once."""
    key = (integrator, dt)
    if key not in _MADE:
        if len(_MADE) >= _MANY:
            _MADE.clear()
        _MADE[key] = _made(integrator, dt)
    return _MADE[key]


def _made(integrator: Integrator, dt: float) -> Maps:
    found = StageMaps.of(integrator, dt)
    slopes, numbers = np.ascontiguousarray(found.vectors[:, 2:]), found.numbers
    stages = len(numbers)
    points = np.zeros((stages, 3, stages + 1, 3))
    for k in range(stages):
        points[k, :, 0] += slopes[k, :3, :3]
        points[k, :, k] += slopes[k, :3, 3:]
        points[k, :, k + 1, 0] += numbers[k, :3]
    return Maps(
        slopes,
        numbers,
        tuple(Weights(*some) for some in numbers[:, :3].tolist()),
        found.balance,
        points.reshape(3 * stages, -1),
        bool((numbers[:, 0] == 1.0).all()) and not slopes[:, 0].any(),
    )
