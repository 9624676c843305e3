"""Pairs by the family's own law: edges with edges, nodes with triangles, each pair for itself."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from ...arrays import FloatArray, IntArray
from ...model.term import Memory
from ..gather.source import Depths
from ..gather.stencils import Stencils
from ..gather.touching import Touching
from ..guards.guarded import Pairing
from ..law.loads import Loads
from ..nearby.advance import longest_way
from ..nearby.candidates import among
from ..nearby.placed import Placed
from ..nearby.seen import Seen
from ..points.barrier import Closest
from ..points.points import Points
from ..points.softplus import Softplus, pair_points

# Beyond the width of the law, in units of it: how far the search goes, and what is given places.
_SKIN: Final = 4.0
_MARGIN: Final = 1.0
# Motion within a step may bring things to half the distance at which they touch, or half as near as they are.
_NEAREST: Final = 0.5


class FamilyPairs:
    """Finds pairs of a kind; implements :class:`.source.Source`."""

    steady = True
    _closest: Closest

    def __init__(self, pairing: Pairing, law: Softplus, loads: Loads) -> None:
        """Find none yet.

        Args:
            pairing: Pairs that may touch.
            law: How they press.
            loads: What their friction goes by.
        """
        self._all, self._law, self._loads = pairing, law, loads
        self._skin = _SKIN * law.width
        self._searched: FloatArray | None = None
        self._candidates = np.empty(0, dtype=np.int64)
        self._seen: Seen | None = None
        self._placed = Placed(pairing.name, self._lay_out)

    def recall(self, memory: Memory) -> None:
        """Take up the pairs that have places, and what their friction goes by."""
        self._placed.recall(memory)
        self._loads.recall(memory)

    def memory(self, x: FloatArray) -> Memory:
        """The pairs that have places, and what the friction of the next step goes by."""
        keys, points = self._touching(x)
        return {
            **self._placed.memory(self._around(x, (1.0 + _MARGIN) * self._law.width)),
            **self._loads.memory(keys, points.load),
        }

    def detect(self, x: FloatArray) -> bool:
        """Give places to all pairs nearby if one that touches has none."""
        width = self._law.width
        return self._placed.detect(self._around(x, width), lambda: self._around(x, (1.0 + _MARGIN) * width))

    def touching(self, x: FloatArray, v: FloatArray, t: float, factor: float) -> Iterator[Touching]:
        """Pairs within the width of the law, whose stiffness is given: the factor is one."""
        keys, points = self._touching(x)
        if not len(keys):
            return
        stencils = self._stencils[0]
        points = replace(points, item=np.searchsorted(self._placed.keys, keys))
        yield Touching(
            kind=0,
            stencils=stencils,
            strips=points,
            between=self._between,
            moving=lambda: stencils.relative(points, v),
            lagged=self._loads.of(keys),
        )

    def velocities(self, touching: Touching, x: FloatArray, v: FloatArray, t: float) -> FloatArray:
        """Relative velocities at points of contact [m/s], shape (3, K)."""
        return touching.stencils.relative(touching.points, v)

    @property
    def stencils(self) -> tuple[Stencils, ...]:
        """The four nodes of each pair."""
        return self._stencils

    def depths(self, x: FloatArray, t: float) -> Depths:
        """How much nearer pairs are than they touch."""
        seen = self._look(x)
        near = np.flatnonzero(seen.distance < seen.touch)
        keys, touch = seen.keys[near], seen.touch[near]
        shares = (touch - seen.distance[near]) / touch
        return Depths(self._all.lines(keys), shares, self._all.traits(keys).between.labels)

    def needed(self, x: FloatArray, ahead: FloatArray, t: float, dt: float, tolerance: float) -> float:
        """Nothing: the stiffness is given."""
        return 0.0

    def longest_step(self, x0: FloatArray, x1: FloatArray, t0: float, t1: float) -> float:
        """Part of the way on which nothing passes through anything."""
        keys = self._all.search(x0, 2.0 * _farthest(x1 - x0))
        if not len(keys):
            return 1.0
        nodes, touch = self._all.nodes(keys), self._all.traits(keys).thickness
        ends = np.ascontiguousarray(x0[nodes].transpose(1, 2, 0))
        way = np.ascontiguousarray(x1[nodes].transpose(1, 2, 0)) - ends
        apart = np.sqrt(((way[:, None] - way[None]) ** 2).sum(axis=2)).max(axis=(0, 1))

        def gap_at(part: FloatArray, which: IntArray) -> FloatArray:
            return self._all.closest(ends[..., which] + part * way[..., which]).distance

        return longest_way(gap_at, apart, _NEAREST * touch)

    def _touching(self, x: FloatArray) -> tuple[IntArray, Points]:
        """Keys of placed pairs within the width, ascending, and their points."""
        seen = self._look(x)
        near = seen.distance < seen.touch + self._law.width
        rows = np.flatnonzero(near & among(seen.keys, self._placed.keys))
        return seen.keys[rows], pair_points(self._closest.some(rows), seen.touch[rows], self._law)

    def _around(self, x: FloatArray, more: float) -> IntArray:
        """Keys of pairs nearer than what touches and ``more`` [m]."""
        seen = self._look(x)
        return seen.nearer(seen.touch + more)

    def _look(self, x: FloatArray) -> Seen:
        """What is near; kept until other places are asked for."""
        if self._seen is None or not self._seen.is_of(x):
            self._search(x)
            keys = self._candidates
            nodes = self._all.nodes(keys)
            self._closest = self._all.closest(np.ascontiguousarray(x[nodes].transpose(1, 2, 0)))
            self._seen = Seen(x.copy(), keys, self._touch, self._closest.distance)
        return self._seen

    def _search(self, x: FloatArray) -> None:
        """Search anew if nodes have moved so far that pairs may be missing."""
        spare = self._skin - (1.0 + _MARGIN) * self._law.width
        if self._searched is not None and 2.0 * _farthest(x - self._searched) <= spare:
            return
        self._searched = x.copy()
        self._candidates = self._all.search(x, self._skin)
        self._touch = self._all.traits(self._candidates).thickness

    def _lay_out(self, keys: IntArray) -> None:
        """What pairs with these keys touch with."""
        self._stencils = (Stencils(self._all.map, self._all.nodes(keys)),)
        self._between = self._all.traits(keys).between


def _farthest(way: FloatArray) -> float:
    return float(np.sqrt((way * way).sum(axis=1).max(initial=0.0)))
