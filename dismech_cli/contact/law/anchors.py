"""How far lines are from their anchors on what they face, and how steps change that.

A line and all that it faces in one place of a body have one anchor: a way at either end of the line,
linear between them, so that turning is held as shifting is. It is kept for each pair of the line and a part
of what it faces. Steps add what moved in them; where nothing moves nothing changes, and so nothing creeps.
"""

from __future__ import annotations

from typing import Final, Self

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen

_TINY: Final = float(np.finfo(float).tiny)
# Normals that point all ways have no common one: below this share of their sum.
_COMMON: Final = 0.5


@frozen
class Anchors:
    """Ways from anchors of some pairs.

    Attributes:
        keys: Of the pairs, ascending, shape (P,).
        ways: At both ends of their lines [m], shape (P, 2, 3).
    """

    keys: IntArray
    ways: FloatArray

    @classmethod
    def none(cls) -> Self:
        """Of no pairs."""
        return cls(np.empty(0, dtype=np.int64), np.empty((0, 2, 3)))

    @classmethod
    def unpacked(cls, kept: FloatArray) -> Self:
        """What :meth:`packed` made."""
        return cls(kept[:, 0].astype(np.int64), kept[:, 1:].reshape(-1, 2, 3))

    def packed(self) -> FloatArray:
        """As one array, shape (P, 7)."""
        return np.column_stack((self.keys.astype(np.float64), self.ways.reshape(-1, 6)))

    def of(self, keys: IntArray) -> tuple[FloatArray, IntArray]:
        """Ways of some pairs, shape (K, 2, 3), zero without an anchor; and which have one, shape (H,)."""
        out = np.zeros((len(keys), 2, 3))
        if not len(self.keys):
            return out, np.empty(0, dtype=np.int64)
        place = np.minimum(np.searchsorted(self.keys, keys), len(self.keys) - 1)
        known = np.flatnonzero(self.keys[place] == keys)
        out[known] = self.ways[place[known]]
        return out, known


@frozen
class Moved:
    """Points of contact at the end of a step.

    Attributes:
        group: Number of the anchor of each, shape (K,).
        s: Place on the line, shape (K,).
        load: Normal force [N], shape (K,).
        normal: Shape (K, 3).
        way: How far the line moved in the step against what it faces [m], shape (K, 3).
    """

    group: IntArray
    s: FloatArray
    load: FloatArray
    normal: FloatArray
    way: FloatArray

    def ends(self, ways: FloatArray) -> FloatArray:
        """Ways of all anchors after the step, shape (G, 2, 3).

        What moved along the line is fitted by a linear function, as far as contact reaches along it.

        Args:
            ways: Of the pairs that the points are of, before it, shape (K, 2, 3).
        """
        count = int(self.group.max(initial=-1)) + 1
        # what is taken off again has no say
        weight = np.maximum(self.load, 0.0)
        total = np.bincount(self.group, weights=weight, minlength=count) + _TINY

        def mean(values: FloatArray) -> FloatArray:
            out = np.zeros((count, *values.shape[1:]))
            np.add.at(out, self.group, weight.reshape(-1, *[1] * (values.ndim - 1)) * values)
            return np.asarray(out / total.reshape(-1, *[1] * (values.ndim - 1)))

        n = self.normal
        level = self.way - (self.way * n).sum(axis=1)[:, None] * n
        middle, moved = mean(self.s), mean(level)
        off = self.s - middle[self.group]
        spread = mean(off * off)
        # a way of all of the line counts in full: its variance is a twelfth
        slope = (
            mean(off[:, None] * level) / (spread + _TINY)[:, None] * np.minimum(1.0, 12.0 * spread)[:, None]
        )
        step = moved[:, None] + np.stack((-middle, 1.0 - middle), axis=1)[:, :, None] * slope[:, None]
        common = mean(n)
        size = np.linalg.norm(common, axis=1)
        unit = np.where((size > _COMMON)[:, None], common / (size + _TINY)[:, None], 0.0)
        out = mean(ways) + step
        return np.asarray(out - (out * unit[:, None]).sum(axis=2)[:, :, None] * unit[:, None])


def turned(ways: FloatArray, before: FloatArray, after: FloatArray) -> FloatArray:
    """Ways (G, 2, 3) carried along as directions turn the shortest way, unit vectors of shape (G, 3)."""
    axis = np.cross(before, after)[:, None]
    cosine = (before * after).sum(axis=1)[:, None, None]
    once = np.cross(axis, ways)
    return np.asarray(ways + once + np.cross(axis, once) / np.maximum(1.0 + cosine, 1e-3))


def cut(ways: FloatArray, length: float) -> FloatArray:
    """Ways (..., 3) no longer than a length [m]: farther behind an anchor is dragged along."""
    far = np.linalg.norm(ways, axis=-1, keepdims=True)
    return np.asarray(ways * np.minimum(1.0, length / np.maximum(far, _TINY)))
