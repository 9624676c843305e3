"""An obstacle that looks at the lines near it only."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Final

import numpy as np

from ...arrays import FloatArray, IntArray
from ...model.term import Memory
from ..gather.source import Depths
from ..gather.stencils import Stencils
from ..gather.touching import Touching
from .walls import Wall

# Lines count as near up to so many times the largest radius beyond where they touch.
_SKIN: Final = 4.0


class NearWall:
    """Implements :class:`.source.Source`; what it says does not depend on when it last looked around."""

    def __init__(self, wall: Wall) -> None:
        self._wall = wall
        self.stencils: tuple[Stencils, ...] = wall.stencils
        self.steady = wall.obstacle.pose.still
        self._skin = _SKIN * float(wall.lines.radii.max(initial=0.0))
        self._looked: FloatArray | None = None
        self._rows: IntArray = np.arange(len(wall.numbers))
        self._near = wall

    def recall(self, memory: Memory) -> None:
        """Nothing is left to it."""

    def memory(self, x: FloatArray) -> Memory:
        """Nothing."""
        return {}

    def detect(self, x: FloatArray) -> bool:
        """All lines have places for ever: an obstacle couples nothing that they do not."""
        return False

    def touching(self, x: FloatArray, v: FloatArray, t: float, factor: float) -> Iterator[Touching]:
        """Points of contact."""
        near = self._at(x, t)
        if not len(near.numbers):
            return
        touching = near.touching(x, v, t, factor)
        points = touching.points
        yield replace(
            touching,
            stencils=self.stencils[0],
            strips=replace(points, item=self._rows[points.item]),
            between=self._wall.between,
            again=partial(self._wall.again, t=t, factor=factor),
        )

    def velocities(self, touching: Touching, x: FloatArray, v: FloatArray, t: float) -> FloatArray:
        """Velocities of the lines against the surface at points of contact [m/s], shape (3, K)."""
        return self._wall.velocities(touching.points, x, v, t)

    def depths(self, x: FloatArray, t: float) -> Depths:
        """Penetration of the lines nearby."""
        return self._at(x, t).depths(x, t)

    def needed(self, x: FloatArray, ahead: FloatArray, t: float, dt: float, tolerance: float) -> float:
        """Factor of the stiffness that stops in time what comes in the next step."""
        near = self._at(ahead, t + dt)
        return near.needed(x, ahead, t, dt, tolerance) if len(near.numbers) else 0.0

    def longest_step(self, x0: FloatArray, x1: FloatArray, t0: float, t1: float) -> float:
        """Part of the way on which no line gets inside."""
        way = self._wall.inward(x1, t1) - self._wall.inward(x0, t0)
        if _farthest(way) > 0.5 * self._skin:
            return self._wall.longest_step(x0, x1, t0, t1)
        near = self._at(x0, t0)
        return near.longest_step(x0, x1, t0, t1) if len(near.numbers) else 1.0

    def _at(self, x: FloatArray, t: float) -> Wall:
        """The obstacle with the lines that are near at a time."""
        ends = self._wall.inward(x, t)
        if self._looked is None or not _farthest(ends - self._looked) <= 0.5 * self._skin:
            self._looked = ends
            self._rows = np.flatnonzero(self._wall.gaps(x, t) < self._wall.lines.radii + self._skin)
            self._near = self._wall.some(self._rows)
        return self._near


def _farthest(way: FloatArray) -> float:
    """Longest of vectors (3, K) [m]."""
    return float(np.sqrt((way * way).sum(axis=0).max(initial=0.0)))
