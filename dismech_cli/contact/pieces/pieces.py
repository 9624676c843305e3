"""Pieces of lines that face one feature each, and their points of contact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ..law.quadrature import GAUSS, within


@frozen
class Pieces:
    """Pieces [low, high] of lines x(s), s from 0 to 1, on each of which one feature is nearest.

    Attributes:
        item: Which line and feature, shape (K,).
        low: Start, shape (K,).
        high: End, shape (K,).
        start: Gap vector at s = 0 were it linear all along [m], shape (3, K).
        slope: Its slope in s [m], shape (3, K).
        identity: Share of the identity in Q, shape (K,); see :mod:`.points`.
        axis: Share of e e^T in Q, shape (K,).
        e: Axis of an edge or normal of a face, shape (3, K).
        along: Weights of the m nodes that span what is faced, at s = 0 and their slopes, shape (2, m, K);
            m is 0 where no nodes do.
        spread: Their gradients to the point of the line [1/m], shape (m, 3, K).
    """

    item: IntArray
    low: FloatArray
    high: FloatArray
    start: FloatArray
    slope: FloatArray
    identity: FloatArray
    axis: FloatArray
    e: FloatArray
    along: FloatArray
    spread: FloatArray

    @classmethod
    def joined(cls, parts: list[Pieces]) -> Pieces:
        """All pieces of a list."""
        names = cls.__match_args__
        return cls(*(np.concatenate([getattr(part, name) for part in parts], axis=-1) for name in names))

    def some(self, kept: FloatArray | IntArray) -> Pieces:
        """Those of a mask or of indices."""
        return Pieces(*(getattr(self, name)[..., kept] for name in self.__match_args__))

    def fixed(self) -> Pieces:
        """The same where what is faced follows no nodes."""
        return replace(self, along=self.along[:, :0], spread=self.spread[:0])

    def within(self, reach: FloatArray) -> Pieces:
        """The parts of the pieces that are within the reach [m] of their items."""
        a = (self.slope * self.slope).sum(axis=0)
        b = (self.start * self.slope).sum(axis=0)
        c = (self.start * self.start).sum(axis=0) - reach[self.item] ** 2
        low, high = within(a, b, c, self.low, self.high)
        kept = np.flatnonzero(high > low)
        part = self.some(kept)
        return Pieces(
            part.item, low[kept], high[kept], *(getattr(part, name) for name in self.__match_args__[3:])
        )

    def nearest(self, count: int) -> FloatArray:
        """Least distance of each of ``count`` items [m], shape (count,); infinite without pieces."""
        a = (self.slope * self.slope).sum(axis=0)
        b = (self.start * self.slope).sum(axis=0)
        s = np.clip(-b / (a + np.finfo(float).tiny), self.low, self.high)
        gap = self.start + s * self.slope
        out = np.full(count, np.inf)
        # an empty piece faces its feature nowhere
        square = np.where(self.high > self.low, (gap * gap).sum(axis=0), np.inf)
        np.minimum.at(out, self.item, np.sqrt(square))
        return out


@frozen
class Spots:
    """Gauss points on pieces.

    Attributes:
        piece: Piece of each, shape (K,).
        s: Place on the line, shape (K,).
        share: Share of the length of the line, shape (K,).
    """

    piece: IntArray
    s: FloatArray
    share: FloatArray


def spots(low: FloatArray, high: FloatArray) -> Spots:
    """Three Gauss points on each piece."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    s = np.concatenate([middle + place * half for place, _ in GAUSS])
    share = np.concatenate([2.0 * weight * half for _, weight in GAUSS])
    return Spots(np.tile(np.arange(len(low)), len(GAUSS)), s, share)
