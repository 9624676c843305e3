"""Additive conservative advancement: how far things may move before they come too near.

A distance shrinks by no more than the things move. So as long as some is left over the least distance
allowed, that much of the way is safe; there it is measured again (Li, Kaufman and Jiang 2021).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from ..arrays import FloatArray, IntArray

# It stops where a tenth of the first distance is left.
_LEFT: Final = 0.1
_ROUNDS: Final = 1000


def longest_way(
    gap_at: Callable[[float, IntArray], FloatArray], speed: FloatArray, nearest: FloatArray
) -> float:
    """Part in (0, 1] of a way on which no distance falls below the least one.

    Args:
        gap_at: Distances [m] of some of the things at a part of the way.
        speed: By how much the distance of each may change on the whole way [m], shape (K,).
        nearest: Least distance [m], shape (K,); what is nearer already may come half as near as it is.
    """
    which = np.arange(len(speed))
    gap = gap_at(0.0, which)
    # what is inside cannot be kept out any more
    kept = gap > 0.0
    least = np.minimum(nearest, 0.5 * gap)
    which = which[kept & (speed > gap - least)]
    if not len(which):
        return 1.0
    least, stop = least[which], _LEFT * (gap - least)[which]
    speed, spare = speed[which], (gap[which] - least)
    part = 0.0
    for _ in range(_ROUNDS):
        with np.errstate(divide="ignore"):
            ahead = float((spare / speed).min())
        part += ahead
        if part >= 1.0:
            return 1.0
        spare = gap_at(part, which) - least
        if (spare <= stop).any():
            return part
    return part
