"""How far two runs are apart at every time of theirs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from ...arrays import FloatArray
from ...frozen import frozen

Norm = Callable[[FloatArray], float]
"""Of what two runs differ by at some times, shape (K,), none of it negative: the share that counts."""


@frozen
class Gap:
    """Distances of two runs, or errors of one, as shares of the range of each quantity.

    Those of steps and of the mesh are added where they happen: two that are large at different times are no
    larger together. They have no signs and never cancel.

    Attributes:
        parts: Of each quantity at some times, shape (K,); or (1,) where it is one number.
        norms: What counts of each.
        rest: What comes on top at all times; infinite where nothing is known.
    """

    parts: tuple[FloatArray, ...] = ()
    norms: tuple[Norm, ...] = ()
    rest: float = 0.0

    @property
    def size(self) -> float:
        """The largest that counts of any quantity."""
        return max((norm(part) for part, norm in zip(self.parts, self.norms, strict=True)), default=0.0) + (
            self.rest
        )

    def __add__(self, other: Gap) -> Gap:
        """Both at their times."""
        rest = self.rest + other.rest
        if not (self.parts and other.parts):
            return Gap(self.parts or other.parts, self.norms or other.norms, rest)
        parts = tuple(a + b for a, b in zip(self.parts, other.parts, strict=True))
        return Gap(parts, self.norms, rest)

    def __rmul__(self, factor: float) -> Gap:
        """A multiple."""
        return Gap(tuple(factor * part for part in self.parts), self.norms, factor * self.rest)


def largest(share: FloatArray) -> float:
    """Norm of the largest."""
    return float(share.max())


def root_mean_square(share: FloatArray) -> float:
    """Norm over time."""
    return float(np.sqrt(np.mean(share * share)))


NONE: Final = Gap()
UNKNOWN: Final = Gap(rest=float("inf"))
