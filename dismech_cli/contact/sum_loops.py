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
    d = len(axes)
    for k in range(len(item)):
        for i in range(len(weights)):
            for a in range(d):
                r[dofs[item[k], i * d + a]] += weights[i, k] * vector[axes[a], k]


@loop
def add_squares(
    slots: IntArray,
    axes: IntArray,
    item: IntArray,
    weights: FloatArray,
    gap: FloatArray,
    factors: FloatArray,
    identity: FloatArray,
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
        identity: 0 above a face, shape (K,); see :mod:`.points`.
        e: The normal of the face there, shape (3, K).
        values: Stored entries, added to, shape (slots,).
    """
    d, n = len(axes), len(weights)
    size = n * d
    u, total = np.empty(size), np.zeros(size * (size + 1) // 2)
    w, flat = np.empty(n), np.zeros((n, n))
    above = False
    for k in range(len(item)):
        for i in range(n):
            w[i] = weights[i, k]
        if identity[k] == 0.0:
            above = True
            height = gap[0, k] * e[0, k] + gap[1, k] * e[1, k] + gap[2, k] * e[2, k]
            factor = factors[k] * height * height
            for i in range(n):
                for j in range(i, n):
                    flat[i, j] += factor * w[i] * w[j]
        else:
            for i in range(n):
                for a in range(d):
                    u[i * d + a] = w[i] * gap[axes[a], k]
            m = 0
            for i in range(size):
                row = factors[k] * u[i]
                for j in range(i, size):
                    total[m + j - i] += row * u[j]
                m += size - i
        # points of an item follow each other
        if k + 1 == len(item) or item[k + 1] != item[k]:
            if above:
                m = 0
                for i in range(n):
                    for a in range(d):
                        for j in range(i, n):
                            level = flat[i, j] * e[axes[a], k]
                            for b in range(a if j == i else 0, d):
                                total[m] += level * e[axes[b], k]
                                m += 1
                flat[:] = 0.0
                above = False
            for m in range(len(total)):
                values[slots[item[k], m]] += total[m]
                total[m] = 0.0


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
