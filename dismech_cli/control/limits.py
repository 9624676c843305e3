"""What an actuator can do."""

from __future__ import annotations

from math import inf
from typing import Final

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen


@frozen
class Limits:
    """Limits of a command, each place for itself.

    Attributes:
        magnitude: Greatest command, either way.
        change: Greatest change from sample to sample.
    """

    magnitude: float = inf
    change: float = inf

    def applied(self, wanted: FloatArray, before: FloatArray) -> FloatArray:
        """The command nearest to what is wanted, shape (n,)."""
        near = before + np.clip(wanted - before, -self.change, self.change)
        return np.clip(near, -self.magnitude, self.magnitude)


UNLIMITED: Final = Limits()
"""No limits."""
