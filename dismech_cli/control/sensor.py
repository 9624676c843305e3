"""Sensors: what is so, as it is read, with noise and late."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from ..model.state import State
from .controller import Memory
from .noise import Noise


class Reading(Protocol):
    """What is so at a state."""

    @property
    def size(self) -> int:
        """Number of values."""

    def __call__(self, state: State) -> FloatArray:
        """The values, shape (size,)."""


@frozen
class Sensor:
    """A sensor that is asked once per period.

    Attributes:
        name: Its name.
        reading: What is so.
        noise: Added to it, or None.
        late: Samples until a reading arrives.
    """

    name: str
    reading: Reading
    noise: Noise | None = None
    late: int = 0

    def start(self) -> Memory:
        """Readings on their way before the first sample: none, which is marked by NaN."""
        if not self.late:
            return {}
        return {f"{self.name}.late": np.full((self.late, self.reading.size), np.nan)}

    def read(self, state: State, sample: int, memory: Memory) -> tuple[FloatArray, Memory]:
        """What arrives at a sample, shape (size,), and what is on its way then.

        Until the first reading arrives it stands for those before it.
        """
        values = self.reading(state)
        if self.noise is not None:
            values = values + self.noise.at(sample, self.reading.size)
        if not self.late:
            return values, {}
        key = f"{self.name}.late"
        before = memory[key]
        waiting = np.concatenate((np.where(np.isnan(before), values, before), values[None]))
        return waiting[0], {key: waiting[1:]}
