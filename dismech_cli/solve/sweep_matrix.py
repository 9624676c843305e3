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
    """Add A^T x, shape (n, P), to ``out``."""
    if symmetric:
        add_product(values, indptr, indices, order, symmetric, x, out)
        return
    for i in range(len(order)):
        for s in range(indptr[i], indptr[i + 1]):
            for p in range(x.shape[1]):
                out[order[indices[s]], p] += values[s] * x[order[i], p]


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
def solved(values: FloatArray, symmetric: bool, width: int, band: Any, b: FloatArray, x: FloatArray) -> bool:
    """Write x of A x = b on the free DOFs, shape (n, P); False where that takes a second thought."""
    places, room, work, free = band
    m, sides = len(free), b.shape[1]
    for i in range(len(room)):
        room[i] = 0.0
    for s in range(len(places)):
        room[places[s]] = values[s]
    for i in range(len(work)):
        for p in range(work.shape[1]):
            work[i, p] = 0.0
    for i in range(m):
        for p in range(sides):
            work[i, p] = b[free[i], p]
    if symmetric:
        if not symmetric_factors(room, width, m):
            return False
        solve_sides(room, width, m, 0, width + 1, 1, True, work)
    else:
        if not general_factors(room, width, m):
            return False
        solve_sides(room, width, m, width, 2 * width + 1, 2 * width, False, work)
    for i in range(m):
        for p in range(sides):
            x[free[i], p] = work[i, p]
    return True


@loop
def sound(
    values: FloatArray,
    indptr: IntArray,
    indices: IntArray,
    order: IntArray,
    symmetric: bool,
    free: IntArray,
    x: FloatArray,
    b: FloatArray,
) -> bool:
    """Whether solutions (n, P) are good: a bad one of any column shows in a sum of all."""
    n, sides = x.shape
    mixed, left = np.zeros((n, 1)), np.zeros((n, 1))
    for p in range(sides):
        largest = 0.0
        for i in range(len(free)):
            largest = max(largest, abs(b[free[i], p]))
        share = (0.5 + ((p + 1) * _GOLDEN) % 1.0) / (largest if largest > 0.0 else 1.0)
        for i in range(len(free)):
            mixed[free[i], 0] += share * x[free[i], p]
            left[free[i], 0] -= share * b[free[i], p]
    add_product(values, indptr, indices, order, symmetric, mixed, left)
    good = True
    for i in range(len(free)):
        good = good and abs(left[free[i], 0]) <= _GOAL
    return good
