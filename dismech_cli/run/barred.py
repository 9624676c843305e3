"""Steps so long that Newton's method failed lately are not tried again at once.

What fails does so at much the same length for a while, whatever the error says: every third step would be
in vain. Each failure at about the length of the one before doubles how many steps are waited.
"""

from __future__ import annotations

from math import inf

from ..frozen import frozen
from ..model.saved import Numbers

# Share of a length that failed which is taken meanwhile, and how near the next failure counts as the same.
_SHARE, _SAME = 0.8, 2.0
# Steps before one as long is tried again: the first time, and at most.
_FIRST, _MOST = 4, 64


@frozen
class Barred:
    """The last length that failed.

    Attributes:
        length: Of it [s]; infinite before any.
        left: Steps to take before one as long is tried again.
        wait: How many were waited after it failed.
    """

    length: float = inf
    left: int = 0
    wait: int = 0

    def failed(self, length: float) -> Barred:
        """After a step of a length [s] that failed."""
        again = self.length / _SAME <= length <= _SAME * self.length
        wait = min(2 * self.wait, _MOST) if again and self.wait else _FIRST
        return Barred(length, wait, wait)

    def taken(self) -> Barred:
        """After a step that did not."""
        return Barred(self.length, max(self.left - 1, 0), self.wait)

    def allowed(self, step: float) -> float:
        """The length [s] that the next step may have of one that its error allows."""
        return min(step, _SHARE * self.length) if self.left else step

    def numbers(self) -> Numbers:
        """What is remembered."""
        return {"barred": self.length, "left": self.left, "wait": self.wait}

    def restore(self, numbers: Numbers) -> Barred:
        """What was remembered."""
        return Barred(float(numbers["barred"]), int(numbers["left"]), int(numbers["wait"]))
