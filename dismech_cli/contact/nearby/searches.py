"""What finds pairs that are near in a run: one search for all that ask for its pairs or for parts of them."""

from __future__ import annotations

from dataclasses import field
from typing import Protocol

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen


class Nearby(Protocol):
    """Finds pairs that are near."""

    def closer(self, x: FloatArray, share: float) -> IntArray:
        """Keys of pairs nearer than a share of the distance at which they touch, ascending."""

    def coming(self, x0: FloatArray, x1: FloatArray, share: float) -> IntArray:
        """Keys of pairs that may come nearer than that on a straight way, ascending."""


class Nothing:
    """Where there are no such pairs; implements :class:`Nearby`."""

    def closer(self, x: FloatArray, share: float) -> IntArray:
        """None."""
        return np.empty(0, dtype=np.int64)

    def coming(self, x0: FloatArray, x1: FloatArray, share: float) -> IntArray:
        """None."""
        return np.empty(0, dtype=np.int64)


@frozen
class Searches:
    """Of all kinds.

    Attributes:
        rods: Finds rods near each other.
        faces: Finds lines near triangles.
    """

    rods: Nearby = field(default_factory=Nothing)
    faces: Nearby = field(default_factory=Nothing)
