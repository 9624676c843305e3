"""Pairs of lines that may be near each other (broad phase)."""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np
from scipy.spatial import KDTree

from ..arrays import FloatArray, IntArray

# Lines within a class differ in half length and reach by at most this factor: one tree each.
_CLASS = 4.0


def near_pairs(middles: FloatArray, sizes: FloatArray) -> IntArray:
    """All pairs of balls that overlap, the lower number first, in ascending order, shape (P, 2).

    Args:
        middles: Their centres [m], shape (E, 3).
        sizes: Their radii [m], shape (E,).
    """
    if len(sizes) < 2:
        return np.empty((0, 2), dtype=np.int64)
    classes = np.floor(np.log(sizes / sizes.min()) / np.log(_CLASS) + 1e-9).astype(np.int64)
    members = [np.flatnonzero(classes == one) for one in np.unique(classes)]
    trees = [KDTree(middles[own]) for own in members]
    found = [np.empty((0, 2), dtype=np.int64)]
    for a, b in combinations_with_replacement(range(len(members)), 2):
        radius = sizes[members[a]].max() + sizes[members[b]].max()
        if a == b:
            pairs = trees[a].query_pairs(radius, output_type="ndarray")
            pairs = np.stack((members[a][pairs[:, 0]], members[a][pairs[:, 1]]), axis=1)
        else:
            lists = trees[a].query_ball_tree(trees[b], radius)
            counts = np.array([len(one) for one in lists], dtype=np.int64)
            others = np.concatenate([np.asarray(one, dtype=np.int64) for one in lists if one] or [counts[:0]])
            pairs = np.stack((np.repeat(members[a], counts), members[b][others]), axis=1)
        apart = middles[pairs[:, 1]] - middles[pairs[:, 0]]
        inside = (apart * apart).sum(axis=1) < sizes[pairs].sum(axis=1) ** 2
        found.append(np.sort(pairs[inside], axis=1))
    every = np.concatenate(found)
    return every[np.lexsort((every[:, 1], every[:, 0]))]
