"""A floor by the family's own law: each node for itself."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ...arrays import FloatArray
from ...model.term import Memory
from ..gather.source import Depths
from ..gather.stencils import Stencils
from ..gather.touching import Touching
from ..law.loads import Loads
from ..points.points import Points
from ..points.softplus import Softplus, floor_points
from .obstacle import HalfSpace
from .walls import Wall


class FamilyFloor:
    """A plane and the nodes that touch it; implements :class:`.source.Source`."""

    def __init__(self, wall: Wall, plane: HalfSpace, law: Softplus, loads: Loads) -> None:
        """Place all nodes of the lines for ever: a plane couples nothing that they do not.

        Args:
            wall: The obstacle and its lines.
            plane: Its shape.
            law: How nodes press.
            loads: What their friction goes by.
        """
        self._wall, self._plane, self._law, self._loads = wall, plane, law, loads
        ends = wall.lines.nodes.reshape(-1)
        self._nodes, first = np.unique(ends, return_index=True)
        self._line, at = np.divmod(first, 2)
        self._ends = np.stack((1.0 - at, at.astype(np.float64)))
        self._between = wall.between.some(self._line)
        self._radii = wall.lines.radii[self._line]
        self.stencils: tuple[Stencils, ...] = (Stencils(wall.map, wall.lines.nodes[self._line]),)
        self.steady = wall.obstacle.pose.still
        self._t = 0.0

    def recall(self, memory: Memory) -> None:
        """Take up what friction goes by."""
        self._loads.recall(memory)

    def memory(self, x: FloatArray) -> Memory:
        """What friction goes by in the next step, at the end of one of which depths were asked last."""
        points = self._points(x, self._t)
        return self._loads.memory(self._nodes[points.item], points.load)

    def detect(self, x: FloatArray) -> bool:
        """All nodes have places for ever."""
        return False

    def touching(self, x: FloatArray, v: FloatArray, t: float, factor: float) -> Iterator[Touching]:
        """Nodes within the width of the law, whose stiffness is given: the factor is one."""
        points = self._points(x, t)
        if not len(points.item):
            return
        on_lines = replace(points, item=self._line[points.item])
        yield Touching(
            kind=0,
            stencils=self.stencils[0],
            strips=points,
            between=self._between,
            moving=lambda: self._wall.velocities(on_lines, x, v, t),
            lagged=self._loads.of(self._nodes[points.item]),
        )

    def velocities(self, touching: Touching, x: FloatArray, v: FloatArray, t: float) -> FloatArray:
        """Velocities of the nodes against the plane [m/s], shape (3, K)."""
        on_lines = replace(touching.points, item=self._line[touching.points.item])
        return self._wall.velocities(on_lines, x, v, t)

    def depths(self, x: FloatArray, t: float) -> Depths:
        """Penetration of the nodes, each told of a line."""
        self._t = t
        shares = np.maximum(-self._heights(x, t), 0.0) / (2.0 * self._radii)
        return Depths(self._wall.numbers[self._line], shares, self._wall.labels[self._line])

    def needed(self, x: FloatArray, ahead: FloatArray, t: float, dt: float, tolerance: float) -> float:
        """Nothing: the stiffness is given."""
        return 0.0

    def longest_step(self, x0: FloatArray, x1: FloatArray, t0: float, t1: float) -> float:
        """All of it: what is below the plane is pushed out from there."""
        return 1.0

    def _heights(self, x: FloatArray, t: float) -> FloatArray:
        """Of the surfaces at the nodes above the plane [m], shape (K,)."""
        own = self._wall.obstacle.pose.at(t).inward(x[self._nodes].T)
        height: FloatArray = self._plane.normal @ (own - self._plane.point[:, None]) - self._radii
        return height

    def _points(self, x: FloatArray, t: float) -> Points:
        """Points of contact within the width of the law, their items numbers of nodes."""
        normal = self._wall.obstacle.pose.at(t).turn @ self._plane.normal
        heights = self._heights(x, t)
        near = np.flatnonzero(heights < self._law.width)
        return floor_points(near, heights[near], self._ends[:, near], normal, self._law)
