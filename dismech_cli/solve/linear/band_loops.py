"""Factors of bands, row by row, for compiled steps: bands too narrow for LAPACK's blocks to pay.

Rows of unsymmetric ones hold (3 width + 1) numbers, those from ``width`` left of the diagonal on, with the
room to the right that pivoting fills; rows of symmetric ones the diagonal and what is right of it. Below the
last row are ``width`` more of zeros, and vectors are longer by 2 ``width``: so each row has as many
neighbours as any other, and where the width is a number in the text, loops over them are unrolled.
"""

from __future__ import annotations

from ...arrays import FloatArray, IntArray
from ...geometry.kernel import loop


@loop
def pivoted(a: FloatArray, width: int, m: int, pivots: IntArray) -> bool:
    """Factorise a band in place with row exchanges, P A = L U; False where it is singular."""
    step = 3 * width + 1
    for i in range(m):
        here = i * step + width
        best, found = abs(a[here]), 0
        for k in range(1, width + 1):
            size = abs(a[here + k * (step - 1)])
            if size > best:
                best, found = size, k
        if not best > 0.0:
            return False
        pivots[i] = i + found
        if found:
            other = here + found * (step - 1)
            for j in range(2 * width + 1):
                a[here + j], a[other + j] = a[other + j], a[here + j]
        inverse = 1.0 / a[here]
        for k in range(1, width + 1):
            below = here + k * (step - 1)
            factor = a[below] * inverse
            a[below] = factor
            for j in range(1, 2 * width + 1):
                a[below + j] -= factor * a[here + j]
    return True


@loop
def solve_pivoted(lu: FloatArray, width: int, m: int, pivots: IntArray, x: FloatArray) -> None:
    """Solve with the factors of :func:`pivoted` in place, shape (m + 2 width,)."""
    step = 3 * width + 1
    for i in range(m):
        here, p = i * step + width, pivots[i]
        if p != i:
            x[i], x[p] = x[p], x[i]
        for k in range(1, width + 1):
            x[i + k] -= lu[here + k * (step - 1)] * x[i]
    for i in range(m - 1, -1, -1):
        here, total = i * step + width, x[i]
        for j in range(1, 2 * width + 1):
            total -= lu[here + j] * x[i + j]
        x[i] = total / lu[here]


@loop
def defect(a: FloatArray, width: int, m: int, x: FloatArray, b: FloatArray, out: FloatArray) -> float:
    """The defect b - A x of a band, shape (m,); its largest entry, no number where one is none."""
    step, found = 3 * width + 1, 0.0
    for i in range(m):
        here, total = i * step + width, b[i]
        for j in range(max(-width, -i), width + 1):
            total -= a[here + j] * x[i + j]
        out[i] = total
        size = abs(total)
        if size > found or size != size:
            found = size
    return found


@loop
def solve_unit(factors: FloatArray, width: int, m: int, x: FloatArray) -> None:
    """Solve L^T x = z in place, with the unit triangle L right of the diagonal."""
    step = width + 1
    for i in range(m - 1, -1, -1):
        row, total = i * step, x[i]
        # the nearest last: it is the one that is waited for
        for k in range(width, 0, -1):
            total -= factors[row + k] * x[i + k]
        x[i] = total


@loop
def symmetric_defect(
    a: FloatArray, width: int, m: int, x: FloatArray, b: FloatArray, out: FloatArray
) -> float:
    """The same of a symmetric band, ``out`` of shape (m + width,)."""
    step, found = width + 1, 0.0
    for i in range(m):
        out[i] = b[i]
    for i in range(m):
        row = i * step
        total = out[i] - a[row] * x[i]
        for k in range(1, width + 1):
            total -= a[row + k] * x[i + k]
            out[i + k] -= a[row + k] * x[i]
        out[i] = total
        size = abs(total)
        if size > found or size != size:
            found = size
    return found
