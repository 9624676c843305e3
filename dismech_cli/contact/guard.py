"""Keeps pairs at a distance: by a barrier in the energy, and by stopping every motion short of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from ..arrays import FloatArray, IntArray
from ..model.term import Memory
from .advance import longest_way
from .barrier import Closest, Stop, barrier_points, convex
from .candidates import among
from .guarded import Pairing
from .placed import Placed
from .source import Depths
from .stencils import Stencils
from .touching import Touching

# In units of the distance at which things touch: how far the search goes beyond it, and how far the pairs
# that are given places in the matrix.
_SKIN: Final = 0.5
_MARGIN: Final = 0.1


@dataclass(frozen=True, slots=True)
class _Seen:
    """Pairs that may be near at some places of the nodes (N, 3)."""

    x: FloatArray
    keys: IntArray
    thickness: FloatArray
    closest: Closest

    def within(self, share: float) -> IntArray:
        """Keys of those nearer than a share of the distance at which they touch."""
        return self.keys[self.closest.distance < share * self.thickness]


class Guard:
    """Finds pairs of a kind that are near; implements :class:`.source.Source`."""

    steady = True

    def __init__(self, pairing: Pairing, stop: Stop) -> None:
        self._all, self._stop = pairing, stop
        self._skin = _SKIN * pairing.thick
        self._searched: FloatArray | None = None
        self._candidates = np.empty(0, dtype=np.int64)
        self._seen: _Seen | None = None
        # where distances were measured last, and how far all were from having a place
        self._measured: tuple[FloatArray, float] | None = None
        self._placed = Placed(pairing.name, self._lay_out)

    def recall(self, memory: Memory) -> None:
        """Take up the pairs that have places."""
        self._placed.recall(memory)

    def memory(self, x: FloatArray) -> Memory:
        """The pairs that have places."""
        return self._placed.memory(self._look(x).within(self._stop.begin + _MARGIN))

    def detect(self, x: FloatArray) -> bool:
        """Give places to all pairs nearby if one that touches has none."""
        seen = self._look(x)
        near = lambda: seen.within(self._stop.begin + _MARGIN)  # noqa: E731
        return self._placed.detect(seen.within(self._stop.begin), near)

    def touching(self, x: FloatArray, v: FloatArray, t: float, factor: float) -> Iterator[Touching]:
        """Pairs within the barrier."""
        seen, placed = self._look(x), self._placed.keys
        distance = seen.closest.distance
        near = np.flatnonzero((distance < self._stop.begin * seen.thickness) & among(seen.keys, placed))
        if not len(near):
            return
        traits = self._all.traits(seen.keys[near])
        stop = self._stop.least * traits.thickness
        points = barrier_points(
            seen.closest.some(near),
            stop,
            (self._stop.begin - self._stop.least) * traits.thickness,
            factor * traits.stiffness,
        )
        points = replace(convex(points), item=np.searchsorted(placed, seen.keys[near]))
        (stencils,) = self.stencils
        yield Touching(
            kind=0,
            stencils=stencils,
            points=points,
            friction=traits.friction,
            moving=lambda: stencils.relative(points, v),
            label=traits.labels,
            sign=traits.signs,
        )

    def velocities(self, touching: Touching, x: FloatArray, v: FloatArray, t: float) -> FloatArray:
        """Relative velocities at points of contact [m/s], shape (3, K)."""
        return touching.stencils.relative(touching.points, v)

    @property
    def stencils(self) -> tuple[Stencils, ...]:
        """The four nodes of each pair."""
        return self._stencils

    def depths(self, x: FloatArray, t: float) -> Depths:
        """None: how deep things are the lines say."""
        nothing = np.empty(0, dtype=np.int64)
        return Depths(nothing, np.empty(0), nothing)

    def needed(self, x: FloatArray, ahead: FloatArray, t: float, dt: float, tolerance: float) -> float:
        """Nothing: the lines say."""
        return 0.0

    def longest_step(self, x0: FloatArray, x1: FloatArray, t0: float, t1: float) -> float:
        """Part of the way on which all pairs keep their distance."""
        keys = self._reaching(x0, x1)
        if not len(keys):
            return 1.0
        nodes, stop = self._all.nodes(keys), self._stop.nearest * self._all.traits(keys).thickness
        ends0 = np.ascontiguousarray(x0[nodes].transpose(1, 2, 0))
        way = np.ascontiguousarray(x1[nodes].transpose(1, 2, 0)) - ends0
        apart = np.sqrt(((way[:, None] - way[None]) ** 2).sum(axis=2)).max(axis=(0, 1))

        def gap_at(part: float, which: IntArray) -> FloatArray:
            # a gap of its own for each: from the distance that it keeps
            return self._all.closest(ends0[..., which] + part * way[..., which]).distance - stop[which]

        return longest_way(gap_at, apart, np.zeros(len(keys)))

    def nearest(self, x: FloatArray) -> tuple[IntArray, FloatArray, FloatArray]:
        """Keys of pairs that may be near, their distances and those that they must keep [m], shapes (K,)."""
        seen = self._look(x)
        return seen.keys, seen.closest.distance, self._stop.least * seen.thickness

    def _reaching(self, x0: FloatArray, x1: FloatArray) -> IntArray:
        """Keys of pairs that may come within the stop on a straight way."""
        moved = _farthest(x1 - x0)
        self._search(x0)
        if 2.0 * moved + 2.0 * self._strayed(x0) > self._skin:
            return self._all.search(x0, 2.0 * moved)
        if self._clear(x0, moved):
            return self._candidates[:0]
        seen = self._look(x0)
        return seen.keys[seen.closest.distance - 2.0 * moved < self._stop.least * seen.thickness]

    def _look(self, x: FloatArray) -> _Seen:
        """What is near; kept until other places are asked for."""
        if self._seen is None or not np.array_equal(self._seen.x, x):
            self._search(x)
            keys, thickness = self._candidates, self._thickness
            clear = self._clear(x, 0.0)
            if clear:
                keys, thickness = keys[:0], thickness[:0]
            nodes = self._all.nodes(keys)
            closest = self._all.closest(np.ascontiguousarray(x[nodes].transpose(1, 2, 0)))
            self._seen = _Seen(x.copy(), keys, thickness, closest)
            if not clear:
                beyond = closest.distance - (self._stop.begin + _MARGIN) * thickness
                self._measured = self._seen.x, float(beyond.min(initial=np.inf))
        return self._seen

    def _clear(self, x: FloatArray, more: float) -> bool:
        """Whether no candidate can be near at places that are up to ``more`` [m] from ``x``."""
        if self._measured is None:
            return False
        at, spare = self._measured
        return 2.0 * (_farthest(x - at) + more) < spare

    def _search(self, x: FloatArray) -> None:
        """Search anew if nodes have moved so far that pairs may be missing."""
        spare = self._skin - _MARGIN * self._all.thick
        if self._searched is not None and 2.0 * self._strayed(x) <= spare:
            return
        self._searched = x.copy()
        self._candidates = self._all.search(x, self._skin)
        self._thickness = self._all.traits(self._candidates).thickness
        self._seen = self._measured = None

    def _strayed(self, x: FloatArray) -> float:
        """How far a node has moved since the last search [m]."""
        assert self._searched is not None
        return _farthest(x - self._searched)

    def _lay_out(self, keys: IntArray) -> None:
        """What pairs with these keys touch with."""
        self._stencils = (Stencils(self._all.map, self._all.nodes(keys)),)


def _farthest(way: FloatArray) -> float:
    return float(np.sqrt((way * way).sum(axis=1).max(initial=0.0)))
