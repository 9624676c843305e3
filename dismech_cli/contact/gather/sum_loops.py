"""Sums over points of contact, one by one: what :mod:`.stencils` does in batches.

Points of an item follow each other: they are summed before they are added.
"""

from __future__ import annotations

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ...geometry.kernel import loop
from ...geometry.vectors import dot, self_outer
from ..law.quadrature import second_derivative
from .scatter_loops import add_above, add_even, add_in_space, add_odd, join, unpack


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
        if k + 1 == len(item) or item[k + 1] != item[k]:
            for m in range(n * d):
                r[dofs[item[k], m]] += total[m]
                total[m] = 0.0


@loop
def add_squares(
    dofs: IntArray,
    axes: IntArray,
    slots: IntArray,
    flipped: BoolArray,
    odd: IntArray,
    entries: IntArray,
    item: IntArray,
    weights: FloatArray,
    gap: FloatArray,
    pull: FloatArray,
    along: FloatArray,
    axis: FloatArray,
    e: FloatArray,
    r: FloatArray,
    values: FloatArray,
) -> None:
    """Add forces, and stiffnesses along the gap (K,) times u u^T with u_i = w_i x to the matrix.

    Above a face all gaps of an item are along its normal: there the weights are summed first.

    Args:
        dofs: Of the nodes of each item, shape (S, n d).
        axes: The d axes that the model has.
        slots: See :func:`.slot_loops.find_blocks`.
        flipped: See there.
        odd: See there.
        entries: Slots of the upper triangles of the items that are odd.
        item: Of each point, shape (K,).
        weights: Shape (n, K).
        gap: x, shape (3, K).
        pull: Of forces, shape (K,); see :mod:`.points`.
        along: Shape (K,).
        axis: 1 above a face, shape (K,); see :mod:`.points`.
        e: The normal of the face there, shape (3, K).
        r: Forces are added to, shape (DOFs,).
        values: Stored entries, added to, shape (slots,).
    """
    d, n = len(axes), len(weights)
    # sums of w_i w_j x x^T by pairs of nodes, and of w_i w_j |x|^2 above a face; of w_i x, and of w_i |x|
    total, flat = np.zeros((n * (n + 1) // 2, 6)), np.zeros(n * (n + 1) // 2)
    force, push = np.zeros((n, 3)), np.zeros(n)
    above, beside, up, blocks = False, False, (0.0, 0.0, 0.0), np.empty((len(flat), d, d))
    for k in range(len(item)):
        x = (gap[0, k], gap[1, k], gap[2, k])
        m = 0
        if axis[k] == 1.0:
            above, up = True, (e[0, k], e[1, k], e[2, k])
            height = dot(x, up)
            factor = along[k] * height * height
            for i in range(n):
                push[i] += pull[k] * height * weights[i, k]
                level = factor * weights[i, k]
                for j in range(i, n):
                    flat[m] += level * weights[j, k]
                    m += 1
        else:
            beside = True
            square = self_outer(x)
            for i in range(n):
                drawn, level = pull[k] * weights[i, k], along[k] * weights[i, k]
                for a in range(3):
                    force[i, a] += drawn * x[a]
                for j in range(i, n):
                    both = level * weights[j, k]
                    total[m, 0] += both * square[0]
                    total[m, 1] += both * square[1]
                    total[m, 2] += both * square[2]
                    total[m, 3] += both * square[3]
                    total[m, 4] += both * square[4]
                    total[m, 5] += both * square[5]
                    m += 1
        if k + 1 == len(item) or item[k + 1] != item[k]:
            row = item[k]
            for i in range(n):
                for a in range(d):
                    r[dofs[row, i * d + a]] += force[i, axes[a]] + push[i] * up[axes[a]]
                for a in range(3):
                    force[i, a] = 0.0
                push[i] = 0.0
            if above and not beside and d == 3 and odd[row] < 0:
                add_above(slots, row, n, flat, up, values)
            else:
                if above:
                    join(flat, up, total)
                if d == 3 and odd[row] < 0:
                    add_in_space(slots, row, n, total, values)
                else:
                    unpack(axes, total, blocks)
                    if odd[row] < 0:
                        add_even(slots, flipped, row, n, blocks, values)
                    else:
                        add_odd(entries, odd[row], n, blocks, values)
                for m in range(len(total)):
                    for q in range(6):
                        total[m, q] = 0.0
            if above:
                for m in range(len(flat)):
                    flat[m] = 0.0
            above = beside = False


@loop
def add_hessians(
    dofs: IntArray,
    axes: IntArray,
    slots: IntArray,
    flipped: BoolArray,
    odd: IntArray,
    entries: IntArray,
    item: IntArray,
    weights: FloatArray,
    gap: FloatArray,
    pull: FloatArray,
    along: FloatArray,
    axis: FloatArray,
    e: FloatArray,
    identity: FloatArray,
    spread: FloatArray,
    bend: FloatArray,
    r: FloatArray,
    values: FloatArray,
) -> None:
    """Add forces and second derivatives of the energies of points; see :class:`.points.Points` and above."""
    d, n = len(axes), len(weights)
    total, force = np.zeros((n * (n + 1) // 2, d, d)), np.zeros((n, d))
    for k in range(len(item)):
        m = 0
        for i in range(n):
            for row in range(d):
                force[i, row] += pull[k] * weights[i, k] * gap[axes[row], k]
            for j in range(i, n):
                both = 0.0
                for b in range(3):
                    both += spread[i, b, k] * spread[j, b, k]
                for row in range(d):
                    a = axes[row]
                    for column in range(row if j == i else 0, d):
                        b = axes[column]
                        shape = axis[k] * e[a, k] * e[b, k]
                        if a == b:
                            shape += identity[k]
                        total[m, row, column] += second_derivative(
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
            row = item[k]
            for i in range(n):
                for a in range(d):
                    r[dofs[row, i * d + a]] += force[i, a]
                    force[i, a] = 0.0
            if odd[row] < 0:
                add_even(slots, flipped, row, n, total, values)
            else:
                add_odd(entries, odd[row], n, total, values)
            total[:] = 0.0


@loop
def add_upper_blocks(
    axes: IntArray,
    slots: IntArray,
    flipped: BoolArray,
    odd: IntArray,
    entries: IntArray,
    item: IntArray,
    weights: FloatArray,
    block: FloatArray,
    values: FloatArray,
) -> None:
    """Add w_i w_j B with symmetric B (9, K) of each point to the upper triangle of its item."""
    d, n = len(axes), len(weights)
    total = np.zeros((n * (n + 1) // 2, d, d))
    for k in range(len(item)):
        m = 0
        for i in range(n):
            for j in range(i, n):
                both = weights[i, k] * weights[j, k]
                for a in range(d):
                    for b in range(d):
                        total[m, a, b] += both * block[3 * axes[a] + axes[b], k]
                m += 1
        if k + 1 == len(item) or item[k + 1] != item[k]:
            if odd[item[k]] < 0:
                add_even(slots, flipped, item[k], n, total, values)
            else:
                add_odd(entries, odd[item[k]], n, total, values)
            total[:] = 0.0


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
