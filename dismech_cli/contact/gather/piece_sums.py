"""Sums over the pieces of lines that touch, straight to the matrix: no points are laid down on the way.

On a piece the gap x = x0 + s x1 and all weights w_i = p_i + s q_i are linear, so that sums over its points
need no more of these than moments: sums of powers of s times what does not depend on the nodes.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ...geometry.kernel import kernel, loop
from ...geometry.vectors import combine, combine_symmetric, dot, self_outer
from ..law.quadrature import GAUSS, density, secant
from ..pieces.line_loops import AXIS, EDGE, FACED, HIGH, IDENTITY, LOW, SLOPE, START
from .scatter_loops import add_even, add_odd


@kernel
def _column(pieces: FloatArray, k: Any, first: Any) -> Any:
    return (pieces[k, first], pieces[k, first + 1], pieces[k, first + 2])


@loop
def _lay_weights(pieces: FloatArray, k: int, p: FloatArray, q: FloatArray) -> None:
    """Weights of the nodes at s = 0 and their slopes."""
    faced = len(p) - 2
    p[0], p[1], q[0], q[1] = 1.0, 0.0, -1.0, 1.0
    for i in range(faced):
        p[2 + i] = -pieces[k, FACED + i]
        q[2 + i] = -pieces[k, FACED + faced + i]


@loop
def sum_squares(
    every: tuple[int, ...],
    dofs: IntArray,
    axes: IntArray,
    blocks: IntArray,
    rows: IntArray,
    piece_item: IntArray,
    pieces: FloatArray,
    reach: FloatArray,
    factor: FloatArray,
    r: FloatArray,
    packed: FloatArray,
) -> None:
    """Add forces, and stiffnesses of the secant along the gap to packed blocks.

    Above a face all gaps of a piece are along its normal: there no more than weights are summed.

    Args:
        every: Numbers of the n nodes: a tuple, whose length is known where this is compiled.
        dofs: Of the nodes of each item, shape (S, n d).
        axes: The d axes that the model has.
        blocks: See :func:`.packed_loops.find_pairs`.
        rows: See :class:`.strips.Table`.
        piece_item: See there.
        pieces: See there.
        reach: See there.
        factor: See there.
        r: Forces are added to, shape (DOFs,).
        packed: Blocks, added to, shape (B, 8).
    """
    d, n = len(axes), len(every)
    p, q, force = np.empty(n), np.empty(n), np.empty((n, 3))
    for k in range(len(piece_item)):
        item = piece_item[k]
        row, h = rows[item], reach[item]
        low, high = pieces[k, LOW], pieces[k, HIGH]
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        start, slope = _column(pieces, k, START), _column(pieces, k, SLOPE)
        _lay_weights(pieces, k, p, q)
        m = 0
        if pieces[k, AXIS] == 1.0:
            up = _column(pieces, k, EDGE)
            at_start, growth, square = dot(start, up), dot(slope, up), self_outer(up)
            # moments of pull times height, and of stiffness times its square
            a0 = a1 = c0 = c1 = c2 = 0.0
            for g in range(3):
                place, weight = GAUSS[g]
                s = middle + place * half
                height = at_start + s * growth
                _, pull, along, _, _, _ = density(height * height, h, factor[item] * (2.0 * weight * half))
                drawn, stiff = pull * height, secant(along, height * height, h) * height * height
                a0 += drawn
                a1 += drawn * s
                c0 += stiff
                c1 += stiff * s
                c2 += stiff * s * s
            for i in range(n):
                push = p[i] * a0 + q[i] * a1
                for a in range(3):
                    force[i, a] = push * up[a]
                one, other = p[i] * c0 + q[i] * c1, p[i] * c1 + q[i] * c2
                for j in range(i, n):
                    block, level = blocks[row, m], one * p[j] + other * q[j]
                    packed[block, 0] += level * square[0]
                    packed[block, 1] += level * square[1]
                    packed[block, 2] += level * square[2]
                    packed[block, 3] += level * square[3]
                    packed[block, 4] += level * square[4]
                    packed[block, 5] += level * square[5]
                    m += 1
        else:
            # moments of pull times gap, and of stiffness times its square
            f0 = f1 = (0.0, 0.0, 0.0)
            t0 = t1 = t2 = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
            for g in range(3):
                place, weight = GAUSS[g]
                s = middle + place * half
                x = combine(1.0, start, s, slope)
                _, pull, along, _, _, _ = density(dot(x, x), h, factor[item] * (2.0 * weight * half))
                stiff, xx = secant(along, dot(x, x), h), self_outer(x)
                f0, f1 = combine(1.0, f0, pull, x), combine(1.0, f1, pull * s, x)
                t0 = combine_symmetric(1.0, t0, stiff, xx)
                t1 = combine_symmetric(1.0, t1, stiff * s, xx)
                t2 = combine_symmetric(1.0, t2, stiff * s * s, xx)
            for i in range(n):
                for a in range(3):
                    force[i, a] = p[i] * f0[a] + q[i] * f1[a]
                for j in range(i, n):
                    block = blocks[row, m]
                    one, both, other = p[i] * p[j], p[i] * q[j] + q[i] * p[j], q[i] * q[j]
                    packed[block, 0] += one * t0[0] + both * t1[0] + other * t2[0]
                    packed[block, 1] += one * t0[1] + both * t1[1] + other * t2[1]
                    packed[block, 2] += one * t0[2] + both * t1[2] + other * t2[2]
                    packed[block, 3] += one * t0[3] + both * t1[3] + other * t2[3]
                    packed[block, 4] += one * t0[4] + both * t1[4] + other * t2[4]
                    packed[block, 5] += one * t0[5] + both * t1[5] + other * t2[5]
                    m += 1
        for i in range(n):
            for a in range(d):
                r[dofs[row, i * d + a]] += force[i, axes[a]]


@loop
def sum_hessians(
    dofs: IntArray,
    axes: IntArray,
    slots: IntArray,
    flipped: BoolArray,
    odd: IntArray,
    entries: IntArray,
    rows: IntArray,
    piece_item: IntArray,
    pieces: FloatArray,
    reach: FloatArray,
    factor: FloatArray,
    r: FloatArray,
    values: FloatArray,
) -> None:
    """Add forces and second derivatives of the energies of pieces with gradients; see :mod:`.points`."""
    d = len(axes)
    n = dofs.shape[1] // d
    faced = n - 2
    total, blocks = np.zeros((n * (n + 1) // 2, 3, 3)), np.empty((n * (n + 1) // 2, d, d))
    force, pushed, p, q = np.zeros((n, 3)), np.zeros((n, 3)), np.empty(n), np.empty(n)
    spread = np.zeros((n, 3))
    for k in range(len(piece_item)):
        item = piece_item[k]
        row, h = rows[item], reach[item]
        low, high = pieces[k, LOW], pieces[k, HIGH]
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        start, slope, e = _column(pieces, k, START), _column(pieces, k, SLOPE), _column(pieces, k, EDGE)
        _lay_weights(pieces, k, p, q)
        for i in range(faced):
            for a in range(3):
                spread[2 + i, a] = pieces[k, FACED + 2 * faced + 3 * i + a]
        f0 = f1 = (0.0, 0.0, 0.0)
        t0 = t1 = t2 = across = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        b0 = b1 = b2 = 0.0
        for g in range(3):
            place, weight = GAUSS[g]
            s = middle + place * half
            x = combine(1.0, start, s, slope)
            _, pull, along, _, _, _ = density(dot(x, x), h, factor[item] * (2.0 * weight * half))
            xx = self_outer(x)
            f0, f1 = combine(1.0, f0, pull, x), combine(1.0, f1, pull * s, x)
            t0 = combine_symmetric(1.0, t0, along, xx)
            t1 = combine_symmetric(1.0, t1, along * s, xx)
            t2 = combine_symmetric(1.0, t2, along * s * s, xx)
            across = combine_symmetric(1.0, across, pull, xx)
            b0 += pull
            b1 += pull * s
            b2 += pull * s * s
        axis, same, ee = pieces[k, AXIS], pieces[k, IDENTITY], self_outer(e)
        shape = (
            axis * ee[0] + same,
            axis * ee[1],
            axis * ee[2],
            axis * ee[3] + same,
            axis * ee[4],
            axis * ee[5] + same,
        )
        t0, t1, t2 = (
            combine_symmetric(1.0, t0, b0, shape),
            combine_symmetric(1.0, t1, b1, shape),
            combine_symmetric(1.0, t2, b2, shape),
        )
        for i in range(n):
            for a in range(3):
                pushed[i, a] = p[i] * f0[a] + q[i] * f1[a]
                force[i, a] += pushed[i, a]
        m = 0
        for i in range(n):
            for j in range(i, n):
                one, both, other = p[i] * p[j], p[i] * q[j] + q[i] * p[j], q[i] * q[j]
                slopes = (
                    spread[i, 0] * spread[j, 0] + spread[i, 1] * spread[j, 1] + spread[i, 2] * spread[j, 2]
                )
                c = 0
                for a in range(3):
                    for b in range(a, 3):
                        entry = one * t0[c] + both * t1[c] + other * t2[c] - slopes * across[c]
                        total[m, a, b] += entry - spread[j, a] * pushed[i, b] - pushed[j, a] * spread[i, b]
                        if a != b:
                            total[m, b, a] += (
                                entry - spread[j, b] * pushed[i, a] - pushed[j, b] * spread[i, a]
                            )
                        c += 1
                m += 1
        if k + 1 == len(piece_item) or piece_item[k + 1] != item:
            for i in range(n):
                for a in range(d):
                    r[dofs[row, i * d + a]] += force[i, axes[a]]
                for a in range(3):
                    force[i, a] = 0.0
            for m in range(len(total)):
                for a in range(d):
                    for b in range(d):
                        blocks[m, a, b] = total[m, axes[a], axes[b]]
            if odd[row] < 0:
                add_even(slots, flipped, row, n, blocks, values)
            else:
                add_odd(entries, odd[row], n, blocks, values)
            total[:] = 0.0
