"""Keeps pairs at a distance: by a barrier in the energy, and by stopping every motion short of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
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
from ..points.barrier import Stop, barrier_points, convex
from .guarded import Pairing

# How far beyond the barrier pairs get places in the matrix, in units of the distance at which they touch.
_MARGIN: Final = 0.1


@dataclass(frozen=True, slots=True)
class _Seen:
    """Pairs that may be near at some places of the nodes (N, 3)."""

    x: FloatArray
    keys: IntArray
    thickness: FloatArray
    distance: FloatArray

    def within(self, share: float) -> IntArray:
        """Keys of those nearer than a share of the distance at which they touch."""
        return self.keys[self.distance < share * self.thickness]


class Guard:
    """Keeps pairs of a kind at a distance; implements :class:`.source.Source`."""

    steady = True

    def __init__(self, pairing: Pairing, stop: Stop, nearby: Nearby, loops: Loops) -> None:
        self._all, self._stop, self._nearby, self._loops = pairing, stop, nearby, loops
        self._seen: _Seen | None = None
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
        near = np.flatnonzero((seen.distance < self._stop.begin * seen.thickness) & among(seen.keys, placed))
        if not len(near):
            return
        (stencils,), traits = self.stencils, self._traits
        item = np.searchsorted(placed, seen.keys[near])
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

    def _look(self, x: FloatArray) -> _Seen:
        """What is near; kept until other places are asked for."""
        if self._seen is None or not np.array_equal(self._seen.x, x):
            found = self._nearby.closer(x, self._stop.begin + _MARGIN)
            keys = self._all.parts(found) if len(found) else found
            nothing = np.empty(0)
            thickness = self._all.reach(keys) if len(keys) else nothing
            distance = self._all.distances(x, keys, self._loops) if len(keys) else nothing
            self._seen = _Seen(x.copy(), keys, thickness, distance)
        return self._seen

    def _lay_out(self, keys: IntArray) -> None:
        """What pairs with these keys touch with."""
        self._stencils = (Stencils(self._all.map, self._all.nodes(keys)),)
        self._traits = self._all.traits(keys)
