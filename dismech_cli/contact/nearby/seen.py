"""Pairs that were looked at."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen


@frozen
class Seen:
    """Pairs that may be near at some places of the nodes.

    Attributes:
        x: The nodes [m], shape (N, 3).
        keys: Of the pairs, ascending, shape (P,).
        touch: Distance at which they touch [m], shape (P,).
        distance: Of them [m], shape (P,).
    """

    x: FloatArray
    keys: IntArray
    touch: FloatArray
    distance: FloatArray

    def is_of(self, x: FloatArray) -> bool:
        """Whether these are the places."""
        return np.array_equal(self.x, x)

    def nearer(self, limit: FloatArray) -> IntArray:
        """Keys of pairs nearer than limits (P,) [m]."""
        return self.keys[self.distance < limit]
