"""Signals: what a natural strain or a load follows."""

from __future__ import annotations

from typing import Final, Protocol, TypeAlias

import numpy as np

from ..arrays import FloatArray

Value: TypeAlias = FloatArray | float

NO_INPUTS: Final[FloatArray] = np.empty(0)
"""The inputs of a system that nothing controls: one array for all, never written to."""
NO_INPUTS.flags.writeable = False


def no_inputs() -> FloatArray:
    """The one array of no inputs, as a default."""
    return NO_INPUTS


class Signal(Protocol):
    """A value over time t [s], inputs and places: every law of time is one, which ignores the inputs."""

    @property
    def constant(self) -> bool:
        """True if the value never changes, whatever the time and the inputs."""

    def value(self, t: float, inputs: FloatArray, places: Value = 0.0) -> Value:
        """The value at ``t``: a float, or an array of the shape of ``places`` if that is an array.

        Args:
            t: Time [s].
            inputs: What the controllers of the system put in, shape (K,).
            places: Where, 0 to 1 along a rod.
        """
