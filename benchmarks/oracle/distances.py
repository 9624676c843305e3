"""Distances of points, segments and triangles by formulas of textbooks."""

from __future__ import annotations

from typing import Final

import numpy as np

from dismech_cli.arrays import FloatArray

_SIDES: Final = ((0, 1), (1, 2), (2, 0))


def to_segment(p: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    """Distances of points from segments, all of shape (3, K) [m]."""
    u = b - a
    t = np.clip(((p - a) * u).sum(axis=0) / (u * u).sum(axis=0), 0.0, 1.0)
    return np.asarray(np.linalg.norm(p - a - t * u, axis=0))


def between_segments(x: FloatArray) -> FloatArray:
    """Distances of segments with ends (4, 3, K): of ends, or of the points where the lines are nearest."""
    a, b, c, d = x
    ends = [to_segment(a, c, d), to_segment(b, c, d), to_segment(c, a, b), to_segment(d, a, b)]
    u, v, w = b - a, d - c, a - c
    uu, uv, vv, uw, vw = ((p * q).sum(axis=0) for p, q in ((u, u), (u, v), (v, v), (u, w), (v, w)))
    square = (np.cross(u, v, axis=0) ** 2).sum(axis=0)
    with np.errstate(all="ignore"):
        s, t = (uv * vw - vv * uw) / square, (uu * vw - uv * uw) / square
        inner = np.linalg.norm(w + s * u - t * v, axis=0)
    inside = (square > 0.0) & (s > 0.0) & (s < 1.0) & (t > 0.0) & (t < 1.0)
    return np.asarray(np.min([*ends, np.where(inside, inner, np.inf)], axis=0))


def of_point(p: FloatArray, corners: FloatArray) -> FloatArray:
    """Distances of points (3, K) from triangles (3, 3, K): corner, axis."""
    a, b, c = corners
    n = np.cross(b - a, c - a, axis=0)
    sides = [(corners[i], corners[j]) for i, j in _SIDES]
    inside = np.all([(np.cross(n, q - r, axis=0) * (p - r)).sum(axis=0) >= 0.0 for r, q in sides], axis=0)
    height = np.abs((n * (p - a)).sum(axis=0)) / np.linalg.norm(n, axis=0)
    return np.asarray(
        np.min([np.where(inside, height, np.inf), *(to_segment(p, *side) for side in sides)], axis=0)
    )


def to_triangle(x: FloatArray) -> FloatArray:
    """Distances of segments, the first two nodes of (5, 3, K), from triangles; 0 where they pass through."""
    p, q, *corners = x
    a, b, c = corners
    n = np.cross(b - a, c - a, axis=0)
    with np.errstate(all="ignore"):
        s = (n * (a - p)).sum(axis=0) / (n * (q - p)).sum(axis=0)
        inner = of_point(p + s * (q - p), x[2:])
    sides = [between_segments(np.stack((p, q, corners[i], corners[j]))) for i, j in _SIDES]
    through = np.where((s >= 0.0) & (s <= 1.0), inner, np.inf)
    return np.asarray(np.min([of_point(p, x[2:]), of_point(q, x[2:]), *sides, through], axis=0))
