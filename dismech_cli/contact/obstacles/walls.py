"""Lines against one obstacle."""

from __future__ import annotations

from dataclasses import field
from functools import partial

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...kinematics.dofs import DofMap
from ..gather.source import Depths
from ..gather.stencils import Stencils
from ..gather.touching import Remake, Touching, at_points
from ..law.between import Between
from ..law.stiffness import asked_for, impact_force
from ..nearby.advance import longest_way
from ..pieces.lines import Lines
from ..points.points import Points
from .obstacle import Obstacle

# Motion within a step may bring a line to half its radius from a surface, or half as near as it is.
_NEAREST = 0.5


@frozen
class Wall:
    """An obstacle and the lines that may touch it; see :mod:`.near_wall`.

    Attributes:
        obstacle: The obstacle.
        lines: The lines, S of them.
        numbers: Their numbers among all lines, shape (S,).
        stiffness: Per length [N/m^2], at factor one, shape (S,).
        friction: Coefficients, shape (S,).
        labels: Number of the pair of bodies of each line, shape (S,).
        map: Numbering of the DOFs.
        stencils: The two nodes of each line.
        between: What each line is to the obstacle.
    """

    obstacle: Obstacle
    lines: Lines
    numbers: IntArray
    stiffness: FloatArray
    friction: FloatArray
    labels: IntArray
    map: DofMap
    stencils: tuple[Stencils, ...] = field(init=False, repr=False, compare=False)
    between: Between = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "stencils", (Stencils(self.map, self.lines.nodes),))
        between = Between(self.friction, self.labels, np.ones(len(self.labels)))
        object.__setattr__(self, "between", between)

    def touching(self, x: FloatArray, v: FloatArray, t: float, factor: float) -> Touching:
        """Points of contact."""
        start, slope = self._lines(x)
        lines = self.lines
        scale = factor * self.stiffness * lines.weights * lines.lengths
        points = self.obstacle.points(t, start, slope, lines.radii, scale)
        return Touching(
            kind=0,
            stencils=self.stencils[0],
            strips=points,
            between=self.between,
            moving=lambda: self.velocities(points, x, v, t),
            again=partial(self.again, t=t, factor=factor),
        )

    def again(self, items: IntArray, t: float, factor: float) -> Remake:
        """What finds the points of some of the lines at other places."""
        some = self.some(items)
        scale, pose = factor * some.stiffness * some.lines.weights * some.lines.lengths, self.obstacle.pose

        def remake(x: FloatArray, v: FloatArray) -> tuple[Points, FloatArray]:
            start, end = (np.ascontiguousarray(x[:, k].T) for k in range(2))
            points = self.obstacle.points(t, start, end - start, some.lines.radii, scale)
            moved = at_points(points, v)
            return points, moved if pose.still else moved - pose.velocities(t, at_points(points, x))

        return remake

    def velocities(self, points: Points, x: FloatArray, v: FloatArray, t: float) -> FloatArray:
        """Velocities of the lines against the surface at points of contact [m/s], shape (3, K)."""
        (stencils,) = self.stencils
        moved = stencils.relative(points, v)
        if self.obstacle.pose.still:
            return moved
        return moved - self.obstacle.pose.velocities(t, stencils.relative(points, x))

    def gaps(self, x: FloatArray, t: float) -> FloatArray:
        """Distance of the middle of each line from the surface [m], shape (S,); below zero inside."""
        return self.obstacle.gaps(t, *self._lines(x))

    def depths(self, x: FloatArray, t: float) -> Depths:
        """Penetration of each line."""
        radii = self.lines.radii
        shares = np.maximum(radii - self.gaps(x, t), 0.0) / (2.0 * radii)
        return Depths(self.numbers, shares, self.labels)

    def needed(self, x: FloatArray, ahead: FloatArray, t: float, dt: float, tolerance: float) -> float:
        """Factor of the stiffness that stops in time what comes in the next step.

        Args:
            x: Nodes [m], shape (N, 3).
            ahead: Where they would be after the step, shape (N, 3).
            t: Time [s].
            dt: Step [s].
            tolerance: Depth that is allowed as a share of the thickness.
        """
        later = self.gaps(ahead, t + dt)
        coming = np.flatnonzero(later < self.lines.radii)
        if not len(coming):
            return 0.0
        some = self.some(coming)
        later = later[coming]
        approach = np.maximum(some.gaps(x, t) - later, 0.0) / dt
        depth = tolerance * 2.0 * some.lines.radii
        force = impact_force(some.lines.masses, approach, depth, dt)
        start, slope = some._lines(ahead)
        # of lines so thick that they are as deep as they may be
        scale = some.stiffness * some.lines.weights * some.lines.lengths
        points = self.obstacle.points(t + dt, start, slope, later + depth, scale)
        held = np.zeros(len(coming))
        np.add.at(held, points.item, points.load)
        return asked_for(force, held, some.labels)

    def some(self, which: IntArray) -> Wall:
        """The same for some of the lines."""
        return Wall(
            self.obstacle,
            self.lines.some(which),
            self.numbers[which],
            self.stiffness[which],
            self.friction[which],
            self.labels[which],
            self.map,
        )

    def longest_step(self, x0: FloatArray, x1: FloatArray, t0: float, t1: float) -> float:
        """Part of the way from ``x0`` to ``x1`` on which no line gets inside."""
        # what the obstacle does to a point of space is what the point would do to the obstacle
        ends0, ends1 = self.inward(x0, t0), self.inward(x1, t1)
        way = ends1 - ends0
        starts, ways = ends0.reshape(3, -1, 2), way.reshape(3, -1, 2)
        speed = np.sqrt((way * way).sum(axis=0)).reshape(-1, 2).max(axis=1)

        def gap_at(part: FloatArray, which: IntArray) -> FloatArray:
            ends = starts[:, which] + part[:, None] * ways[:, which]
            return self.obstacle.shape.gaps(ends[:, :, 0], ends[:, :, 1] - ends[:, :, 0])

        return longest_way(gap_at, speed, _NEAREST * self.lines.radii)

    def inward(self, x: FloatArray, t: float) -> FloatArray:
        """Ends of the lines in the frame of the obstacle [m], both of a line in a row, shape (3, 2 S)."""
        return self.obstacle.pose.at(t).inward(x[self.lines.nodes].reshape(-1, 3).T)

    def _lines(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        ends = x[self.lines.nodes]
        start = np.ascontiguousarray(ends[:, 0].T)
        return start, np.ascontiguousarray(ends[:, 1].T) - start
