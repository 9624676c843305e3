"""Parts of bodies that share a side or a corner and are faced at different distances.

They are layers: all of them at the least distance, and on top of that, at each next one, what is thicker.
Every layer is a body with junctions of its own, which are taken off of it. So thin parts feel the end of
thick ones, nothing is counted twice, and nothing jumps where one of them comes out of reach.
"""

from __future__ import annotations

import numpy as np

from ...arrays import IntArray


def shared(keys: IntArray, levels: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """What comes twice or more among keys (P, n) of pairs at some levels (P,), each once for every level.

    Returns:
        Their numbers, else -1, shape (P, n); of each where in ``keys`` it comes first, and where the levels
        of its key end, shapes (K,).
    """
    depth = int(levels.max(initial=0)) + 1
    if depth > 1:
        # as small as may be, so that a level fits beside it
        _, ranks = np.unique(keys, return_inverse=True)
        keys = ranks.reshape(keys.shape) * depth + levels[:, None]
    every, first, of, times = np.unique(
        keys.reshape(-1), return_index=True, return_inverse=True, return_counts=True
    )
    # ascending: levels of a key are neighbours
    key = every // depth
    begins = np.append(True, key[1:] != key[:-1])[: len(key)]
    group = np.cumsum(begins) - 1
    until = np.append(np.flatnonzero(begins), len(key))[group + 1]
    double = np.bincount(group, times)[group] >= 2
    place = np.where(double, np.cumsum(double) - 1, -1)
    kept = np.flatnonzero(double)
    ends = np.append(0, np.cumsum(double))[until[kept]]
    return place[of.reshape(keys.shape)], first[kept], ends


def from_here_on(values: IntArray, until: IntArray) -> IntArray:
    """Sums of values (K,) over each level and those above it."""
    sums = np.append(np.cumsum(values[::-1])[::-1], 0)
    out: IntArray = sums[:-1] - sums[until]
    return out


def of_next(values: IntArray, until: IntArray) -> IntArray:
    """The value (K,) of the next level of each, 0 where there is none."""
    following = np.arange(1, len(values) + 1)
    out: IntArray = np.where(following < until, np.append(values, 0)[following], 0)
    return out
