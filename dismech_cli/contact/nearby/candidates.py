"""Pairs of lines that may be near each other (broad phase)."""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ...frozen import frozen

# Lines within a class differ in half length and reach by at most this factor: one tree each.
_CLASS = 4.0


@frozen
class Boxes:
    """Boxes along the axes, and how much larger they are meant to be.

    Attributes:
        low: Lower corners [m], shape (B, 3).
        high: Upper corners [m], shape (B, 3).
        sizes: By how much they are larger on all sides [m], shape (B,).
    """

    low: FloatArray
    high: FloatArray
    sizes: FloatArray

    @classmethod
    def around(cls, places: FloatArray, sizes: FloatArray) -> Boxes:
        """Boxes of points (B, n, 3) [m]."""
        return cls(places.min(axis=1), places.max(axis=1), sizes)

    def balls(self) -> tuple[FloatArray, FloatArray]:
        """Centres and radii of balls that hold them [m], shapes (B, 3) and (B,)."""
        half = 0.5 * (self.high - self.low)
        return self.low + half, np.sqrt((half * half).sum(axis=1)) + self.sizes


def near_boxes(first: Boxes, second: Boxes) -> IntArray:
    """All pairs of two kinds of boxes that are nearer than both sizes, ascending, shape (P, 2)."""
    pairs = near_between(*first.balls(), *second.balls())
    pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
    return pairs[_nearer(first, second, pairs)]


def near_among(boxes: Boxes) -> IntArray:
    """All pairs of boxes that are nearer than both sizes, the lower number first, ascending, shape (P, 2)."""
    pairs = near_pairs(*boxes.balls())
    return pairs[_nearer(boxes, boxes, pairs)]


def _nearer(first: Boxes, second: Boxes, pairs: IntArray) -> BoolArray:
    """Which pairs of boxes are nearer than both sizes."""
    one, other = pairs.T
    gap = np.maximum(
        np.maximum(first.low[one] - second.high[other], second.low[other] - first.high[one]), 0.0
    )
    near: BoolArray = (gap * gap).sum(axis=1) < (first.sizes[one] + second.sizes[other]) ** 2
    return near


def near_pairs(middles: FloatArray, sizes: FloatArray) -> IntArray:
    """All pairs of balls that overlap, the lower number first, in ascending order, shape (P, 2).

    Args:
        middles: Their centres [m], shape (E, 3).
        sizes: Their radii [m], shape (E,).
    """
    from scipy.spatial import KDTree

    if len(sizes) < 2:
        return np.empty((0, 2), dtype=np.int64)
    members = _classes(sizes)
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


def near_between(
    first: FloatArray, first_size: FloatArray, second: FloatArray, second_size: FloatArray
) -> IntArray:
    """All pairs of a ball of the first kind and one of the second that overlap, shape (P, 2).

    Args:
        first: Centres [m], shape (A, 3).
        first_size: Radii [m], shape (A,).
        second: Centres, shape (B, 3).
        second_size: Radii, shape (B,).
    """
    from scipy.spatial import KDTree

    found = [np.empty((0, 2), dtype=np.int64)]
    ones = [(own, KDTree(first[own])) for own in _classes(first_size)]
    for others in _classes(second_size):
        tree = KDTree(second[others])
        for own, mine in ones:
            radius = first_size[own].max() + second_size[others].max()
            near = mine.sparse_distance_matrix(tree, radius, output_type="ndarray")
            pairs = np.stack((own[near["i"]], others[near["j"]]), axis=1)
            found.append(pairs[near["v"] < first_size[pairs[:, 0]] + second_size[pairs[:, 1]]])
    return np.concatenate(found)


def _classes(sizes: FloatArray) -> list[IntArray]:
    """Numbers of those of similar size."""
    if not len(sizes):
        return []
    classes = np.floor(np.log(sizes / sizes.min()) / np.log(_CLASS) + 1e-9).astype(np.int64)
    return [np.flatnonzero(classes == one) for one in np.unique(classes)]


def distinct(keys: IntArray) -> IntArray:
    """Keys in order, each once; np.unique of NumPy 2.4 hashes, which takes many times longer here."""
    ordered = np.sort(keys, axis=None)
    new = np.ones(len(ordered), dtype=np.bool_)
    np.not_equal(ordered[1:], ordered[:-1], out=new[1:])
    once: IntArray = ordered[new]
    return once


def among(keys: IntArray, ordered: IntArray) -> BoolArray:
    """Which keys are among ascending ones."""
    if not len(ordered):
        return np.zeros(len(keys), dtype=np.bool_)
    place = np.minimum(np.searchsorted(ordered, keys), len(ordered) - 1)
    found: BoolArray = ordered[place] == keys
    return found
