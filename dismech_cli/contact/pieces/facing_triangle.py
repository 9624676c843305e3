"""Pieces of lines by what they face of a triangle: its inside, a side or a corner.

Planes at right angles to the triangle, through its sides and through their ends, part space by the feature
that is nearest. They cut a line nine times at most, and on a piece between two cuts the gap vector is
linear in s: nothing can fail near a cut, where a wrong feature costs no more than the length of its piece.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from .pieces import Pieces

# Side i runs from corner i to this one.
_NEXT = np.array([1, 2, 0])


@frozen
class _Pairs:
    """Lines and triangles, one of each in a pair.

    Attributes:
        offsets: From each corner to the start of the line [m], shape (3, 3, K).
        slope: From there to its end [m], shape (3, K).
        sides: [m], shape (3, 3, K).
        normal: Twice the area along the normal [m^2], shape (3, K).
        inward: Normal of each side in the plane, at the size of a slope of the height above it as a share of
            that of the triangle [1/m], shape (3, 3, K).
        along: Place along each side as a share of it, at s = 0 and its slope, shape (2, 3, K).
        height: Height above each side, likewise, shape (2, 3, K).
    """

    offsets: FloatArray
    slope: FloatArray
    sides: FloatArray
    normal: FloatArray
    inward: FloatArray
    along: FloatArray
    height: FloatArray

    @classmethod
    def of(cls, start: FloatArray, slope: FloatArray, corners: FloatArray) -> _Pairs:
        sides, offsets = corners[_NEXT] - corners, start - corners
        normal = np.cross(sides[0], sides[1], axis=0)
        inward = np.cross(np.broadcast_to(normal, sides.shape), sides, axis=1) / (normal * normal).sum(axis=0)
        shares = sides / (sides * sides).sum(axis=1, keepdims=True)
        along = np.stack(((offsets * shares).sum(axis=1), (slope * shares).sum(axis=1)))
        height = np.stack(((offsets * inward).sum(axis=1), (slope * inward).sum(axis=1)))
        return cls(offsets, slope, sides, normal, inward, along, height)

    def some(self, which: IntArray) -> _Pairs:
        return _Pairs(*(getattr(self, name)[..., which] for name in self.__match_args__))

    def cuts(self) -> FloatArray:
        """Where lines pass the planes, in order, from 0 to 1, shape (11, K)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            (t0, t1), (h0, h1) = self.along, self.height
            cuts = np.concatenate((-t0 / t1, (1.0 - t0) / t1, -h0 / h1))
        cuts = np.sort(np.where(np.isfinite(cuts), np.clip(cuts, 0.0, 1.0), 0.0), axis=0)
        ends = np.zeros((1, cuts.shape[1]))
        return np.concatenate((ends, cuts, ends + 1.0))


def facing(start: FloatArray, slope: FloatArray, corners: FloatArray) -> Pieces:
    """Pieces of lines by the feature that they face of one triangle each; see :func:`features`."""
    return features(start, slope, corners)[0]


def features(start: FloatArray, slope: FloatArray, corners: FloatArray) -> tuple[Pieces, IntArray]:
    """Pieces of lines by the feature that they face of one triangle each, and that: 0, 1 to 3, 4 to 6.

    Args:
        start: Ends of the lines at s = 0 [m], shape (3, K).
        slope: From there to the other ends [m], shape (3, K).
        corners: Of the triangles [m], shape (3, 3, K): corner, axis.
    """
    pairs = _Pairs.of(start, slope, corners)
    cuts = pairs.cuts()
    low, high = cuts[:-1].reshape(-1), cuts[1:].reshape(-1)
    kept = np.flatnonzero(high > low)
    item, low, high = np.tile(np.arange(start.shape[1]), len(cuts) - 1)[kept], low[kept], high[kept]
    feature = _nearest(pairs.some(item), 0.5 * (low + high))
    parts = []
    for number, of in enumerate(_FEATURES):
        rows = np.flatnonzero(feature == number)
        parts.append(of(pairs.some(item[rows]), item[rows], low[rows], high[rows]))
    return Pieces.joined(parts), np.sort(feature)


def _nearest(pairs: _Pairs, s: FloatArray) -> IntArray:
    """What is nearest at a place of each line: 0 the inside, 1 to 3 a side, 4 to 6 a corner, shape (K,)."""
    t, h = pairs.along[0] + s * pairs.along[1], pairs.height[0] + s * pairs.height[1]
    beside = (h < 0.0) & (t > 0.0) & (t < 1.0)
    x = pairs.offsets + s * pairs.slope
    corner = np.argmin((x * x).sum(axis=1), axis=0)
    feature: IntArray = np.where(beside.any(axis=0), 1 + np.argmax(beside, axis=0), 4 + corner)
    return np.where((h >= 0.0).all(axis=0), 0, feature)


def _inside(pairs: _Pairs, item: IntArray, low: FloatArray, high: FloatArray) -> Pieces:
    n = pairs.normal / np.sqrt((pairs.normal * pairs.normal).sum(axis=0))
    one = np.ones(len(item))
    # the weight of a corner is the height above the side across from it
    return Pieces(
        item=item,
        low=low,
        high=high,
        start=(n * pairs.offsets[0]).sum(axis=0) * n,
        slope=(n * pairs.slope).sum(axis=0) * n,
        identity=0.0 * one,
        axis=one,
        e=n,
        along=pairs.height[:, _NEXT],
        spread=pairs.inward[_NEXT],
    )


def _beside(side: int, pairs: _Pairs, item: IntArray, low: FloatArray, high: FloatArray) -> Pieces:
    u = pairs.sides[side]
    square = (u * u).sum(axis=0)
    t0, t1 = pairs.along[:, side]
    one = np.ones(len(item))
    along, spread = np.zeros((2, 3, len(item))), np.zeros((3, 3, len(item)))
    first, second = side, int(_NEXT[side])
    along[:, first], along[:, second] = (1.0 - t0, -t1), (t0, t1)
    spread[first], spread[second] = -u / square, u / square
    return Pieces(
        item=item,
        low=low,
        high=high,
        start=pairs.offsets[side] - t0 * u,
        slope=pairs.slope - t1 * u,
        identity=one,
        axis=-one,
        e=u / np.sqrt(square),
        along=along,
        spread=spread,
    )


def _before(corner: int, pairs: _Pairs, item: IntArray, low: FloatArray, high: FloatArray) -> Pieces:
    one = np.ones(len(item))
    along, nothing = np.zeros((2, 3, len(item))), np.zeros((3, 3, len(item)))
    along[0, corner] = 1.0
    return Pieces(
        item=item,
        low=low,
        high=high,
        start=pairs.offsets[corner],
        slope=pairs.slope,
        identity=one,
        axis=0.0 * one,
        e=nothing[0],
        along=along,
        spread=nothing,
    )


_FEATURES: tuple[Callable[[_Pairs, IntArray, FloatArray, FloatArray], Pieces], ...] = (
    _inside,
    *(partial(_beside, side) for side in range(3)),
    *(partial(_before, corner) for corner in range(3)),
)
