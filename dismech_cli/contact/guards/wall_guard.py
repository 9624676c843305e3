"""Keeps lines at a distance from an obstacle."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...arrays import FloatArray, IntArray
from ...model.term import Memory
from ..gather.source import Depths
from ..gather.stencils import Stencils
from ..gather.touching import Touching
from ..nearby.advance import longest_way
from ..obstacles.walls import Wall
from ..points.barrier import Stop, barrier_points, convex

# A line is kept away by its closest point and both ends: a third of the energy each.
_THIRD = 1.0 / 3.0


class WallGuard:
    """Lines and an obstacle; implements :class:`.source.Source`."""

    def __init__(self, wall: Wall, stop: Stop) -> None:
        self._wall, self._stop = wall, stop
        self.stencils: tuple[Stencils, ...] = wall.stencils
        self.steady = wall.obstacle.pose.still

    def recall(self, memory: Memory) -> None:
        """Nothing is left to it."""

    def memory(self, x: FloatArray) -> Memory:
        """Nothing."""
        return {}

    def detect(self, x: FloatArray) -> bool:
        """All lines have places for ever."""
        return False

    def touching(self, x: FloatArray, v: FloatArray, t: float, factor: float) -> Iterator[Touching]:
        """Lines within the barrier."""
        wall, stop = self._wall, self._stop
        lines, core = wall.lines, wall.obstacle.shape.rounding
        ends = x[lines.nodes]
        start = np.ascontiguousarray(ends[:, 0].T)
        reach = core + stop.begin * lines.radii
        found = wall.obstacle.closest(t, start, np.ascontiguousarray(ends[:, 1].T) - start, reach)
        distance, least = found.distance, (core + stop.least * lines.radii)[found.item]
        near = distance < reach[found.item]
        if not near.any():
            return
        found = found.some(near)
        line = found.item
        scale = _THIRD * factor * wall.stiffness * lines.weights * lines.lengths
        points = convex(barrier_points(found, least[near], (reach[line] - least[near]), scale[line]))
        yield Touching(
            kind=0,
            stencils=self.stencils[0],
            strips=points,
            between=wall.between,
            moving=lambda: wall.velocities(points, x, v, t),
        )

    def velocities(self, touching: Touching, x: FloatArray, v: FloatArray, t: float) -> FloatArray:
        """Velocities of the lines against the surface at points of contact [m/s], shape (3, K)."""
        return self._wall.velocities(touching.points, x, v, t)

    def depths(self, x: FloatArray, t: float) -> Depths:
        """None: how deep lines are the wall itself says."""
        nothing = np.empty(0, dtype=np.int64)
        return Depths(nothing, np.empty(0), nothing)

    def needed(self, x: FloatArray, ahead: FloatArray, t: float, dt: float, tolerance: float) -> float:
        """Nothing: the wall itself says."""
        return 0.0

    def longest_step(self, x0: FloatArray, x1: FloatArray, t0: float, t1: float) -> float:
        """Part of the way on which all lines keep their distance."""
        wall = self._wall
        ends0, ends1 = wall.inward(x0, t0), wall.inward(x1, t1)
        way = ends1 - ends0
        starts, ways = ends0.reshape(3, -1, 2), way.reshape(3, -1, 2)
        speed = np.sqrt((way * way).sum(axis=0)).reshape(-1, 2).max(axis=1)
        least = self._stop.nearest * wall.lines.radii

        def gap_at(part: FloatArray, which: IntArray) -> FloatArray:
            ends = starts[:, which] + part[:, None] * ways[:, which]
            gaps = wall.obstacle.shape.gaps(ends[:, :, 0], ends[:, :, 1] - ends[:, :, 0])
            return gaps - least[which]

        return longest_way(gap_at, speed, np.zeros(len(least)))
