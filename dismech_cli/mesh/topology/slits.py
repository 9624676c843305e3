"""Lips of slits: rim sides that lie on each other but share no node, or one at a tip."""

from __future__ import annotations

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ..suspects import suspects

_SAME_PLACE = 1e-9
"""Of the size of a surface: places nearer than this are one."""


def on_each_other(nodes: FloatArray, sides: IntArray) -> BoolArray:
    """True for sides whose ends lie where those of another side do, shape (K,).

    Args:
        nodes: Positions [m], shape (N, 3).
        sides: Node indices, shape (K, 2).
    """
    if not len(sides):
        return np.zeros(0, dtype=np.bool_)
    used, index = np.unique(sides, return_inverse=True)
    points = nodes[used]
    near = _SAME_PLACE * float(np.ptp(points, axis=0).max())
    asked = suspects(points, near)
    if not len(asked):
        return np.zeros(len(sides), dtype=np.bool_)
    from scipy.spatial import cKDTree

    pairs = asked[np.sort(cKDTree(points[asked]).query_pairs(near, output_type="ndarray"), axis=1)]
    place = np.arange(len(used))
    # The lowest node at a place stands for all.
    np.minimum.at(place, pairs[:, 1], pairs[:, 0])
    ends = np.sort(place[index.reshape(-1, 2)], axis=1)
    _, inverse, counts = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    lips: BoolArray = counts[inverse.ravel()] > 1
    return lips
