"""Controllers differentiated: what they put in between steps, at neighbouring values and states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...control.loop import UNCONTROLLED
from ...model.state import State
from ...run.simulation import Simulation
from ...solve.commanded import Acting, nothing_acts
from ...solve.neighbours import Variation
from .nearby import Nearby
from .reading import turned


def acting_of(simulation: Simulation, near: Sequence[Nearby]) -> Acting:
    """How the controllers of a run, if any, answer to changes of each parameter and of the state."""
    return nothing_acts if simulation.controls is UNCONTROLLED else Controllers(simulation, near)


class Controllers:
    """The loops of a run: a map from a state to inputs and memory, which needs nothing else of the run.

    Its derivative is that of the map as it is: a limit that holds a command holds its derivative too, and
    what is in the ring of a late sensor is differentiated when it arrives.
    """

    def __init__(self, simulation: Simulation, near: Sequence[Nearby]) -> None:
        self._simulation, self._near = simulation, near

    def __call__(self, before: State, d: Variation, until: float) -> Variation:
        """The derivative with what is put in and remembered for a step to a time [s]."""
        controls = self._simulation.controls
        if controls.act(before, until) is before:
            return d
        inputs = np.zeros_like(d.inputs)
        memory = {name: np.zeros_like(values) for name, values in d.memory.items()}
        for k, one in enumerate(self._near):
            acted = self._acted(before, d, k, one, until)
            inputs[:, k] = one.neighbours.slope([state.inputs for state in acted])
            for name, slope in memory.items():
                slope[..., k] = one.neighbours.slope([np.asarray(state.memory[name]) for state in acted])
        return replace(d, inputs=inputs, memory=memory)

    def _acted(self, before: State, d: Variation, k: int, one: Nearby, until: float) -> list[State]:
        """What becomes of the state of each neighbour of a parameter."""
        step, states = one.setting.step, []
        for offset, other in zip(one.difference.offsets, one.simulations, strict=True):
            there = turned(self._simulation.model, before, d, k, offset * step)
            states.append(other.controls.act(there, until))
        return states
