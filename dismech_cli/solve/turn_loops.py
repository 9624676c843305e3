"""How frames turn on their way, and what that adds to stiffness, in loops.

Edges whose frames are carried are given as (heads, tails, angles).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..geometry.kernel import loop


@loop
def turn_slopes(
    starts: FloatArray,
    points: FloatArray,
    heads: IntArray,
    tails: IntArray,
    before: FloatArray,
    after: FloatArray,
    edge: FloatArray,
    length: FloatArray,
) -> None:
    """Write how frames turn on their ways from shapes (C, n) to others; see :mod:`..kinematics.turning`."""
    for s in range(len(starts)):
        q0, q1 = starts[s], points[s]
        for e in range(length.shape[1]):
            x0, x1 = q0[heads[0, e]] - q0[tails[0, e]], q1[heads[0, e]] - q1[tails[0, e]]
            y0, y1 = q0[heads[1, e]] - q0[tails[1, e]], q1[heads[1, e]] - q1[tails[1, e]]
            z0, z1 = q0[heads[2, e]] - q0[tails[2, e]], q1[heads[2, e]] - q1[tails[2, e]]
            l0 = np.sqrt(x0 * x0 + y0 * y0 + z0 * z0)
            l1 = np.sqrt(x1 * x1 + y1 * y1 + z1 * z1)
            scale = -1.0 / (l0 * l1 + x0 * x1 + y0 * y1 + z0 * z1)
            a, b, c = scale * (y0 * z1 - z0 * y1), scale * (z0 * x1 - x0 * z1), scale * (x0 * y1 - y0 * x1)
            before[s, 0, e], before[s, 1, e], before[s, 2, e] = a / l0, b / l0, c / l0
            after[s, 0, e], after[s, 1, e], after[s, 2, e] = a / l1, b / l1, c / l1
            edge[s, 0, e], edge[s, 1, e], edge[s, 2, e] = x1, y1, z1
            length[s, e] = l1


@loop
def mend(
    stiffness: FloatArray,
    damping: FloatArray,
    residuals: FloatArray,
    turning: IntArray,
    edges: Any,
    v: FloatArray,
    way: Any,
    places: Any,
) -> None:
    """Add what kernels leave out at edges whose frames are carried; see :mod:`.carried`.

    Args:
        stiffness: Entries of dr/dq, mended.
        damping: Those of dr/dv; of length 0 for none.
        residuals: Of each term, shape (T, n).
        turning: Terms whose moments about edges count, shape (K,).
        edges: See the module.
        v: Velocities at the trial point, shape (n,).
        way: Slopes after the way there (3, E), edge vectors (3, E) and their lengths (E,).
        places: Slots of entries in columns of angles, and the edge of each, shape (M,); slots in the same
            rows of components of its head and its tail, shape (2, 3, M); of components of these by
            components of these, shape (2, 2, 3, 3, E).
    """
    heads, tails, angles = edges
    after, edge, length = way
    by_angle, edge_of, by_ends, ends = places
    count = len(angles)
    turns = np.zeros((3, count))
    for e in range(count):
        half, moment = 0.5 / length[e] ** 3, 0.0
        for k in range(len(turning)):
            moment += residuals[turning[k], angles[e]]
        for c in range(3):
            a, b, more = (c + 1) % 3, (c + 2) % 3, half * moment * edge[c, e]
            for i in range(2):
                for j in range(2):
                    signed = more if i == j else -more
                    stiffness[ends[i, j, a, b, e]] -= signed
                    stiffness[ends[i, j, b, a, e]] += signed
        if len(damping):
            x = v[heads[0, e]] - v[tails[0, e]]
            y = v[heads[1, e]] - v[tails[1, e]]
            z = v[heads[2, e]] - v[tails[2, e]]
            turns[0, e] = half * (y * edge[2, e] - z * edge[1, e])
            turns[1, e] = half * (z * edge[0, e] - x * edge[2, e])
            turns[2, e] = half * (x * edge[1, e] - y * edge[0, e])
    for s in range(len(by_angle)):
        e, slot = edge_of[s], by_angle[s]
        value, rate = stiffness[slot], 0.0
        if len(damping):
            rate = damping[slot]
        for k in range(3):
            turned = value * after[k, e] + rate * turns[k, e]
            stiffness[by_ends[0, k, s]] += turned
            stiffness[by_ends[1, k, s]] -= turned
