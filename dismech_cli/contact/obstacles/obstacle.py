"""Rigid obstacles: shapes that lines touch from outside."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np

from ...arrays import FloatArray
from ...frozen import frozen
from ..pieces.cores import Core, whole
from ..points.barrier import Closest
from ..points.closest import closest_to_rigid
from ..points.points import Points, flat_points, round_points
from .pose import Frame, Pose


class Shape(Protocol):
    """A solid in its own coordinates."""

    def points(self, start: FloatArray, slope: FloatArray, radii: FloatArray, factor: FloatArray) -> Points:
        """Points of contact of lines.

        Args:
            start: Ends of the lines at s = 0 [m], shape (3, E).
            slope: From there to the other ends [m], shape (3, E).
            radii: Of the lines [m], shape (E,).
            factor: Stiffness times rest length [N/m], shape (E,).
        """

    def gaps(self, start: FloatArray, slope: FloatArray) -> FloatArray:
        """Least distance of each line from the surface [m], shape (E,); below zero inside."""

    @property
    def rounding(self) -> float:
        """How far the surface is from the core that :meth:`closest` tells of [m]."""

    def closest(self, start: FloatArray, slope: FloatArray, more: FloatArray) -> Closest:
        """Closest points of lines and of their ends with the core; their items are the lines.

        What is farther away than ``more`` [m], shape (E,), may be left out.
        """


@frozen
class HalfSpace:
    """All below a plane.

    Attributes:
        point: A point of the plane [m], shape (3,).
        normal: Unit vector out of the solid, shape (3,).
    """

    point: FloatArray
    normal: FloatArray

    def points(self, start: FloatArray, slope: FloatArray, radii: FloatArray, factor: FloatArray) -> Points:
        """Points of contact of lines."""
        height, growth = self.normal @ (start - self.point[:, None]), self.normal @ slope
        return flat_points(height, growth, self.normal, radii, factor)

    def gaps(self, start: FloatArray, slope: FloatArray) -> FloatArray:
        """Height of the lower end of each line."""
        height, growth = self.normal @ (start - self.point[:, None]), self.normal @ slope
        lower: FloatArray = np.minimum(height, height + growth)
        return lower

    @property
    def rounding(self) -> float:
        """None."""
        return 0.0

    def closest(self, start: FloatArray, slope: FloatArray, more: FloatArray) -> Closest:
        """Feet of the ends on the plane; inside of it the gap is nothing."""
        n, zero = self.normal[:, None], np.zeros_like(start)
        height, growth = self.normal @ (start - self.point[:, None]), self.normal @ slope
        lower, upper = (
            whole(n * np.maximum(one, 0.0), zero, self.normal, 0.0, 1.0) for one in (height, height + growth)
        )
        found = closest_to_rigid(lower, (lower, upper), start.shape[1])
        return found.some(np.arange(2 * start.shape[1]))


@frozen
class Rounded:
    """All within a radius of a core.

    Attributes:
        core: A convex set.
        radius: [m].
    """

    core: Core
    radius: float

    def points(self, start: FloatArray, slope: FloatArray, radii: FloatArray, factor: FloatArray) -> Points:
        """Points of contact of lines."""
        return round_points(self.core.pieces(start, slope), self.radius + radii, factor)

    def gaps(self, start: FloatArray, slope: FloatArray) -> FloatArray:
        """Distance of each line."""
        return self.core.pieces(start, slope).nearest(start.shape[1]) - self.radius

    @property
    def rounding(self) -> float:
        """The radius."""
        return self.radius

    def closest(self, start: FloatArray, slope: FloatArray, more: FloatArray) -> Closest:
        """Closest points with the core."""
        nowhere = np.zeros_like(slope)
        ends = self.core.pieces(start, nowhere), self.core.pieces(start + slope, nowhere)
        return closest_to_rigid(self.core.pieces(start, slope), ends, start.shape[1])


@frozen
class Obstacle:
    """A rigid body that moves as it is told.

    Attributes:
        name: Its name.
        shape: Where its pose is that of t = 0.
        pose: Where it is.
    """

    name: str
    shape: Shape
    pose: Pose

    def points(
        self, t: float, start: FloatArray, slope: FloatArray, radii: FloatArray, factor: FloatArray
    ) -> Points:
        """Points of contact of lines in space at time ``t`` [s]."""
        frame = self.pose.at(t)
        found = self.shape.points(frame.inward(start), frame.turn.T @ slope, radii, factor)
        return _outward(found, frame)

    def gaps(self, t: float, start: FloatArray, slope: FloatArray) -> FloatArray:
        """Least distance of each line from the surface at time ``t`` [m], shape (E,)."""
        frame = self.pose.at(t)
        return self.shape.gaps(frame.inward(start), frame.turn.T @ slope)

    def closest(self, t: float, start: FloatArray, slope: FloatArray, more: FloatArray) -> Closest:
        """Closest points of lines in space with the core at time ``t`` [s]; see :class:`Shape`."""
        frame = self.pose.at(t)
        found = self.shape.closest(frame.inward(start), frame.turn.T @ slope, more)
        spread = np.einsum("ij,njk->nik", frame.turn, found.spread)
        return replace(found, gap=frame.turned(found.gap), e=frame.turned(found.e), spread=spread)


def _outward(points: Points, frame: Frame) -> Points:
    """Points with their vectors in space."""
    return replace(
        points,
        gap=frame.turned(points.gap),
        normal=frame.turned(points.normal),
        e=frame.turned(points.e),
    )
