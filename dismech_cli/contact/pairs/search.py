"""Pairs of lines near each other, found anew only when nodes have moved."""

from __future__ import annotations

from typing import Final

import numpy as np

from ...arrays import FloatArray, IntArray, distinct
from ..drivers.loops import Loops
from ..nearby.neighbours import Neighbours

# In units of the distance at which lines touch: how far the search goes beyond it, and how far beyond it
# distances are asked for.
SKIN: Final = 0.5
MARGIN: Final = 0.25
# A search ahead goes so many times the thickness farther at most.
_AHEAD: Final = 4.0


class Search:
    """Finds pairs by distance; what it finds does not depend on when it last looked around.

    Attributes:
        neighbours: Who may touch.
        loops: What is done to many pairs at once.
        candidates: Pairs that may be near, shape (P, 2).
        reach: Distance at which each touches [m], shape (P,).
        distance: Distance of each at the places last asked for [m], shape (P,).
    """

    _astray: tuple[FloatArray, float]

    def __init__(self, neighbours: Neighbours, loops: Loops) -> None:
        self.neighbours, self.loops = neighbours, loops
        self._thick = 2.0 * float(neighbours.lines.radii[neighbours.numbers].max(initial=0.0))
        self._used = distinct(neighbours.lines.nodes[neighbours.numbers])
        self.skin = SKIN * self._thick
        self._searched: FloatArray | None = None
        self.candidates: IntArray = np.empty((0, 2), dtype=np.int64)
        self._nodes, self._keys = np.empty((0, 4), dtype=np.int64), np.empty(0, dtype=np.int64)
        self.reach = self.distance = self._measured = np.empty(0)
        self._asked: FloatArray | None = None

    def within(self, x: FloatArray, margin: float) -> IntArray:
        """Keys of pairs within reach and a margin in units of it, ascending."""
        self.measure(x)
        return self._keys[self.distance < (1.0 + margin) * self.reach]

    def measure(self, x: FloatArray) -> None:
        """Find the candidates and their distances, if those known are not of these places.

        Whoever asks for places leaves them as they are.
        """
        if x is self._asked:
            return
        self._look(x)
        if not np.array_equal(x, self._measured):
            self._measured = x.copy()
            self.distance = self.loops.segment_distances(x, self._nodes)
        self._asked = x

    def closer(self, x: FloatArray, share: float) -> IntArray:
        """Keys of pairs nearer than a share of their reach, 1.25 at most, ascending."""
        return self.within(x, share - 1.0)

    def coming(self, x0: FloatArray, x1: FloatArray, share: float) -> IntArray:
        """Keys of pairs that may come nearer than that on a straight way, ascending."""
        ways = _lengths(x1 - x0)
        moved = 2.0 * float(ways[self._used].max(initial=0.0))
        pairs = self._reaching(x0, moved)
        if pairs is not self.candidates:
            return self.neighbours.keys(pairs)
        self.measure(x0)
        room = self.distance - share * self.reach
        if not len(room) or moved < room.min():
            return self._keys[:0]
        one, other, first, second = (ways[ends] for ends in self._nodes.T)
        near = room < np.maximum(one, other) + np.maximum(first, second)
        return np.asarray(self._keys[near])

    def reaching(self, x0: FloatArray, x1: FloatArray) -> IntArray:
        """Pairs that may come within reach of each other on a way, shape (P, 2)."""
        return self._reaching(x0, 2.0 * float(_lengths((x1 - x0)[self._used]).max(initial=0.0)))

    def _reaching(self, x: FloatArray, moved: float) -> IntArray:
        """Pairs that may do so where the two nodes that move farthest move so far [m]."""
        self._look(x, moved)
        return self.candidates if moved + 2.0 * self._strayed(x) <= self.skin else self.find(x, moved)

    def find(self, x: FloatArray, more: float) -> IntArray:
        """Allowed pairs within reach and ``more`` [m], shape (P, 2)."""
        return self.neighbours.allowed(
            self.neighbours.numbers[self.loops.near_among(self.neighbours.boxes(x, more))]
        )

    def _look(self, x: FloatArray, ahead: float = 0.0) -> None:
        """Search anew if nodes have moved, or will move ahead [m], so far that pairs may be missing."""
        ahead = min(ahead, _AHEAD * self._thick)
        room = max(MARGIN * self._thick, ahead)
        if self._searched is not None and 2.0 * self._strayed(x) <= self.skin - room:
            return
        self.skin = SKIN * self._thick + ahead
        self._searched = x.copy()
        self.candidates = self.find(x, self.skin)
        self._nodes = self.neighbours.nodes(self.candidates)
        self._keys = self.neighbours.keys(self.candidates)
        self.reach = self.neighbours.reach(self.candidates)
        self._measured, self._asked = np.empty(0), None
        self._astray = x, 0.0

    def _strayed(self, x: FloatArray) -> float:
        """How far a node has moved since the last search [m]; kept until other places are asked for."""
        assert self._searched is not None
        if self._astray[0] is not x:
            self._astray = x, float(_lengths(x - self._searched).max(initial=0.0))
        return self._astray[1]


def _lengths(ways: FloatArray) -> FloatArray:
    """Of vectors (K, 3), shape (K,)."""
    x, y, z = ways.T
    lengths: FloatArray = np.sqrt(x * x + y * y + z * z)
    return lengths
