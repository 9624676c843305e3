"""Boxes of triangles."""

from __future__ import annotations

import numpy as np

from dismech_cli.arrays import FloatArray, IntArray

HALF = np.array([0.4, 0.25, 0.15])


def box(cuts: int) -> tuple[FloatArray, IntArray]:
    """The surface of a box, each side in ``cuts`` times ``cuts`` rectangles of two triangles."""
    ticks = np.linspace(-1.0, 1.0, cuts + 1)
    vertices: dict[tuple[float, ...], int] = {}
    triangles = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            for i in range(cuts):
                for j in range(cuts):
                    corners = []
                    for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                        place = np.zeros(3)
                        place[axis], place[axis - 2], place[axis - 1] = side, ticks[a], ticks[b]
                        corners.append(vertices.setdefault(tuple(place.round(9).tolist()), len(vertices)))
                    a, b, c, d = corners if side > 0.0 else corners[::-1]
                    triangles += [(a, b, c), (a, c, d)]
    return HALF * np.array(list(vertices)), np.array(triangles)
