"""Pieces of lines that are within reach of a triangle: a loop that goes through pairs one by one.

What :mod:`.facing_triangle` does in batches. A pair is written into a small table first, then the
pieces of its line, a row each: low, high, gap at s = 0, its slope, and the feature that they face.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from ...arrays import FloatArray, IntArray
from ...geometry.kernel import kernel, loop
from ...geometry.vectors import Vector, combine, cross, dot, scale, sub
from .line_loops import FACED, least, node, write_piece, write_segment

# Rows of the table of a pair, by corner or side i: offset from the corner to the start of the line, side,
# normal of the side in the plane; places along the sides at s = 0 and their slopes, heights above them and
# their slopes; the line and the unit normal of the triangle.
_OFFSET: Final = 0
_SIDE: Final = 3
_INWARD: Final = 6
_T0: Final = 9
_T1: Final = 10
_H0: Final = 11
_H1: Final = 12
_LINE: Final = 13
_NORMAL: Final = 14
PAIR_ROWS: Final = 15
MOST_PIECES: Final = 10


@kernel
def _row(table: FloatArray, i: Any) -> Vector:
    return (table[i, 0], table[i, 1], table[i, 2])


@kernel
def _put(table: FloatArray, i: Any, v: Vector) -> None:
    for a in range(3):
        table[i, a] = v[a]


@loop
def lay_pair(x: FloatArray, nodes: IntArray, row: int, pair: FloatArray) -> None:
    """Write a pair into its table."""
    start = node(x, nodes[row, 0])
    slope = sub(node(x, nodes[row, 1]), start)
    _put(pair, _LINE, slope)
    for i in range(3):
        corner = node(x, nodes[row, 2 + i])
        _put(pair, _OFFSET + i, sub(start, corner))
        _put(pair, _SIDE + i, sub(node(x, nodes[row, 2 + (i + 1) % 3]), corner))
    normal = cross(_row(pair, _SIDE), _row(pair, _SIDE + 1))
    square = dot(normal, normal)
    _put(pair, _NORMAL, scale(1.0 / np.sqrt(square), normal))
    for i in range(3):
        side, offset = _row(pair, _SIDE + i), _row(pair, _OFFSET + i)
        inward = scale(1.0 / square, cross(normal, side))
        share = scale(1.0 / dot(side, side), side)
        _put(pair, _INWARD + i, inward)
        pair[_T0, i] = dot(offset, share)
        pair[_T1, i] = dot(slope, share)
        pair[_H0, i] = dot(offset, inward)
        pair[_H1, i] = dot(slope, inward)


@loop
def _feature(pair: FloatArray, s: float) -> int:
    """What is nearest at a place of the line: 0 the inside, 1 to 3 a side, 4 to 6 a corner."""
    inside = True
    for i in range(3):
        inside = inside and pair[_H0, i] + s * pair[_H1, i] >= 0.0
    if inside:
        return 0
    for i in range(3):
        t = pair[_T0, i] + s * pair[_T1, i]
        if pair[_H0, i] + s * pair[_H1, i] < 0.0 and 0.0 < t < 1.0:
            return 1 + i
    corner, best = 0, np.inf
    for i in range(3):
        gap = combine(1.0, _row(pair, _OFFSET + i), s, _row(pair, _LINE))
        square = dot(gap, gap)
        if square < best:
            corner, best = i, square
    return 4 + corner


@loop
def cut_line(pair: FloatArray, cuts: FloatArray, pieces: FloatArray) -> int:
    """Write the pieces of the line of a pair; their number."""
    count = 1
    cuts[0] = 0.0
    for plane in range(9):
        i = plane % 3
        if plane < 3:
            ahead, growth = pair[_T0, i], pair[_T1, i]
        elif plane < 6:
            ahead, growth = pair[_T0, i] - 1.0, pair[_T1, i]
        else:
            ahead, growth = pair[_H0, i], pair[_H1, i]
        # most lines pass few of the planes, and a quotient takes long
        if ahead * (ahead + growth) >= 0.0:
            continue
        cut = -ahead / growth
        if 0.0 < cut < 1.0:
            place = count
            while cuts[place - 1] > cut:
                cuts[place] = cuts[place - 1]
                place -= 1
            cuts[place] = cut
            count += 1
    cuts[count] = 1.0
    found = 0
    slope = _row(pair, _LINE)
    for k in range(count):
        low, high = cuts[k], cuts[k + 1]
        if high > low:
            feature = _feature(pair, 0.5 * (low + high))
            if found > 0 and pieces[found - 1, 8] == feature:
                pieces[found - 1, 1] = high
                continue
            if feature == 0:
                n = _row(pair, _NORMAL)
                gap, turn = scale(dot(n, _row(pair, _OFFSET)), n), scale(dot(n, slope), n)
            elif feature < 4:
                i = feature - 1
                u = _row(pair, _SIDE + i)
                gap = combine(1.0, _row(pair, _OFFSET + i), -pair[_T0, i], u)
                turn = combine(1.0, slope, -pair[_T1, i], u)
            else:
                gap, turn = _row(pair, _OFFSET + feature - 4), slope
            pieces[found, 0] = low
            pieces[found, 1] = high
            for a in range(3):
                pieces[found, 2 + a] = gap[a]
                pieces[found, 5 + a] = turn[a]
            pieces[found, 8] = feature
            found += 1
    return found


@loop
def _apart(x: FloatArray, more: FloatArray, nodes: IntArray, row: int) -> float:
    """Square of the distance of the boxes of the line and of the triangle of a pair, at two places."""
    square = 0.0
    for a in range(3):
        low_line = high_line = x[nodes[row, 0], a]
        low_face = high_face = x[nodes[row, 2], a]
        for k in range(5):
            one, other = x[nodes[row, k], a], more[nodes[row, k], a]
            low, high = min(one, other), max(one, other)
            if k < 2:
                low_line, high_line = min(low_line, low), max(high_line, high)
            else:
                low_face, high_face = min(low_face, low), max(high_face, high)
        gap = max(low_line - high_face, low_face - high_line, 0.0)
        square += gap * gap
    return square


@loop
def boxes_apart(x: FloatArray, more: FloatArray, nodes: IntArray, out: FloatArray) -> None:
    """Distances of the boxes of lines and triangles, nodes (P, 5), at two places of the nodes [m]."""
    for k in range(len(out)):
        out[k] = np.sqrt(_apart(x, more, nodes, k))


@loop
def _beyond(pair: FloatArray) -> float:
    """Square of how far at least a line is outside of a side of its triangle or on one side of its plane."""
    one = dot(_row(pair, _NORMAL), _row(pair, _OFFSET))
    other = one + dot(_row(pair, _NORMAL), _row(pair, _LINE))
    square = min(one * one, other * other) if one * other > 0.0 else 0.0
    for i in range(3):
        high = max(pair[_H0, i], pair[_H0, i] + pair[_H1, i])
        if high < 0.0:
            inward = _row(pair, _INWARD + i)
            square = max(square, high * high / dot(inward, inward))
    return float(square)


@loop
def face_bounds(x: FloatArray, nodes: IntArray, limit: FloatArray, out: FloatArray) -> None:
    """What distances of lines from triangles are no less than, in a part of their time.

    Args:
        x: Nodes [m], shape (N, 3).
        nodes: Of lines and triangles, shape (P, 5).
        limit: What is this far away need not be told [m], shape (P,).
        out: The bounds [m], infinite where they are no less than the limit, shape (P,).
    """
    pair = np.empty((PAIR_ROWS, 3))
    for k in range(len(out)):
        out[k] = np.inf
        if _apart(x, x, nodes, k) < limit[k] * limit[k]:
            lay_pair(x, nodes, k, pair)
            square = _beyond(pair)
            if square < limit[k] * limit[k]:
                out[k] = np.sqrt(square)


@loop
def cut_distance(pair: FloatArray, cuts: FloatArray, pieces: FloatArray) -> float:
    """Distance of the line of a pair from its triangle, whose pieces are written on the way."""
    best = np.inf
    for p in range(cut_line(pair, cuts, pieces)):
        gap = (pieces[p, 2], pieces[p, 3], pieces[p, 4])
        turn = (pieces[p, 5], pieces[p, 6], pieces[p, 7])
        best = min(best, least(gap, turn, pieces[p, 0], pieces[p, 1]))
    distance: float = np.sqrt(best)
    return distance


@loop
def face_distances(x: FloatArray, nodes: IntArray, limit: FloatArray, out: FloatArray) -> None:
    """Distances of lines from triangles.

    Args:
        x: Nodes [m], shape (N, 3).
        nodes: Of lines and triangles, shape (P, 5).
        limit: What is this far away need not be measured [m], shape (P,).
        out: Distances [m], infinite where they are no less than the limit, shape (P,).
    """
    pair, cuts, pieces = np.empty((PAIR_ROWS, 3)), np.empty(11), np.empty((MOST_PIECES, 9))
    for k in range(len(out)):
        out[k] = np.inf
        if _apart(x, x, nodes, k) < limit[k] * limit[k]:
            lay_pair(x, nodes, k, pair)
            if _beyond(pair) < limit[k] * limit[k]:
                distance = cut_distance(pair, cuts, pieces)
                if distance < limit[k]:
                    out[k] = distance


@loop
def write_facing(
    table: FloatArray,
    k: int,
    low: float,
    high: float,
    gap: Vector,
    turn: Vector,
    pair: FloatArray,
    feature: int,
) -> None:
    """Write a piece that faces a feature of a triangle, as a row of 19 columns; see :mod:`.line_loops`."""
    for column in range(FACED, FACED + 6):
        table[k, column] = 0.0
    if feature == 0:
        write_piece(table, k, low, high, gap, turn, 0.0, 1.0, _row(pair, _NORMAL))
        # the weight of a corner is the height above the side across from it
        for i in range(3):
            across = (i + 1) % 3
            table[k, FACED + i] = pair[_H0, across]
            table[k, FACED + 3 + i] = pair[_H1, across]
    elif feature < 4:
        i = feature - 1
        u = _row(pair, _SIDE + i)
        write_piece(table, k, low, high, gap, turn, 1.0, -1.0, scale(1.0 / np.sqrt(dot(u, u)), u))
        write_segment(table, k, 3, i, feature % 3, pair[_T0, i], pair[_T1, i])
    else:
        write_piece(table, k, low, high, gap, turn, 1.0, 0.0, (0.0, 0.0, 0.0))
        table[k, FACED + feature - 4] = 1.0
