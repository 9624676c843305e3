"""Keeps pairs at a distance: by a barrier in the energy, and by stopping every motion short of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from ...arrays import FloatArray, IntArray
from ...model.term import Memory
from ..drivers.loops import Loops
from ..gather.source import Depths
from ..gather.stencils import Stencils
from ..gather.touching import Touching
from ..nearby.candidates import among
from ..nearby.placed import Placed
from ..nearby.searches import Nearby
from ..nearby.seen import Seen
from ..points.barrier import Stop, barrier_points, convex
from .guarded import Pairing

# How far beyond the barrier pairs get places in the matrix, in units of the distance at which they touch.
_MARGIN: Final = 0.1


class Guard:
    """Keeps pairs of a kind at a distance; implements :class:`.source.Source`."""

    steady = True

    def __init__(self, pairing: Pairing, stop: Stop, nearby: Nearby, loops: Loops) -> None:
        self._all, self._stop, self._nearby, self._loops = pairing, stop, nearby, loops
        self._seen: dict[float, Seen] = {}
        self._placed = Placed(pairing.name, self._lay_out)

    def recall(self, memory: Memory) -> None:
        """Take up the pairs that have places."""
        self._placed.recall(memory)

    def memory(self, x: FloatArray) -> Memory:
        """The pairs that have places."""
        return self._placed.memory(self._around(x))

    def detect(self, x: FloatArray) -> bool:
        """Give places to all pairs nearby if one that touches has none."""
        return self._placed.detect(self._within(x, self._stop.begin), lambda: self._around(x))

    def touching(self, x: FloatArray, v: FloatArray, t: float, factor: float) -> Iterator[Touching]:
        """Pairs within the barrier."""
        keys, placed = self._within(x, self._stop.begin), self._placed.keys
        item = np.searchsorted(placed, keys[among(keys, placed)])
        if not len(item):
            return
        (stencils,), traits = self.stencils, self._traits
        thickness = traits.thickness[item]
        points = barrier_points(
            self._all.closest(np.ascontiguousarray(x[stencils.nodes[item]].transpose(1, 2, 0))),
            self._stop.least * thickness,
            (self._stop.begin - self._stop.least) * thickness,
            factor * traits.stiffness[item],
        )
        points = replace(convex(points), item=item)
        yield Touching(
            kind=0,
            stencils=stencils,
            strips=points,
            between=traits.between,
            moving=lambda: stencils.relative(points, v),
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
        found = self._nearby.coming(x0, x1, self._stop.nearest)
        if not len(found):
            return 1.0
        keys = self._all.parts(found)
        stop = self._stop.nearest * self._all.reach(keys)
        return self._loops.safe_way(x0, x1 - x0, self._all.spans(keys), stop, np.zeros(len(keys)))

    def _around(self, x: FloatArray) -> IntArray:
        """Keys of pairs within the barrier or a little beyond it."""
        return self._within(x, self._stop.begin + _MARGIN)

    def _within(self, x: FloatArray, share: float) -> IntArray:
        """Keys of pairs nearer than a share of the distance at which they touch, ascending."""
        seen = self._seen.get(share)
        if seen is None or not seen.is_of(x):
            found = self._nearby.closer(x, share)
            keys = self._all.parts(found) if len(found) else found
            nothing = np.empty(0)
            touch = self._all.reach(keys) if len(keys) else nothing
            distance = self._all.distances(x, keys, self._loops) if len(keys) else nothing
            # kept until other places are asked for
            seen = self._seen[share] = Seen(x.copy(), keys, touch, distance)
        return seen.nearer(share * seen.touch)

    def _lay_out(self, keys: IntArray) -> None:
        """What pairs with these keys touch with."""
        self._stencils = (Stencils(self._all.map, self._all.nodes(keys)),)
        self._traits = self._all.traits(keys)
