"""Sums over points of contact, one by one: what :mod:`.stencils` does in batches."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..geometry.kernel import loop
from .quadrature import second_derivative


@loop
def add_weighted(
    dofs: IntArray, axes: IntArray, item: IntArray, weights: FloatArray, vector: FloatArray, r: FloatArray
) -> None:
    """Add weights (n, K) times a vector (3, K) of each point to the nodes of its item.

    Args:
        dofs: Of the nodes of each item, shape (S, n d).
        axes: The d axes that the model has.
        item: Of each point, shape (K,).
        weights: Shape (n, K).
        vector: Shape (3, K).
        r: Added to, shape (DOFs,).
    """
    d, n = len(axes), len(weights)
    total = np.zeros(n * d)
    for k in range(len(item)):
        for i in range(n):
            for a in range(d):
                total[i * d + a] += weights[i, k] * vector[axes[a], k]
        # points of an item follow each other
        if k + 1 == len(item) or item[k + 1] != item[k]:
            for m in range(n * d):
                r[dofs[item[k], m]] += total[m]
                total[m] = 0.0


@loop
def _order(n: int, axes: IntArray, pair: IntArray, entry: IntArray) -> None:
    """Which pair of nodes and which entry of a packed block each entry of an upper triangle is."""
    d, m, first = len(axes), 0, 0
    for i in range(n):
        for row in range(d):
            for j in range(i, n):
                for column in range(row if j == i else 0, d):
                    a, b = min(axes[row], axes[column]), max(axes[row], axes[column])
                    pair[m] = first + j - i
                    entry[m] = 3 * a - a * (a - 1) // 2 + b - a
                    m += 1
        first += n - i


@loop
def _squared(factor: float, x: float, y: float, z: float, out: FloatArray) -> None:
    """A factor times the dyad of a vector, packed."""
    out[0] = factor * x * x
    out[1] = factor * x * y
    out[2] = factor * x * z
    out[3] = factor * y * y
    out[4] = factor * y * z
    out[5] = factor * z * z


@loop
def add_squares(
    slots: IntArray,
    axes: IntArray,
    item: IntArray,
    weights: FloatArray,
    gap: FloatArray,
    factors: FloatArray,
    axis: FloatArray,
    e: FloatArray,
    values: FloatArray,
) -> None:
    """Add factors (K,) times u u^T with u_i = w_i x to the upper triangles of the items of points.

    Above a face all gaps of an item are along its normal: there the weights are summed first.

    Args:
        slots: Of the upper triangle of each item by rows, shape (S, n d (n d + 1) / 2).
        axes: The d axes that the model has.
        item: Of each point, shape (K,).
        weights: Shape (n, K).
        gap: x, shape (3, K).
        factors: Shape (K,).
        axis: 1 above a face, shape (K,); see :mod:`.points`.
        e: The normal of the face there, shape (3, K).
        values: Stored entries, added to, shape (slots,).
    """
    n = len(weights)
    pair, entry = np.empty(slots.shape[1], dtype=np.int64), np.empty(slots.shape[1], dtype=np.int64)
    _order(n, axes, pair, entry)
    # sums of w_i w_j x x^T by pairs of nodes, and of w_i w_j |x|^2 above a face
    total, flat = np.zeros((n * (n + 1) // 2, 6)), np.zeros(n * (n + 1) // 2)
    square, upright, above, beside = np.empty(6), np.empty(6), False, False
    for k in range(len(item)):
        if axis[k] == 1.0:
            above = True
            _squared(1.0, e[0, k], e[1, k], e[2, k], upright)
            height = gap[0, k] * e[0, k] + gap[1, k] * e[1, k] + gap[2, k] * e[2, k]
            factor, m = factors[k] * height * height, 0
            for i in range(n):
                level = factor * weights[i, k]
                for j in range(i, n):
                    flat[m] += level * weights[j, k]
                    m += 1
        else:
            beside = True
            _squared(factors[k], gap[0, k], gap[1, k], gap[2, k], square)
            m = 0
            for i in range(n):
                for j in range(i, n):
                    both = weights[i, k] * weights[j, k]
                    for q in range(6):
                        total[m, q] += both * square[q]
                    m += 1
        # points of an item follow each other
        if k + 1 == len(item) or item[k + 1] != item[k]:
            row = item[k]
            if above:
                for m in range(len(pair)):
                    values[slots[row, m]] += flat[pair[m]] * upright[entry[m]]
                flat[:] = 0.0
                above = False
            if beside:
                for m in range(len(pair)):
                    values[slots[row, m]] += total[pair[m], entry[m]]
                total[:] = 0.0
                beside = False


@loop
def add_hessians(
    slots: IntArray,
    axes: IntArray,
    item: IntArray,
    weights: FloatArray,
    spread: FloatArray,
    gap: FloatArray,
    e: FloatArray,
    along: FloatArray,
    bend: FloatArray,
    identity: FloatArray,
    axis: FloatArray,
    values: FloatArray,
) -> None:
    """Add the second derivatives of the energies of points; see :class:`.points.Points` and above."""
    d, n = len(axes), len(weights)
    total = np.zeros(slots.shape[1])
    for k in range(len(item)):
        m = 0
        for i in range(n):
            for row in range(d):
                a = axes[row]
                for j in range(i, n):
                    both = 0.0
                    for b in range(3):
                        both += spread[i, b, k] * spread[j, b, k]
                    for column in range(row if j == i else 0, d):
                        b = axes[column]
                        shape = axis[k] * e[a, k] * e[b, k]
                        if a == b:
                            shape += identity[k]
                        total[m] += second_derivative(
                            along[k],
                            bend[k],
                            weights[i, k],
                            weights[j, k],
                            both,
                            spread[i, b, k],
                            spread[j, a, k],
                            gap[a, k],
                            gap[b, k],
                            shape,
                        )
                        m += 1
        if k + 1 == len(item) or item[k + 1] != item[k]:
            for m in range(len(total)):
                values[slots[item[k], m]] += total[m]
                total[m] = 0.0


@loop
def add_upper_blocks(
    slots: IntArray,
    axes: IntArray,
    item: IntArray,
    weights: FloatArray,
    block: FloatArray,
    values: FloatArray,
) -> None:
    """Add w_i w_j B with symmetric B (9, K) of each point to the upper triangle of its item."""
    d, n = len(axes), len(weights)
    for k in range(len(item)):
        m = 0
        for i in range(n):
            for row in range(d):
                for j in range(i, n):
                    for column in range(row if j == i else 0, d):
                        entry = weights[i, k] * weights[j, k] * block[3 * axes[row] + axes[column], k]
                        values[slots[item[k], m]] += entry
                        m += 1


@loop
def add_blocks(
    slots: IntArray,
    axes: IntArray,
    item: IntArray,
    weights: FloatArray,
    block: FloatArray,
    values: FloatArray,
) -> None:
    """Add w_i w_j B with B (9, K) of each point to the whole matrix of its item, slots (S, (n d)^2)."""
    d, n = len(axes), len(weights)
    for k in range(len(item)):
        m = 0
        for i in range(n):
            for row in range(d):
                for j in range(n):
                    for column in range(d):
                        entry = weights[i, k] * weights[j, k] * block[3 * axes[row] + axes[column], k]
                        values[slots[item[k], m]] += entry
                        m += 1
