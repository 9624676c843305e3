"""Parts of lines that count more or less often than once, added up: what cancels is left out."""

from __future__ import annotations

from typing import Final

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ...frozen import frozen
from .pieces import Pieces

SLIVER: Final = 1e-13
"""What is shorter, as a share of a line, is rounding of the place where a line passes a plane."""


@frozen
class Spans:
    """Parts [low, high] of lines, from 0 to 1.

    Attributes:
        group: Which line and feature, shape (K,).
        low: Start, shape (K,).
        high: End, shape (K,).
        times: How often it counts, a whole number, shape (K,).
    """

    group: IntArray
    low: FloatArray
    high: FloatArray
    times: FloatArray

    @classmethod
    def once(cls, group: IntArray, pieces: Pieces, kept: BoolArray) -> Spans:
        """Some pieces of lines, once each."""
        which = np.flatnonzero(kept)
        return cls(group[which], pieces.low[which], pieces.high[which], np.ones(len(which)))

    @classmethod
    def joined(cls, parts: list[Spans]) -> Spans:
        """All of a list."""
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in cls.__match_args__))

    def net(self) -> Spans:
        """Each part of a group once, with the sum of the times that it counts, where that is not nothing."""
        group, times = np.tile(self.group, 2), np.concatenate((self.times, -self.times))
        place = np.concatenate((self.low, self.high))
        order = np.lexsort((place, group))
        group, place, total = group[order], place[order], np.cumsum(times[order])
        kept = np.flatnonzero(
            (place[1:] - place[:-1] > SLIVER) & (group[1:] == group[:-1]) & (total[:-1] != 0.0)
        )
        group, low, high, total = group[kept], place[kept], place[kept + 1], total[kept]
        # parts that follow each other and count alike are one
        new = np.ones(len(kept), dtype=np.bool_)
        new[1:] = (group[1:] != group[:-1]) | (total[1:] != total[:-1]) | (low[1:] - high[:-1] > SLIVER)
        first = np.flatnonzero(new)
        last = np.append(first[1:], len(kept))[: len(first)] - 1
        return Spans(group[first], low[first], high[last], total[first])
