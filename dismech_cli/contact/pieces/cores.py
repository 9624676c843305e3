"""What rigid obstacles are made of: a core, of which they are all points within a radius.

A ball is a point, a capsule a segment, a cylinder a line, a box with rounded edges a box. The
distance to a convex core is convex and smooth outside, and along a line its square is a parabola piece by
piece.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np

from ...arrays import FloatArray
from ...frozen import frozen
from ..law.quadrature import passing
from .pieces import Pieces


class Core(Protocol):
    """A convex set in its own coordinates."""

    def pieces(self, start: FloatArray, slope: FloatArray) -> Pieces:
        """Pieces of lines by the feature of the core that they face; whole lines if there is one only.

        Args:
            start: Ends of the lines at s = 0 [m], shape (3, E).
            slope: From there to the other ends [m], shape (3, E).
        """


def whole(start: FloatArray, slope: FloatArray, e: FloatArray, identity: float, axis: float) -> Pieces:
    """Pieces that are whole lines with the same feature."""
    count = start.shape[1]
    one = np.ones(count)
    return Pieces(
        np.arange(count),
        np.zeros(count),
        one,
        start,
        slope,
        identity * one,
        axis * one,
        np.broadcast_to(e[:, None], (3, count)),
        np.zeros((2, 0, count)),
        np.zeros((0, 3, count)),
    )


@frozen
class PointCore:
    """A point.

    Attributes:
        centre: [m], shape (3,).
    """

    centre: FloatArray

    def pieces(self, start: FloatArray, slope: FloatArray) -> Pieces:
        """Whole lines."""
        return whole(start - self.centre[:, None], slope, np.zeros(3), 1.0, 0.0)


@frozen
class LineCore:
    """A line without ends.

    Attributes:
        point: One of its points [m], shape (3,).
        axis: Unit direction, shape (3,).
    """

    point: FloatArray
    axis: FloatArray

    def pieces(self, start: FloatArray, slope: FloatArray) -> Pieces:
        """Whole lines."""
        across = np.eye(3) - np.outer(self.axis, self.axis)
        return whole(across @ (start - self.point[:, None]), across @ slope, self.axis, 1.0, -1.0)


@frozen
class SegmentCore:
    """A segment.

    Attributes:
        first: One end [m], shape (3,).
        second: The other, shape (3,).
    """

    first: FloatArray
    second: FloatArray

    def pieces(self, start: FloatArray, slope: FloatArray) -> Pieces:
        """Before its first end, beside it and behind its second."""
        shape = start.shape
        first = np.broadcast_to(self.first[:, None], shape)
        second = np.broadcast_to(self.second[:, None], shape)
        return beside(start, slope, first, second).fixed()


def beside(start: FloatArray, slope: FloatArray, first: FloatArray, second: FloatArray) -> Pieces:
    """Pieces of lines by what they face of one segment each: an end, or the points between.

    Args:
        start: Ends of the lines at s = 0 [m], shape (3, K).
        slope: From there to the other ends [m], shape (3, K).
        first: First ends of the segments [m], shape (3, K).
        second: Second ends [m], shape (3, K).
    """
    count = start.shape[1]
    u = second - first
    square = (u * u).sum(axis=0)
    offset = start - first
    t0, t1 = (offset * u).sum(axis=0) / square, (slope * u).sum(axis=0) / square
    rising = t1 >= 0.0
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        early, late = passing(t0, t1)
    zero, one = np.zeros(count), np.ones(count)
    item = np.arange(count)
    edge = u / np.sqrt(square)
    first_low, first_high = np.where(rising, zero, late), np.where(rising, early, one)
    second_low, second_high = np.where(rising, late, zero), np.where(rising, one, early)
    nothing, at_one, at_other = np.zeros((2, 3, count)), np.zeros((2, 2, count)), np.zeros((2, 2, count))
    at_one[0, 0], at_other[0, 1] = 1.0, 1.0
    before = Pieces(item, first_low, first_high, offset, slope, one, zero, edge, at_one, nothing)
    behind = Pieces(item, second_low, second_high, start - second, slope, one, zero, edge, at_other, nothing)
    between = Pieces(
        item,
        early,
        late,
        offset - t0 * u,
        slope - t1 * u,
        one,
        -one,
        edge,
        np.stack((np.stack((one - t0, t0)), np.stack((-t1, t1)))),
        np.stack((-u / square, u / square)),
    )
    return Pieces.joined([before, between, behind])


def facing_node(start: FloatArray, slope: FloatArray, vertex: FloatArray) -> Pieces:
    """Whole lines that face one node each, at places (3, K)."""
    count = start.shape[1]
    along = np.zeros((2, 1, count))
    along[0] = 1.0
    pieces = whole(start - vertex, slope, np.zeros(3), 1.0, 0.0)
    return replace(pieces, along=along, spread=np.zeros((1, 3, count)))


@frozen
class BoxCore:
    """A box about the origin.

    Attributes:
        half: Half of its sides [m], shape (3,).
    """

    half: FloatArray

    def pieces(self, start: FloatArray, slope: FloatArray) -> Pieces:
        """Cut where a line passes the plane of a side; in between it faces a side, an edge or a corner."""
        count = start.shape[1]
        h = self.half[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            cuts = np.concatenate(((h - start) / slope, (-h - start) / slope))
        cuts = np.where(np.isfinite(cuts), np.clip(cuts, 0.0, 1.0), 0.0)
        cuts = np.concatenate((np.zeros((1, count)), np.sort(cuts, axis=0), np.ones((1, count))))
        low, high = cuts[:-1].reshape(-1), cuts[1:].reshape(-1)
        item = np.tile(np.arange(count), len(cuts) - 1)
        kept = np.flatnonzero(high > low)
        low, high, item = low[kept], high[kept], item[kept]
        start, slope = start[:, item], slope[:, item]
        middle = start + 0.5 * (low + high) * slope
        side = np.sign(middle) * (np.abs(middle) > h)
        beyond = np.abs(side)
        features = beyond.sum(axis=0)
        # of a side the axis out of it, of an edge that along it
        e = np.where(features == 2, 1.0 - beyond, beyond)
        return Pieces(
            item,
            low,
            high,
            beyond * start - side * h,
            beyond * slope,
            (features >= 2).astype(np.float64),
            np.select([features == 1, features == 2], [1.0, -1.0], 0.0),
            e,
            np.zeros((2, 0, len(item))),
            np.zeros((0, 3, len(item))),
        )
