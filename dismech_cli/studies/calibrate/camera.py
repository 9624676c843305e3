"""A camera that looks straight at a plane: scale, turn and place of its picture, across and down.

    across = c0 a - c1 b + c2,   down = -(c1 a + c0 b) + c3

of two coordinates a and b: linear in the four numbers, which are fitted with the rest.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from ...arrays import FloatArray

COUNT: Final = 4
NAMES: Final = ("along", "across", "right", "down")


def pictured(c: FloatArray, points: FloatArray) -> FloatArray:
    """Where points are seen.

    Args:
        c: The four numbers.
        points: Coordinates a, b, a, b, ..., shape (..., 2 M).
    """
    a, b = points[..., 0::2], points[..., 1::2]
    out = np.empty_like(points)
    out[..., 0::2] = c[0] * a - c[1] * b + c[2]
    out[..., 1::2] = -(c[1] * a + c[0] * b) + c[3]
    return out


def turned(c: FloatArray, moves: FloatArray) -> FloatArray:
    """How they move in the picture as points move, shape (..., 2 M)."""
    return pictured(np.array([c[0], c[1], 0.0, 0.0]), moves)


def slopes(points: FloatArray) -> FloatArray:
    """Derivatives of where points are seen to the four numbers, shape (4, ..., 2 M)."""
    return np.stack([pictured(unit, points) for unit in np.eye(COUNT)])


def found(points: FloatArray, seen: FloatArray) -> FloatArray:
    """The camera that sees points nearest to where they were seen; NaN counts nothing."""
    known = np.isfinite(seen).ravel()
    matrix = slopes(points).reshape(COUNT, -1).T[known]
    return np.asarray(np.linalg.lstsq(matrix, seen.ravel()[known], rcond=None)[0])


def scale(c: FloatArray) -> float:
    """Size in the picture of a metre."""
    return float(np.hypot(c[0], c[1]))
