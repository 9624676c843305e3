"""Points of contact on a table of pieces, one by one: what :func:`.points.round_points` does in batches."""

from __future__ import annotations

from ...arrays import FloatArray, IntArray
from ...geometry.kernel import loop
from ..law.quadrature import GAUSS, density, secant
from .line_loops import AXIS, EDGE, FACED, HIGH, IDENTITY, LOW, SLOPE, START

SCALARS = ("s", "energy", "pull", "along", "load", "growth", "identity", "axis", "turn")
"""Rows of ``numbers`` in :func:`fill_points`."""


@loop
def fill_points(
    rows: IntArray,
    piece_item: IntArray,
    table: FloatArray,
    reach: FloatArray,
    factor: FloatArray,
    item: IntArray,
    numbers: FloatArray,
    vectors: FloatArray,
    weights: FloatArray,
    spread: FloatArray,
) -> None:
    """Three Gauss points on each piece.

    Args:
        rows: Items that were looked at, shape (K,).
        piece_item: Which of these each piece is of, shape (at least P,).
        table: The pieces, shape (at least P, 13 + 2 m), or 13 + 5 m with gradients.
        reach: H of the items [m], shape (K,).
        factor: Stiffness times rest length times sign of these [N/m], shape (K,).
        item: Item of each point, shape (3 P,).
        numbers: As ``SCALARS`` says, shape (9, 3 P).
        vectors: Gap, normal and axis of each point, shape (3, 3, 3 P).
        weights: Shape (2 + m, 3 P).
        spread: Slopes of the weights, shape (2 + m, 3, 3 P), or none of them where stiffness is that of the
            secant.
    """
    faced = len(weights) - 2
    for p in range(len(item) // 3):
        k = piece_item[p]
        low, high = table[p, LOW], table[p, HIGH]
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        for g in range(3):
            at = 3 * p + g
            place, weight = GAUSS[g]
            s = middle + place * half
            square = 0.0
            for i in range(3):
                vectors[0, i, at] = table[p, START + i] + s * table[p, SLOPE + i]
                square += vectors[0, i, at] * vectors[0, i, at]
            energy, pull, along, load, growth, turn = density(
                square, reach[k], factor[k] * (2.0 * weight * half)
            )
            if not len(spread):
                along = secant(along, square, reach[k])
            item[at] = rows[k]
            numbers[0, at] = s
            numbers[1, at] = energy
            numbers[2, at] = pull
            numbers[3, at] = along
            numbers[4, at] = load
            numbers[5, at] = growth
            numbers[6, at] = table[p, IDENTITY]
            numbers[7, at] = table[p, AXIS]
            numbers[8, at] = turn
            for i in range(3):
                vectors[1, i, at] = vectors[0, i, at] * turn
                vectors[2, i, at] = table[p, EDGE + i]
            weights[0, at] = 1.0 - s
            weights[1, at] = s
            for i in range(faced):
                weights[2 + i, at] = -(table[p, FACED + i] + s * table[p, FACED + faced + i])
            if len(spread):
                for j in range(3):
                    spread[0, j, at] = 0.0
                    spread[1, j, at] = 0.0
                    for i in range(faced):
                        spread[2 + i, j, at] = table[p, FACED + 2 * faced + 3 * i + j]
