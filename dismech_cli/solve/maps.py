"""Maps of integrators as numbers: what a stage takes of the states that it is made from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray
from ..model.state import State
from .integrators import Integrator
from .stage import Weights


@dataclass(frozen=True, slots=True)
class Maps:
    """The affine maps of a stage.

    Attributes:
        slopes: Of the constant parts of q_s, v_s, a_s and of the velocity and acceleration at the end, each
            to q, v, a of the start of the step, then of the latest stage, shape (5, 6).
        weights: Slopes of the stage to its unknown.
        v_end: Slope of the velocity at the end to it.
        a_end: That of the acceleration.
    """

    slopes: FloatArray
    weights: Weights
    v_end: float
    a_end: float

    @classmethod
    def of(cls, integrator: Integrator, start: State, index: int, dt: float) -> Maps:
        """Ask the integrator, with a unit in the place of each; the state may be any."""
        one, latest = (_units(start, first) for first in (0, 3 if index else 0))
        stage = integrator.stage(index, one, latest, dt)
        found = (stage.q0, stage.v0, stage.a0, stage.v_end[1], stage.a_end[1])
        return cls(np.stack(found), stage.weights, stage.v_end[0], stage.a_end[0])


def _units(state: State, first: int) -> State:
    q, v, a = np.eye(6)[first : first + 3]
    return State(state.t, q, v, a, state.frames, load=state.load)
