"""What the bodies of items are to each other."""

from __future__ import annotations

from ...arrays import FloatArray, IntArray
from ...frozen import frozen


@frozen
class Between:
    """What the bodies of S items are to each other.

    Attributes:
        friction: Coefficient, shape (S,).
        labels: Number of the pair of bodies, shape (S,).
        signs: 1 where the line is of the first of that pair, else -1, shape (S,).
    """

    friction: FloatArray
    labels: IntArray
    signs: FloatArray

    def some(self, which: IntArray) -> Between:
        """Those of some of the items."""
        return Between(self.friction[which], self.labels[which], self.signs[which])
