"""Closest points of segments, points and triangles, and of lines and rigid things."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray
from ..pieces.cores import beside
from ..pieces.facing_triangle import facing
from ..pieces.pieces import Pieces
from .barrier import Closest

# Segments at a smaller angle than this (its square) are closest at an end of one of them.
_PARALLEL = 1e-10


def closest_of_segments(ends: FloatArray) -> Closest:
    """Of pairs of segments with ends (4, 3, K) [m], two of either; all K of them.

    With g_k = dx/dz_k of the gap x at the places z on the segments and c_k the slopes of the weights,
    G_i = sum g_k (A^-1)_kl c_li, A = g.g.
    """
    a, b = ends[:2], ends[2:]
    count = ends.shape[2]
    u, v, offset = a[1] - a[0], b[1] - b[0], a[0] - b[0]
    uu, vv, uv = (u * u).sum(axis=0), (v * v).sum(axis=0), (u * v).sum(axis=0)
    cross = np.cross(u, v, axis=0)
    square = (cross * cross).sum(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (np.cross(v, offset, axis=0) * cross).sum(axis=0) / square
        t = (np.cross(u, offset, axis=0) * cross).sum(axis=0) / square
        n = cross / np.sqrt(square)
        g = (u * vv - v * uv) / square, (v * uu - u * uv) / square
    within = (square > _PARALLEL * uu * vv) & (s > 0.0) & (s < 1.0) & (t > 0.0) & (t < 1.0)
    one, zero = np.ones(count), np.zeros(count)
    x = (offset * n).sum(axis=0) * n
    inner = Closest(
        np.arange(count),
        s,
        np.stack((1.0 - s, s, t - 1.0, -t)),
        np.stack((-g[0], g[0], -g[1], g[1])),
        x,
        zero,
        one,
        n,
    )
    at_ends = [_end(a[k], k, b, (2, 3), 1.0) for k in (0, 1)] + [
        _end(b[k], 2 + k, a, (0, 1), -1.0) for k in (0, 1)
    ]
    which = np.argmin([one.distance for one in at_ends], axis=0)
    number = np.where(within, 4, which)
    names = Closest.__match_args__[1:]
    chosen = [np.choose(number, [getattr(part, name) for part in (*at_ends, inner)]) for name in names]
    return Closest(np.arange(count), *chosen)


def _end(point: FloatArray, node: int, segment: FloatArray, nodes: tuple[int, int], sign: float) -> Closest:
    """An end of one segment against the other; the gap runs from the second segment to the first."""
    count = point.shape[1]
    at = _nearest(beside(point, np.zeros_like(point), segment[0], segment[1]), count)
    weights, spread = np.zeros((4, count)), np.zeros((4, 3, count))
    weights[node] = sign
    weights[list(nodes)] = -sign * at.along[0]
    spread[list(nodes)] = at.spread
    s = np.full(count, float(node)) if sign > 0.0 else at.along[0, 1]
    return Closest(np.arange(count), s, weights, spread, sign * at.start, at.identity, at.axis, at.e)


def closest_of_points(points: FloatArray, corners: FloatArray) -> Closest:
    """Of points (3, K) and triangles with corners (3, 3, K) [m]: corner, axis; all K of them."""
    count = points.shape[1]
    at = _nearest(facing(points, np.zeros_like(points), corners), count)
    weights = np.concatenate((np.ones((1, count)), -at.along[0]))
    spread = np.concatenate((np.zeros((1, 3, count)), at.spread))
    return Closest(np.arange(count), np.zeros(count), weights, spread, at.start, at.identity, at.axis, at.e)


def _nearest(pieces: Pieces, count: int) -> Pieces:
    """The piece of each of ``count`` points, lines of no length: the nearest."""
    square = (pieces.start * pieces.start).sum(axis=0)
    square = np.where(pieces.high > pieces.low, square, np.inf)
    order = np.lexsort((square, pieces.item))
    first: IntArray = order[np.searchsorted(pieces.item[order], np.arange(count))]
    return pieces.some(first)


def closest_to_rigid(whole: Pieces, ends: tuple[Pieces, Pieces], count: int) -> Closest:
    """Of lines and rigid things, and of both ends of each line alone.

    The ends stand beside the closest points because lines lie flat on flat things, where any point is
    closest: then the ends are what is kept at a distance.

    Args:
        whole: Pieces of the lines by what they face; item k is that of line k.
        ends: The same for both ends, lines of no length.
        count: Number of lines.
    """
    first, last = (_nearest(one, count) for one in ends)
    found = [_at_end(first, 0), _at_end(last, 1), _along(whole, count)]
    return Closest(
        *(np.concatenate([getattr(one, name) for one in found], axis=-1) for name in Closest.__match_args__)
    )


def _at_end(at: Pieces, node: int) -> Closest:
    count = len(at.item)
    weights = np.zeros((2, count))
    weights[node] = 1.0
    nothing = np.zeros((2, 3, count))
    s = np.full(count, float(node))
    return Closest(np.arange(count), s, weights, nothing, at.start, at.identity, at.axis, at.e)


def _along(whole: Pieces, count: int) -> Closest:
    """The closest point of each line; of those that face a side of a solid the middle one of all such."""
    square = (whole.slope * whole.slope).sum(axis=0)
    along = (whole.start * whole.slope).sum(axis=0)
    flat = square <= _PARALLEL * (whole.start * whole.start).sum(axis=0)
    s = np.where(flat, 0.5 * (whole.low + whole.high), -along / (square + np.finfo(float).tiny))
    s = np.clip(s, whole.low, whole.high)
    x = whole.start + s * whole.slope
    distance = np.where(whole.high > whole.low, (x * x).sum(axis=0), np.inf)
    order = np.lexsort((distance, whole.item))
    first = order[np.searchsorted(whole.item[order], np.arange(count))]
    at, s, x, flat, square = whole.some(first), s[first], x[:, first], flat[first], square[first]
    inside = (s > 0.0) & (s < 1.0) & ~flat & (at.identity > 0.5)
    with np.errstate(divide="ignore", invalid="ignore"):
        g = np.where(inside, at.slope / square, 0.0)
        u = np.where(inside, at.slope / np.sqrt(square), 0.0)
    # across the line nothing moves the point: of Q = I the part along it goes, of I - e e^T one axis is left
    beside_edge = inside & (at.axis < -0.5)
    across = np.cross(at.e, u, axis=0)
    return Closest(
        np.arange(count),
        s,
        np.stack((1.0 - s, s)),
        np.stack((-g, g)),
        x,
        np.where(beside_edge, 0.0, at.identity),
        np.select([beside_edge, inside], [1.0, -1.0], at.axis),
        np.where(beside_edge, across, np.where(inside, u, at.e)),
    )
