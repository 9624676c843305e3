"""What is inside of a closed surface, by the solid angle under which it is seen."""

from __future__ import annotations

from math import pi
from typing import Final

import numpy as np

from ...arrays import BoolArray, FloatArray

# So many pairs of points and triangles are looked at together.
_TOGETHER: Final = 200_000


def inside(points: FloatArray, corners: FloatArray) -> BoolArray:
    """Which points are inside of closed surfaces, whatever way their triangles wind.

    The solid angle of a triangle is that of van Oosterom and Strackee (1983); all of them make four pi seen
    from inside and nothing from outside.

    Args:
        points: [m], shape (K, 3).
        corners: Of the triangles [m], shape (T, 3, 3).
    """
    out = np.zeros(len(points), dtype=np.bool_)
    for some in np.array_split(np.arange(len(points)), max(len(points) * len(corners) // _TOGETHER, 1)):
        a, b, c = (corners[:, k] - points[some][:, None] for k in range(3))
        la, lb, lc = (np.sqrt((v * v).sum(axis=2)) for v in (a, b, c))
        volume = (a * np.cross(b, c)).sum(axis=2)
        below = la * lb * lc + (a * b).sum(axis=2) * lc + (b * c).sum(axis=2) * la + (c * a).sum(axis=2) * lb
        turns = np.arctan2(volume, below).sum(axis=1) / (2.0 * pi)
        out[some] = np.abs(turns) > 0.5
    return out
