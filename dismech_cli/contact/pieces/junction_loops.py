"""What is left of triangles, sides and corners that a line faces, one by one: see :mod:`.surface_points`.

A span is a row: where a part of a line begins and ends, and how often it counts.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...arrays import FloatArray, IntArray
from ...geometry.kernel import kernel, loop
from ...geometry.vectors import combine, dot, scale, sub
from ..law.quadrature import passing
from .face_loops import MOST_PIECES, PAIR_ROWS, cut_line, lay_pair, write_facing
from .line_loops import FACED, clipped, node, write_piece, write_segment
from .spans import SLIVER


@kernel
def _note(group: IntArray, span: FloatArray, k: Any, which: Any, low: Any, high: Any, times: Any) -> None:
    group[k] = which
    span[k, 0] = low
    span[k, 1] = high
    span[k, 2] = times


@loop
def face_spans(
    x: FloatArray,
    nodes: IntArray,
    rows: IntArray,
    reach: FloatArray,
    sides_of: IntArray,
    corners_of: IntArray,
    item: IntArray,
    table: FloatArray,
    side: IntArray,
    side_span: FloatArray,
    corner: IntArray,
    corner_span: FloatArray,
    counts: IntArray,
) -> None:
    """Pieces within reach of triangles alone, and spans of those that face what triangles share.

    Args:
        x: Nodes [m], shape (N, 3).
        nodes: Of lines and triangles, shape (P, 5).
        rows: Those to look at, shape (K,).
        reach: Of these [m], shape (K,).
        sides_of: Shared side of each of the pairs, -1 if it is none, shape (P, 3).
        corners_of: Shared corners, likewise.
        item: Which of the K each piece is of, shape (10 K,).
        table: The pieces, shape (10 K, 19).
        side: Group of each span of sides, shape (10 K,) or more.
        side_span: Its span, shape (10 K, 3) or more.
        corner: The same of corners.
        corner_span: The same of corners.
        counts: Pieces, spans of sides and of corners that were written, shape (3,).
    """
    pair, cuts, pieces = np.empty((PAIR_ROWS, 3)), np.empty(11), np.empty((MOST_PIECES, 9))
    for k in range(len(rows)):
        row = rows[k]
        lay_pair(x, nodes, row, pair)
        for p in range(cut_line(pair, cuts, pieces)):
            start, end = pieces[p, 0], pieces[p, 1]
            gap = (pieces[p, 2], pieces[p, 3], pieces[p, 4])
            turn = (pieces[p, 5], pieces[p, 6], pieces[p, 7])
            low, high = clipped(gap, turn, reach[k], start, end)
            if high > low:
                feature = int(pieces[p, 8])
                if 1 <= feature <= 3 and sides_of[row, feature - 1] >= 0:
                    _note(side, side_span, counts[1], sides_of[row, feature - 1], start, end, 1.0)
                    counts[1] += 1
                elif feature > 3 and corners_of[row, feature - 4] >= 0:
                    _note(corner, corner_span, counts[2], corners_of[row, feature - 4], start, end, 1.0)
                    counts[2] += 1
                else:
                    item[counts[0]] = k
                    write_facing(table, counts[0], low, high, gap, turn, pair, feature)
                    counts[0] += 1


@loop
def junction_spans(
    x: FloatArray,
    nodes: IntArray,
    times: FloatArray,
    ends: IntArray,
    corner_times: FloatArray,
    side: IntArray,
    side_span: FloatArray,
    corner: IntArray,
    corner_span: FloatArray,
    counts: IntArray,
) -> None:
    """Go on with the spans of sides and corners themselves.

    Args:
        x: Nodes [m], shape (N, 3).
        nodes: Of lines and sides, shape (S, 4).
        times: How often each side counts, shape (S,).
        ends: Corners of each side, shape (S, 2).
        corner_times: How often each corner counts, shape (C,).
        side: See :func:`face_spans`.
        side_span: See there.
        corner: See there.
        corner_span: See there.
        counts: See there.
    """
    for k in range(len(times)):
        if times[k] != 0.0:
            start, first = node(x, nodes[k, 0]), node(x, nodes[k, 2])
            slope, u = sub(node(x, nodes[k, 1]), start), sub(node(x, nodes[k, 3]), first)
            square, offset = dot(u, u), sub(start, first)
            t1 = dot(slope, u) / square
            early, late = passing(dot(offset, u) / square, t1)
            _note(side, side_span, counts[1], k, early, late, times[k])
            counts[1] += 1
            one, other = (0, 1) if t1 >= 0.0 else (1, 0)
            if early > 0.0:
                _note(corner, corner_span, counts[2], ends[k, one], 0.0, early, times[k])
                counts[2] += 1
            if late < 1.0:
                _note(corner, corner_span, counts[2], ends[k, other], late, 1.0, times[k])
                counts[2] += 1
    for k in range(len(corner_times)):
        if corner_times[k] != 0.0:
            _note(corner, corner_span, counts[2], k, 0.0, 1.0, corner_times[k])
            counts[2] += 1


@loop
def net_spans(
    group: IntArray, span: FloatArray, count: int, groups: int, out_group: IntArray, out: FloatArray
) -> int:
    """Each part of a group once; the number of these, see :meth:`.spans.Spans.net`.

    Args:
        group: Of each span, shape (count,) or more.
        span: Shape (count, 3) or more.
        count: Number of spans.
        groups: Number of groups.
        out_group: Group of each part, shape (2 count,).
        out: Its span, shape (2 count, 3).
    """
    begin = np.zeros(groups + 1, dtype=np.int64)
    for k in range(count):
        begin[group[k] + 1] += 1
    most = 0
    for g in range(groups):
        most = max(most, begin[g + 1])
        begin[g + 1] += begin[g]
    at, order = begin[:groups].copy(), np.empty(count, dtype=np.int64)
    for k in range(count):
        order[at[group[k]]] = k
        at[group[k]] += 1
    place, change = np.empty(2 * most), np.empty(2 * most)
    found = 0
    for g in range(groups):
        ends = 0
        for n in range(begin[g], begin[g + 1]):
            k = order[n]
            for side in range(2):
                spot = ends
                while spot > 0 and place[spot - 1] > span[k, side]:
                    place[spot], change[spot] = place[spot - 1], change[spot - 1]
                    spot -= 1
                place[spot], change[spot] = span[k, side], span[k, 2] if side == 0 else -span[k, 2]
                ends += 1
        total, last = 0.0, -1
        for n in range(ends - 1):
            total += change[n]
            if total != 0.0 and place[n + 1] - place[n] > SLIVER:
                if last >= 0 and out[last, 2] == total and place[n] - out[last, 1] <= SLIVER:
                    out[last, 1] = place[n + 1]
                else:
                    last = found
                    _note(out_group, out, found, g, place[n], place[n + 1], total)
                    found += 1
    return found


@loop
def side_pieces(
    x: FloatArray,
    nodes: IntArray,
    group: IntArray,
    span: FloatArray,
    reach: FloatArray,
    item: IntArray,
    table: FloatArray,
) -> int:
    """Pieces of parts of lines that are beside shared sides and within reach; see :func:`face_spans`."""
    count = 0
    for k in range(len(group)):
        g = group[k]
        start, first = node(x, nodes[g, 0]), node(x, nodes[g, 2])
        slope, u = sub(node(x, nodes[g, 1]), start), sub(node(x, nodes[g, 3]), first)
        square, offset = dot(u, u), sub(start, first)
        t0, t1 = dot(offset, u) / square, dot(slope, u) / square
        gap, turn = combine(1.0, offset, -t0, u), combine(1.0, slope, -t1, u)
        low, high = clipped(gap, turn, reach[k], span[k, 0], span[k, 1])
        if high > low:
            item[count] = k
            write_piece(table, count, low, high, gap, turn, 1.0, -1.0, scale(1.0 / np.sqrt(square), u))
            write_segment(table, count, 2, 0, 1, t0, t1)
            count += 1
    return count


@loop
def corner_pieces(
    x: FloatArray,
    nodes: IntArray,
    group: IntArray,
    span: FloatArray,
    reach: FloatArray,
    item: IntArray,
    table: FloatArray,
) -> int:
    """Pieces of parts of lines that face shared corners and are within reach; see :func:`face_spans`."""
    count = 0
    for k in range(len(group)):
        g = group[k]
        start = node(x, nodes[g, 0])
        slope, gap = sub(node(x, nodes[g, 1]), start), sub(start, node(x, nodes[g, 2]))
        low, high = clipped(gap, slope, reach[k], span[k, 0], span[k, 1])
        if high > low:
            item[count] = k
            write_piece(table, count, low, high, gap, slope, 1.0, 0.0, (0.0, 0.0, 0.0))
            table[count, FACED] = 1.0
            table[count, FACED + 1] = 0.0
            count += 1
    return count
