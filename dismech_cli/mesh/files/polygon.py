"""Triangles from polygons."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray

MAX_CORNERS = 64
"""Largest polygon that is triangulated; more corners ask for a mesher."""


def triangulate(points: FloatArray) -> list[tuple[int, int, int]]:
    """Cut a simple polygon into triangles by clipping ears, the best-shaped ear first.

    A convex quad is therefore split along its better diagonal, and a concave polygon stays inside
    its outline. Slightly non-planar polygons are judged in the plane of their area vector.

    Args:
        points: Corners in order, shape (K, 3), 3 <= K.

    Returns:
        K - 2 triples of corner indices, wound like the polygon.
    """
    corners = list(range(len(points)))
    area_vector = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    drop = int(np.argmax(np.abs(area_vector)))
    # Project along the dominant axis, keeping the sense of rotation positive.
    plane = points[:, [(drop + 1) % 3, (drop + 2) % 3]] * np.array([1.0, np.sign(area_vector[drop]) or 1.0])
    triangles: list[tuple[int, int, int]] = []
    while len(corners) > 3:
        ears = [(_ear_quality(plane, corners, k), -k) for k in range(len(corners))]
        k = -max(ears)[1]
        triangles.append((corners[k - 1], corners[k], corners[(k + 1) % len(corners)]))
        del corners[k]
    triangles.append((corners[0], corners[1], corners[2]))
    return triangles


def _cross(a: FloatArray, b: FloatArray, c: FloatArray) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def _ear_quality(plane: FloatArray, corners: list[int], k: int) -> float:
    """Area over squared sides of the ear at corner k; -1 if another corner lies in it."""
    before, here, after = corners[k - 1], corners[k], corners[(k + 1) % len(corners)]
    a, b, c = plane[before], plane[here], plane[after]
    area = _cross(a, b, c)
    if area <= 0.0:
        return -1.0
    for other in corners:
        if other in (before, here, after):
            continue
        p = plane[other]
        if min(_cross(a, b, p), _cross(b, c, p), _cross(c, a, p)) >= 0.0:
            return -1.0
    quality = _shape(a, b, c)
    if len(corners) == 4:
        # The last cut fixes the last triangle too: judge a diagonal by its worse side.
        opposite = plane[corners[(k + 2) % 4]]
        quality = min(quality, _shape(c, opposite, a))
    return quality


def _shape(a: FloatArray, b: FloatArray, c: FloatArray) -> float:
    """Signed area over the sum of squared sides: largest for equilateral triangles."""
    sides = float(((b - a) ** 2).sum() + ((c - b) ** 2).sum() + ((a - c) ** 2).sum())
    return _cross(a, b, c) / sides if sides > 0.0 else -1.0
