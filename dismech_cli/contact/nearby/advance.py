"""Additive conservative advancement: how far things may move before they come too near.

A distance shrinks by no more than the things move. So as long as some is left over the least distance
allowed, that much of the way is safe; there it is measured again (Li, Kaufman and Jiang 2021). Each thing
goes its own way, and is given up where another has stopped already.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from ...arrays import FloatArray, IntArray

LEFT: Final = 0.1
"""It stops where so much of the first distance is left."""
ROUNDS: Final = 1000
"""Distances of a thing are measured so often at most."""


def longest_way(
    gap_at: Callable[[FloatArray, IntArray], FloatArray], speed: FloatArray, nearest: FloatArray
) -> float:
    """Part in (0, 1] of a way on which no distance falls below the least one.

    Args:
        gap_at: Distances [m] at parts of the way (W,) of some of the things (W,).
        speed: By how much the distance of each may change on the whole way [m], shape (K,).
        nearest: Least distance [m], shape (K,); what is nearer already may come half as near as it is.
    """
    which = np.arange(len(speed))
    gap = gap_at(np.zeros(len(speed)), which)
    # what is inside cannot be kept out any more
    kept = gap > 0.0
    least = np.minimum(nearest, 0.5 * gap)
    which = which[kept & (speed > gap - least)]
    spare = (gap - least)[which]
    stop = LEFT * spare
    part, longest = np.zeros(len(which)), 1.0
    for _ in range(ROUNDS):
        part = part + spare / speed[which]
        on = part < longest
        which, part, stop = which[on], part[on], stop[on]
        if not len(which):
            return longest
        spare = gap_at(part, which) - least[which]
        near = spare <= stop
        longest = float(part[near].min(initial=longest))
        on = ~near
        which, part, stop, spare = which[on], part[on], stop[on], spare[on]
    return float(part.min(initial=longest))
