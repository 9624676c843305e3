"""Factors of narrow bands with several right-hand sides at once, for compiled sweeps of derivatives.

Rows of symmetric bands hold the diagonal and what is right of it, (width + 1) numbers, those of others all
(2 width + 1). Below the last row are ``width`` more of zeros. Nothing is exchanged: what has a positive
definite symmetric part needs no exchange, and what has not shows by a pivot or by the defect of a solution.

Right-hand sides are of shape (m + width, 4 K), zero below row m: four at a time are as fast as one.
"""

from __future__ import annotations

from typing import Final

from ...arrays import FloatArray
from ...geometry.kernel import loop

ABREAST: Final = 4
"""So many right-hand sides are worked on at a time."""


@loop
def symmetric_factors(a: FloatArray, width: int, m: int) -> bool:
    """Factorise A = L D L^T in place, inverse pivots on the diagonal; False where one is not positive."""
    step = width + 1
    i = 0
    while i < m:
        row, near = i * step, (i + 1) * step
        if not a[row] > 0.0:
            return False
        inverse = 1.0 / a[row]
        a[row] = inverse
        if i + 1 == m:
            return True
        # two rows at a time: what is below is read and written once for both
        factor = a[row + 1] * inverse
        for j in range(1, step):
            a[near + j - 1] -= factor * a[row + j]
        a[row + 1] = factor
        if not a[near] > 0.0:
            return False
        second = 1.0 / a[near]
        a[near] = second
        for k in range(2, step):
            one, other, below = a[row + k] * inverse, a[near + k - 1] * second, row + k * width
            for j in range(k, step):
                a[below + j] -= one * a[row + j] + other * a[near + j - 1]
            a[below + step] -= other * a[near + width]
            a[row + k], a[near + k - 1] = one, other
        other = a[near + width] * second
        a[near + width * step] -= other * a[near + width]
        a[near + width] = other
        i += 2
    return True


@loop
def general_factors(a: FloatArray, width: int, m: int) -> bool:
    """Factorise A = L U in place, inverse pivots on the diagonal; False where one is not positive."""
    step = 2 * width + 1
    down = step - 1
    i = 0
    while i < m:
        here = i * step + width
        if not a[here] > 0.0:
            return False
        inverse = 1.0 / a[here]
        a[here] = inverse
        if i + 1 == m:
            return True
        # two rows at a time: what is below is read and written once for both
        near = here + down
        factor = a[near] * inverse
        a[near] = factor
        for j in range(1, width + 1):
            a[near + j] -= factor * a[here + j]
        near += 1
        if not a[near] > 0.0:
            return False
        second = 1.0 / a[near]
        a[near] = second
        for k in range(2, width + 1):
            below = here + k * down
            one = a[below] * inverse
            other = (a[below + 1] - one * a[here + 1]) * second
            a[below], a[below + 1] = one, other
            for j in range(2, width + 1):
                a[below + j] -= one * a[here + j] + other * a[near + j - 1]
            a[below + width + 1] -= other * a[near + width]
        below = near + width * down
        other = a[below] * second
        a[below] = other
        for j in range(1, width + 1):
            a[below + j] -= other * a[near + j]
        i += 2
    return True


@loop
def solve_sides(
    a: FloatArray, width: int, m: int, first: int, step: int, down: int, scaled: bool, x: FloatArray
) -> None:
    """Solve with factors in place.

    Args:
        a: Factors.
        width: Of the band.
        m: Rows.
        first: Place of the diagonal in a row.
        step: Length of a row.
        down: From an entry of L to that below, k times.
        scaled: Whether L is the transpose of what is right of the diagonal, which is unit.
        x: Right-hand sides, then solutions.
    """
    for b in range(0, x.shape[1], 4):
        for i in range(m):
            here = i * step + first
            x0, x1, x2, x3 = x[i, b], x[i, b + 1], x[i, b + 2], x[i, b + 3]
            for k in range(1, width + 1):
                factor = a[here + k * down]
                x[i + k, b] -= factor * x0
                x[i + k, b + 1] -= factor * x1
                x[i + k, b + 2] -= factor * x2
                x[i + k, b + 3] -= factor * x3
        for i in range(m - 1, -1, -1):
            here = i * step + first
            inverse = a[here]
            x0, x1, x2, x3 = x[i, b], x[i, b + 1], x[i, b + 2], x[i, b + 3]
            if scaled:
                x0, x1, x2, x3 = x0 * inverse, x1 * inverse, x2 * inverse, x3 * inverse
            # the nearest last: it is the one that is waited for
            for k in range(width, 0, -1):
                factor = a[here + k]
                x0 -= factor * x[i + k, b]
                x1 -= factor * x[i + k, b + 1]
                x2 -= factor * x[i + k, b + 2]
                x3 -= factor * x[i + k, b + 3]
            if not scaled:
                x0, x1, x2, x3 = x0 * inverse, x1 * inverse, x2 * inverse, x3 * inverse
            x[i, b], x[i, b + 1], x[i, b + 2], x[i, b + 3] = x0, x1, x2, x3
