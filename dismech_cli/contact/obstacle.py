"""Rigid obstacles: shapes that lines touch from outside."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from ..arrays import FloatArray
from .cores import Core
from .points import Points, flat_points, round_points
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


@dataclass(frozen=True, slots=True)
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


@dataclass(frozen=True, slots=True)
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


@dataclass(frozen=True, slots=True)
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


def _outward(points: Points, frame: Frame) -> Points:
    """Points with their vectors in space."""
    return replace(
        points,
        gap=frame.turned(points.gap),
        normal=frame.turned(points.normal),
        e=frame.turned(points.e),
    )
