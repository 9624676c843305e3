"""Trial points, and the last of them kept: contact asks for the ends of a step again and again."""

from __future__ import annotations

from typing import Final

from ..arrays import FloatArray
from ..frozen import frozen
from ..kinematics.rod_frames import FrameState
from ..model.configuration import Configuration
from ..model.model import Model
from ..model.state import State
from .stage import Stage

# The start of a step, an iterate and the next one.
_KEPT: Final = 3


def trial(model: Model, stage: Stage, q: FloatArray, stored: FrameState) -> Configuration:
    """The trial point of a stage at its unknown (n,), with frames from the stored ones."""
    position = stage.position(q)
    frames = model.frames.transport(stored, position)
    return Configuration(stage.t_stage, position, stage.velocity(q), frames, stage.inputs)


def at(model: Model, state: State) -> Configuration:
    """A state as a trial point."""
    frames = model.frames.transport(state.frames, state.q)
    return Configuration(state.law_time, state.q, state.v, frames, state.inputs)


@frozen
class _Trial:
    stage: Stage
    key: bytes
    stored: FrameState
    made: Configuration


class Trials:
    """Makes trial points; those asked for last it has."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._trials: list[_Trial] = []
        self._states: list[tuple[State, Configuration]] = []

    def trial(self, stage: Stage, q: FloatArray, stored: FrameState) -> Configuration:
        """See :func:`trial`."""
        # the bytes: whoever asks goes on to change q
        key = q.tobytes()
        for one in self._trials:
            if one.stage is stage and one.stored is stored and one.key == key:
                return one.made
        made = trial(self._model, stage, q, stored)
        self._trials = [*self._trials[1 - _KEPT :], _Trial(stage, key, stored, made)]
        return made

    def at(self, state: State) -> Configuration:
        """See :func:`at`."""
        for one, made in self._states:
            if one is state:
                return made
        made = at(self._model, state)
        self._states = [*self._states[1 - _KEPT :], (state, made)]
        return made
