"""Blocks of an item into the matrix: by rows of blocks, or entry by entry where these have gaps."""

from __future__ import annotations

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ...geometry.kernel import loop
from ...geometry.vectors import Vector, self_outer
from .slot_loops import SKIPPED


@loop
def add_even(
    slots: IntArray, flipped: BoolArray, row: int, n: int, total: FloatArray, values: FloatArray
) -> None:
    """Add blocks (n (n + 1) / 2, d, d) of pairs of nodes of an item that is not odd."""
    d, m = total.shape[1], 0
    for i in range(n):
        for j in range(i, n):
            if slots[row, m * d] != SKIPPED:
                for a in range(d):
                    first = a if i == j else 0
                    begin = slots[row, m * d + a]
                    for b in range(first, d):
                        entry = total[m, b, a] if flipped[row, m] else total[m, a, b]
                        values[begin + np.uint32(b - first)] += entry
            m += 1


@loop
def add_odd(entries: IntArray, place: int, n: int, total: FloatArray, values: FloatArray) -> None:
    """The same of an item that is odd, entry by entry."""
    d, k, first = total.shape[1], 0, 0
    for i in range(n):
        for a in range(d):
            for j in range(i, n):
                for b in range(a if i == j else 0, d):
                    values[entries[place, k]] += total[first + j - i, a, b]
                    k += 1
        first += n - i


@loop
def add_in_space(slots: IntArray, row: int, n: int, total: FloatArray, values: FloatArray) -> None:
    """Add packed symmetric blocks of pairs of nodes of an item that is not odd; space has three axes."""
    m = 0
    for i in range(n):
        for j in range(i, n):
            # unsigned all along: numbers that might be negative are looked at before they are used
            first, second, third = slots[row, 3 * m], slots[row, 3 * m + 1], slots[row, 3 * m + 2]
            if first != SKIPPED:
                if i != j:
                    values[second] += total[m, 1]
                    values[third] += total[m, 2]
                    values[third + np.uint32(1)] += total[m, 4]
                    second += np.uint32(1)
                    third += np.uint32(2)
                values[first] += total[m, 0]
                values[first + np.uint32(1)] += total[m, 1]
                values[first + np.uint32(2)] += total[m, 2]
                values[second] += total[m, 3]
                values[second + np.uint32(1)] += total[m, 4]
                values[third] += total[m, 5]
            m += 1


@loop
def add_above(slots: IntArray, row: int, n: int, flat: FloatArray, up: Vector, values: FloatArray) -> None:
    """Add factors (n (n + 1) / 2,) of pairs of nodes times n n^T of a normal; see :func:`add_in_space`."""
    xx, xy, xz, yy, yz, zz = self_outer(up)
    m = 0
    for i in range(n):
        for j in range(i, n):
            first, second, third = slots[row, 3 * m], slots[row, 3 * m + 1], slots[row, 3 * m + 2]
            if first != SKIPPED:
                level = flat[m]
                if i != j:
                    values[second] += level * xy
                    values[third] += level * xz
                    values[third + np.uint32(1)] += level * yz
                    second += np.uint32(1)
                    third += np.uint32(2)
                values[first] += level * xx
                values[first + np.uint32(1)] += level * xy
                values[first + np.uint32(2)] += level * xz
                values[second] += level * yy
                values[second + np.uint32(1)] += level * yz
                values[third] += level * zz
            m += 1


@loop
def join(flat: FloatArray, up: Vector, total: FloatArray) -> None:
    """Add factors of pairs of nodes times n n^T of a normal to packed blocks."""
    square = self_outer(up)
    for m in range(len(flat)):
        for q in range(6):
            total[m, q] += flat[m] * square[q]


@loop
def unpack(axes: IntArray, packed: FloatArray, total: FloatArray) -> None:
    """Write the entries that the model has of packed symmetric blocks (K, 6) as blocks (K, d, d)."""
    for m in range(len(packed)):
        for a in range(len(axes)):
            for b in range(len(axes)):
                low, high = min(axes[a], axes[b]), max(axes[a], axes[b])
                total[m, a, b] = packed[m, 3 * low - low * (low - 1) // 2 + high - low]
