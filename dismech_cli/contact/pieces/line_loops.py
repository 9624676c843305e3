"""Pieces of lines that are within reach of a segment or a vertex: loops that go through them one by one.

What :mod:`.cores` and :mod:`.pieces` do in batches, for drivers that compile. A piece is a row of a table,
with columns as named here, then the weights of the m nodes that are faced at s = 0 and their slopes, and,
where curvature counts, their gradients; see :class:`.pieces.Pieces`.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from ...arrays import FloatArray, IntArray
from ...geometry.kernel import kernel, loop
from ...geometry.vectors import Vector, combine, dot, scale, sub
from ..law.quadrature import passing, within

LOW: Final = 0
HIGH: Final = 1
START: Final = 2
SLOPE: Final = 5
IDENTITY: Final = 8
AXIS: Final = 9
EDGE: Final = 10
FACED: Final = 13


def piece_columns(faced: int) -> int:
    """Columns of a table of pieces that face things of so many nodes, without gradients."""
    return FACED + 2 * faced


def spread_columns(faced: int) -> int:
    """The same with gradients."""
    return FACED + 5 * faced


@kernel
def node(x: FloatArray, i: Any) -> Vector:
    """The place of a node."""
    return (x[i, 0], x[i, 1], x[i, 2])


@kernel
def clipped(start: Vector, slope: Vector, reach: Any, low: Any, high: Any) -> Any:
    """The part of a piece within reach."""
    return within(dot(slope, slope), dot(start, slope), dot(start, start) - reach * reach, low, high)


@kernel
def least(start: Vector, slope: Vector, low: Any, high: Any) -> Any:
    """Square of the least length of a gap that is linear on a piece."""
    s = -dot(start, slope) / (dot(slope, slope) + 2.2250738585072014e-308)
    s = np.minimum(np.maximum(s, low), high)
    gap = combine(1.0, start, s, slope)
    return dot(gap, gap)


@kernel
def write_piece(
    table: FloatArray,
    k: int,
    low: Any,
    high: Any,
    start: Vector,
    slope: Vector,
    identity: Any,
    axis: Any,
    e: Vector,
) -> None:
    """Fill the named columns of a row."""
    table[k, LOW] = low
    table[k, HIGH] = high
    for i in range(3):
        table[k, START + i] = start[i]
        table[k, SLOPE + i] = slope[i]
        table[k, EDGE + i] = e[i]
    table[k, IDENTITY] = identity
    table[k, AXIS] = axis


@kernel
def write_segment(
    table: FloatArray,
    k: Any,
    faced: Any,
    first: Any,
    second: Any,
    t0: Any,
    t1: Any,
) -> None:
    """Fill weights and slopes of the nodes that are faced, beside a side from the first to the second."""
    table[k, FACED + first] = 1.0 - t0
    table[k, FACED + second] = t0
    table[k, FACED + faced + first] = -t1
    table[k, FACED + faced + second] = t1


@loop
def segment_distance(start: Vector, slope: Vector, first: Vector, u: Vector) -> float:
    """Distance of a line from a segment that begins at ``first`` and goes along ``u``."""
    square, offset = dot(u, u), sub(start, first)
    t0, t1 = dot(offset, u) / square, dot(slope, u) / square
    early, late = passing(t0, t1)
    best = np.inf
    for part in range(3):
        if part == 2:
            low, high = early, late
            gap, turn = combine(1.0, offset, -t0, u), combine(1.0, slope, -t1, u)
        else:
            before = (part == 0) == (t1 >= 0.0)
            low, high = (0.0, early) if before else (late, 1.0)
            gap, turn = offset if part == 0 else sub(offset, u), slope
        if high > low:
            best = min(best, least(gap, turn, low, high))
    distance: float = np.sqrt(best)
    return distance


@loop
def segment_distances(x: FloatArray, nodes: IntArray, out: FloatArray) -> None:
    """Distances of lines from segments.

    Args:
        x: Nodes [m], shape (N, 3).
        nodes: Of the lines and the segments, shape (P, 4).
        out: Distances [m], shape (P,).
    """
    for k in range(len(out)):
        start, first = node(x, nodes[k, 0]), node(x, nodes[k, 2])
        out[k] = segment_distance(
            start, sub(node(x, nodes[k, 1]), start), first, sub(node(x, nodes[k, 3]), first)
        )


@loop
def closing(way: FloatArray, nodes: IntArray, k: int) -> float:
    """Greatest difference of the ways of the nodes of a line and of those that it faces, nodes (P, n)."""
    most = 0.0
    for i in range(2):
        for j in range(2, nodes.shape[1]):
            apart = sub(node(way, nodes[k, i]), node(way, nodes[k, j]))
            most = max(most, dot(apart, apart))
    difference: float = np.sqrt(most)
    return difference


@loop
def segment_pieces(
    x: FloatArray, nodes: IntArray, rows: IntArray, reach: FloatArray, item: IntArray, table: FloatArray
) -> int:
    """Pieces of lines within reach of segments.

    Args:
        x: Nodes [m], shape (N, 3).
        nodes: Of the lines and the segments, shape (S, 4).
        rows: Those to look at, shape (K,).
        reach: Of these [m], shape (K,).
        item: Which of these each piece is of, shape (capacity,).
        table: The pieces, shape (capacity, 23).

    Returns:
        Number of pieces; those beyond the capacity are not written.
    """
    count = 0
    for k in range(len(rows)):
        row = rows[k]
        start, first = node(x, nodes[row, 0]), node(x, nodes[row, 2])
        slope, u = sub(node(x, nodes[row, 1]), start), sub(node(x, nodes[row, 3]), first)
        square, offset = dot(u, u), sub(start, first)
        t0, t1 = dot(offset, u) / square, dot(slope, u) / square
        early, late = passing(t0, t1)
        for part in range(3):
            if part == 2:
                low, high = early, late
                gap, turn = combine(1.0, offset, -t0, u), combine(1.0, slope, -t1, u)
            else:
                before = (part == 0) == (t1 >= 0.0)
                low, high = (0.0, early) if before else (late, 1.0)
                gap, turn = offset if part == 0 else sub(offset, u), slope
            low, high = clipped(gap, turn, reach[k], low, high)
            if high > low:
                if count < len(item):
                    item[count] = k
                    beside = 1.0 if part == 2 else 0.0
                    write_piece(
                        table, count, low, high, gap, turn, 1.0, -beside, scale(1.0 / np.sqrt(square), u)
                    )
                    if part == 2:
                        write_segment(table, count, 2, 0, 1, t0, t1)
                        for a in range(3):
                            table[count, FACED + 4 + a] = -u[a] / square
                            table[count, FACED + 7 + a] = u[a] / square
                    else:
                        for column in range(FACED, FACED + 10):
                            table[count, column] = 0.0
                        table[count, FACED + part] = 1.0
                count += 1
    return count


@loop
def vertex_pieces(
    x: FloatArray, nodes: IntArray, rows: IntArray, reach: FloatArray, item: IntArray, table: FloatArray
) -> int:
    """Pieces of lines within reach of vertices, nodes (S, 3), in 18 columns; see :func:`segment_pieces`."""
    count = 0
    for k in range(len(rows)):
        row = rows[k]
        start = node(x, nodes[row, 0])
        slope, gap = sub(node(x, nodes[row, 1]), start), sub(start, node(x, nodes[row, 2]))
        low, high = clipped(gap, slope, reach[k], 0.0, 1.0)
        if high > low:
            if count < len(item):
                item[count] = k
                write_piece(table, count, low, high, gap, slope, 1.0, 0.0, (0.0, 0.0, 0.0))
                table[count, FACED] = 1.0
                for column in range(FACED + 1, FACED + 5):
                    table[count, column] = 0.0
            count += 1
    return count
