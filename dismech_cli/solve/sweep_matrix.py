"""Sparse matrices of stages in loops: products, and solutions on the free DOFs in a narrow band.

Entries are compressed rows, with the DOF of each row as ``order``; one triangle is stored where they are
symmetric. A band is given as :mod:`.sweep_loops` says.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..geometry.kernel import loop
from .linear.factors import RESIDUAL_GOAL
from .linear.sided_loops import general_factors, solve_sides, symmetric_factors

# Loops want plain numbers.
_GOAL, _GOLDEN = RESIDUAL_GOAL, 0.6180339887498949


@loop
def mirror(values: FloatArray, to: IntArray, of: IntArray) -> None:
    """Write entries of one triangle (K,) into the other."""
    for k in range(len(to)):
        values[to[k]] = values[of[k]]


@loop
def add_product(
    values: FloatArray,
    indptr: IntArray,
    indices: IntArray,
    order: IntArray,
    symmetric: bool,
    x: FloatArray,
    out: FloatArray,
) -> None:
    """Add A x, shape (n, P), to ``out``."""
    sides = x.shape[1]
    for i in range(len(order)):
        row = order[i]
        for s in range(indptr[i], indptr[i + 1]):
            column, value = order[indices[s]], values[s]
            for p in range(sides):
                out[row, p] += value * x[column, p]
            if symmetric and column != row:
                for p in range(sides):
                    out[column, p] += value * x[row, p]


@loop
def add_transposed(
    values: FloatArray,
    indptr: IntArray,
    indices: IntArray,
    order: IntArray,
    symmetric: bool,
    x: FloatArray,
    out: FloatArray,
) -> None:
    """Add A^T x of one column, shape (n, 1), to ``out``."""
    n = len(order)
    found = np.zeros(n)
    ordered = np.empty(n)
    for i in range(n):
        ordered[i] = x[order[i], 0]
    for i in range(n):
        here, more, first, end = ordered[i], 0.0, indptr[i], indptr[i + 1]
        for s in range(first, end):
            found[indices[s]] += values[s] * here
        if symmetric:
            for s in range(first, end):
                if indices[s] != i:
                    more += values[s] * ordered[indices[s]]
            found[i] += more
    for i in range(n):
        out[order[i], 0] += found[i]


@loop
def total(
    stiffness: FloatArray,
    damping: FloatArray,
    mass: FloatArray,
    diagonal: IntArray,
    order: IntArray,
    wq: float,
    wv: float,
    wa: float,
) -> FloatArray:
    """Entries of J = q K + v C + a M."""
    values = np.empty(len(stiffness))
    for s in range(len(stiffness)):
        values[s] = wq * stiffness[s]
    for s in range(len(damping)):
        values[s] += wv * damping[s]
    for i in range(len(order)):
        values[diagonal[i]] += wa * mass[order[i]]
    return values


@loop
def fill(values: FloatArray, band: Any, b: FloatArray) -> None:
    """Put a matrix and right-hand sides (n, P) into the room for them, those of the free DOFs alone."""
    places, room, work, free = band
    room[:] = 0.0
    for s in range(len(places)):
        room[places[s]] = values[s]
    work[:] = 0.0
    for i in range(len(free)):
        for p in range(b.shape[1]):
            work[i, p] = b[free[i], p]


@loop
def solved(room: FloatArray, symmetric: bool, width: int, m: int, work: FloatArray) -> bool:
    """Solve in place; False where that takes a second thought.

    That is where the matrix is not positive definite or a solution is not good: a bad one of any column
    shows in a sum of all.
    """
    matrix, wanted, mixed = room.copy(), np.zeros(m), np.zeros(m + 2 * width)
    shares = shares_of(work, m)
    mix(work, shares, wanted)
    if not in_place(room, symmetric, width, m, work):
        return False
    mix(work, shares, mixed[width : width + m])
    return near(matrix, symmetric, width, mixed, wanted)


@loop
def in_place(room: FloatArray, symmetric: bool, width: int, m: int, work: FloatArray) -> bool:
    """Factorise a band and solve for right-hand sides; False where it is not positive definite."""
    if symmetric:
        if not symmetric_factors(room, width, m):
            return False
        solve_sides(room, width, m, 0, width + 1, 1, True, work)
        return True
    if not general_factors(room, width, m):
        return False
    solve_sides(room, width, m, width, 2 * width + 1, 2 * width, False, work)
    return True


@loop
def shares_of(columns: FloatArray, m: int) -> FloatArray:
    """Factors of columns (m, 4 K) that make them of like sizes, no two of them the same."""
    shares = np.empty(columns.shape[1])
    for b in range(0, len(shares), 4):
        s0 = s1 = s2 = s3 = 0.0
        for i in range(m):
            x0, x1, x2, x3 = columns[i, b], columns[i, b + 1], columns[i, b + 2], columns[i, b + 3]
            s0, s1, s2, s3 = max(s0, abs(x0)), max(s1, abs(x1)), max(s2, abs(x2)), max(s3, abs(x3))
        shares[b], shares[b + 1], shares[b + 2], shares[b + 3] = s0, s1, s2, s3
    for p in range(len(shares)):
        shares[p] = (0.5 + ((p + 1) * _GOLDEN) % 1.0) / (shares[p] if shares[p] > 0.0 else 1.0)
    return shares


@loop
def mix(columns: FloatArray, shares: FloatArray, out: FloatArray) -> None:
    """Add sums of columns (m, 4 K) with shares (4 K,) to ``out``, shape (m,)."""
    for b in range(0, len(shares), 4):
        s0, s1, s2, s3 = shares[b], shares[b + 1], shares[b + 2], shares[b + 3]
        for i in range(len(out)):
            first = s0 * columns[i, b] + s1 * columns[i, b + 1]
            out[i] += first + s2 * columns[i, b + 2] + s3 * columns[i, b + 3]


@loop
def near(matrix: FloatArray, symmetric: bool, width: int, x: FloatArray, b: FloatArray) -> bool:
    """Whether A x is b (m,), with ``width`` zeros before and after x."""
    m = len(b)
    if symmetric:
        step, left = width + 1, np.zeros(m + width)
        for i in range(m):
            here, found = x[width + i], 0.0
            for k in range(1, step):
                found += matrix[i * step + k] * x[width + i + k]
                left[i + k] += matrix[i * step + k] * here
            left[i] += matrix[i * step] * here + found
    else:
        step, left = 2 * width + 1, np.empty(m)
        for i in range(m):
            found = 0.0
            for k in range(step):
                found += matrix[i * step + k] * x[i + k]
            left[i] = found
    good = True
    for i in range(m):
        good = good and abs(left[i] - b[i]) <= _GOAL
    return good
