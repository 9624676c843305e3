"""Factors of narrow bands, row by row, for compiled steps: bands too narrow for LAPACK's blocks to pay.

Rows of a symmetric matrix hold the diagonal and what is right of it, (width + 1) numbers; rows of others hold
(3 width + 1), those from ``width`` left of the diagonal on, with the room to the right that pivoting fills.
"""

from __future__ import annotations

from math import sqrt

from ...arrays import FloatArray, IntArray
from ...geometry.kernel import loop


@loop
def cholesky(a: FloatArray, width: int, m: int) -> bool:
    """Factorise a symmetric band in place, A = U^T U; False where it is not positive definite."""
    step = width + 1
    for i in range(m):
        row = i * step
        pivot = a[row]
        if not pivot > 0.0:
            return False
        pivot = sqrt(pivot)
        a[row] = pivot
        last = min(width, m - 1 - i)
        for k in range(1, last + 1):
            a[row + k] /= pivot
        for k in range(1, last + 1):
            factor, below = a[row + k], row + k * step
            for j in range(last - k + 1):
                a[below + j] -= factor * a[row + k + j]
    return True


@loop
def solve_cholesky(u: FloatArray, width: int, x: FloatArray) -> None:
    """Solve with the factor of :func:`cholesky` in place, shape (m,)."""
    m, step = len(x), width + 1
    for i in range(m):
        row = i * step
        x[i] /= u[row]
        for k in range(1, min(width, m - 1 - i) + 1):
            x[i + k] -= u[row + k] * x[i]
    for i in range(m - 1, -1, -1):
        row, total = i * step, x[i]
        for k in range(1, min(width, m - 1 - i) + 1):
            total -= u[row + k] * x[i + k]
        x[i] = total / u[row]


@loop
def symmetric_defect(a: FloatArray, width: int, x: FloatArray, b: FloatArray, out: FloatArray) -> float:
    """The defect b - A x of a symmetric band; its largest entry."""
    m, step = len(x), width + 1
    for i in range(m):
        out[i] = b[i]
    for i in range(m):
        row = i * step
        total = a[row] * x[i]
        for k in range(1, min(width, m - 1 - i) + 1):
            total += a[row + k] * x[i + k]
            out[i + k] -= a[row + k] * x[i]
        out[i] -= total
    return largest(out)


@loop
def pivoted(a: FloatArray, width: int, m: int, pivots: IntArray) -> bool:
    """Factorise a band in place with row exchanges, P A = L U; False where it is singular."""
    step = 3 * width + 1
    for i in range(m):
        here = i * step + width
        last = min(width, m - 1 - i)
        best, found = abs(a[here]), 0
        for k in range(1, last + 1):
            size = abs(a[here + k * (step - 1)])
            if size > best:
                best, found = size, k
        if not best > 0.0:
            return False
        pivots[i] = i + found
        end = min(2 * width, m - 1 - i)
        if found:
            other = here + found * (step - 1)
            for j in range(end + 1):
                a[here + j], a[other + j] = a[other + j], a[here + j]
        for k in range(1, last + 1):
            below = here + k * (step - 1)
            factor = a[below] / a[here]
            a[below] = factor
            if factor != 0.0:
                for j in range(1, end + 1):
                    a[below + j] -= factor * a[here + j]
    return True


@loop
def solve_pivoted(lu: FloatArray, width: int, pivots: IntArray, x: FloatArray) -> None:
    """Solve with the factors of :func:`pivoted` in place, shape (m,)."""
    m, step = len(x), 3 * width + 1
    for i in range(m):
        here, p = i * step + width, pivots[i]
        if p != i:
            x[i], x[p] = x[p], x[i]
        for k in range(1, min(width, m - 1 - i) + 1):
            x[i + k] -= lu[here + k * (step - 1)] * x[i]
    for i in range(m - 1, -1, -1):
        here, total = i * step + width, x[i]
        for j in range(1, min(2 * width, m - 1 - i) + 1):
            total -= lu[here + j] * x[i + j]
        x[i] = total / lu[here]


@loop
def defect(a: FloatArray, width: int, x: FloatArray, b: FloatArray, out: FloatArray) -> float:
    """The defect b - A x of a band; its largest entry."""
    m, step = len(x), 3 * width + 1
    for i in range(m):
        here, total = i * step + width, b[i]
        for j in range(max(-width, -i), min(width, m - 1 - i) + 1):
            total -= a[here + j] * x[i + j]
        out[i] = total
    return largest(out)


@loop
def largest(x: FloatArray) -> float:
    """The largest entry by size; no number where one is none."""
    found = 0.0
    for value in x:
        size = abs(value)
        if not size <= found:
            found = size
    return found
