"""Stages as numbers: what an integrator's affine maps do to unit vectors, for steps of one length."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..kinematics.rod_frames import FrameState
from ..model.state import State
from .integrators import Integrator

_NOTHING = np.empty(0)
_NO_FRAMES = FrameState(_NOTHING, _NOTHING, _NOTHING)


@frozen(eq=False)
class StageMaps:
    """The maps of all S stages of a step of one length.

    Attributes:
        dt: Length of the step [s].
        vectors: Predictor, lead, q0, v0, a0, and the constants of velocity and acceleration at the end of
            each stage, as sums of q, v and a at the start of the step and at the end of the stage before,
            shape (S, 7, 6).
        numbers: Weights of position, velocity and acceleration, slopes of velocity and acceleration at the
            end, and length [s] of each stage, shape (S, 6).
        balance: Times at which balance is enforced, from the start of the step [s].
        ends: Times of the ends of the stages, likewise [s].
        leads: Whether guesses go on by a share of a lead.
        balanced_end: Whether the end of the step is where the last stage is in balance.
    """

    dt: float
    vectors: FloatArray
    numbers: FloatArray
    balance: tuple[float, ...]
    ends: tuple[float, ...]
    leads: bool
    balanced_end: bool

    @classmethod
    def of(cls, integrator: Integrator, dt: float) -> StageMaps:
        """Ask an integrator, whose maps know no formula but its own."""
        unit = np.eye(6)
        start = State(0.0, unit[0], unit[1], unit[2], _NO_FRAMES)
        t, vectors, numbers, balance, ends, leads = 0.0, [], [], [], [], False
        for index in range(integrator.stages):
            latest = State(t, unit[3], unit[4], unit[5], _NO_FRAMES)
            stage = integrator.stage(index, start, latest, dt)
            lead = np.zeros(6) if stage.lead is None else stage.lead
            leads = leads or stage.lead is not None
            vectors.append(
                (stage.predictor, lead, stage.q0, stage.v0, stage.a0, stage.v_end[1], stage.a_end[1])
            )
            w = stage.weights
            numbers.append((w.q, w.v, w.a, stage.v_end[0], stage.a_end[0], stage.t_end - t))
            balance.append(stage.t_stage)
            ends.append(stage.t_end)
            t = stage.t_end
        maps = np.array(vectors), np.array(numbers)
        return cls(dt, *maps, tuple(balance), tuple(ends), leads, stage.balanced_end)


@lru_cache(maxsize=64)
def stacked(steps: tuple[StageMaps, ...]) -> tuple[FloatArray, FloatArray, FloatArray, IntArray]:
    """Maps of steps, of which many are alike.

    Returns:
        Vectors, numbers and length of each kind of step, and the kind of each step.
    """
    kinds = list({id(maps): maps for maps in steps}.values())
    places = {id(maps): place for place, maps in enumerate(kinds)}
    return (
        np.array([maps.vectors for maps in kinds]),
        np.array([maps.numbers for maps in kinds]),
        np.array([maps.dt for maps in kinds]),
        np.array([places[id(maps)] for maps in steps]),
    )
