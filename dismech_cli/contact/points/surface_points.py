"""Points of contact of lines with surfaces, in batches: with what is left of triangles and junctions.

Where a line is above one of two triangles that share a side, what it faces of the other is the side, and the
side is taken off once: both cancel. So whatever a line faces is noted with the times that it counts, and only
where these do not add up to nothing are there points.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...arrays import FloatArray, IntArray
from ..pieces.cores import beside, facing_node
from ..pieces.pieces import Pieces
from ..pieces.spans import Spans
from ..pieces.surface import Faced
from .points import Points, round_points
from .secant import with_secant

_FEATURES = 7


def surface_points(
    x: FloatArray, pieces: Pieces, feature: IntArray, faced: Faced
) -> tuple[Points, Points, Points]:
    """Points with triangles, and with the sides and corners that these share.

    Args:
        x: Nodes [m], shape (N, 3).
        pieces: Of the lines that are within reach of triangles, numbered as these.
        feature: What each faces: 0 the inside, 1 to 3 a side, 4 to 6 a corner.
        faced: The pairs within reach.
    """
    j = faced.junctions
    row = faced.rows[pieces.item]
    none = np.full((len(row), 1), -1)
    numbers = np.concatenate((none, j.sides_of[row], j.corners_of[row]), axis=1)
    number = numbers[np.arange(len(row)), feature]
    of_side = Spans.once(number, pieces, (number >= 0) & (feature <= 3))
    of_corner = Spans.once(number, pieces, (number >= 0) & (feature > 3))
    shared = faced.shared
    counted = np.flatnonzero(shared.side_times)
    parts = beside(*_lines(x, j.sides[counted]))
    times, (first, second) = shared.side_times[counted], j.ends[counted].T
    before, between, behind = _thirds(parts)
    left = np.flatnonzero(shared.corner_times)
    ends = np.zeros(len(left))
    sides = Spans.joined([of_side, Spans(counted, between.low, between.high, times)])
    corners = Spans.joined(
        [
            of_corner,
            Spans(first, before.low, before.high, times),
            Spans(second, behind.low, behind.high, times),
            Spans(left, ends, ends + 1.0, shared.corner_times[left]),
        ]
    )
    return (
        _of_triangles(pieces, feature, number, faced),
        _of_sides(x, sides.net(), faced),
        _of_corners(x, corners.net(), faced),
    )


def _thirds(parts: Pieces) -> list[Pieces]:
    """What :func:`.cores.beside` joins."""
    return [parts.some(third) for third in np.split(np.arange(len(parts.item)), 3)]


def _of_triangles(pieces: Pieces, feature: IntArray, number: IntArray, faced: Faced) -> Points:
    """Points with what no other triangle has."""
    alone = np.flatnonzero(number < 0)
    group = _FEATURES * pieces.item + feature
    spans = Spans.once(group, pieces, number < 0).net()
    groups, first = np.unique(group[alone], return_index=True)
    example = alone[first[np.searchsorted(groups, spans.group)]]
    row = faced.rows[pieces.item[example]]
    points = _points(pieces.some(example), spans, row, faced)
    return replace(points, item=row[points.item])


def _of_sides(x: FloatArray, spans: Spans, faced: Faced) -> Points:
    """Points with sides."""
    parts = beside(*_lines(x, faced.junctions.sides[spans.group]))
    _, between, _ = _thirds(parts)
    points = _points(between, spans, faced.shared.side_owner[spans.group], faced)
    return replace(points, item=spans.group[points.item])


def _of_corners(x: FloatArray, spans: Spans, faced: Faced) -> Points:
    """Points with corners."""
    whole = facing_node(*_lines(x, faced.junctions.corners[spans.group]))
    points = _points(whole, spans, faced.shared.corner_owner[spans.group], faced)
    return replace(points, item=spans.group[points.item])


def _lines(x: FloatArray, nodes: IntArray) -> list[FloatArray]:
    """Starts and slopes of lines and places of what they face, nodes (K, n), each of shape (3, K)."""
    start, end, *faced = np.ascontiguousarray(x[nodes].transpose(1, 2, 0))
    return [start, end - start, *faced]


def _points(pieces: Pieces, spans: Spans, row: IntArray, faced: Faced) -> Points:
    """Points on some parts of pieces, by their number, with the reach and the stiffness of some pairs."""
    parts = replace(pieces, item=np.arange(len(spans.group)), low=spans.low, high=spans.high)
    points = round_points(parts, faced.reach[row], faced.factor[row] * spans.times)
    return with_secant(points, faced.reach[row[points.item]])
