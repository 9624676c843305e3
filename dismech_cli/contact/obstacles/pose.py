"""Where a rigid obstacle is: its place and its turn as laws of time."""

from __future__ import annotations

from dataclasses import field
from typing import Final

import numpy as np

from ...arrays import FloatArray
from ...frozen import frozen
from ...laws.laws import Law

# Half of the difference quotient of a velocity, as a share of the larger of the time and a second: the
# error of the quotient and that of rounding are both far below what a step leaves.
_QUOTIENT: Final = 1e-6


def rotation(axis: FloatArray, angle: float) -> FloatArray:
    """Matrix of a turn about a unit axis, shape (3, 3)."""
    cross = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    matrix: FloatArray = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * (cross @ cross)
    return matrix


@frozen
class Frame:
    """The frame of an obstacle at a time: x = origin + turn y of a point y of its own.

    Attributes:
        origin: [m], shape (3, 1).
        turn: Rotation, shape (3, 3).
    """

    origin: FloatArray
    turn: FloatArray

    def inward(self, x: FloatArray) -> FloatArray:
        """Points of space in the obstacle's own coordinates, shape (3, K)."""
        local: FloatArray = self.turn.T @ (x - self.origin)
        return local

    def outward(self, y: FloatArray) -> FloatArray:
        """Points of the obstacle in space, shape (3, K)."""
        x: FloatArray = self.origin + self.turn @ y
        return x

    def turned(self, y: FloatArray) -> FloatArray:
        """Vectors of the obstacle in space, shape (3, K)."""
        x: FloatArray = self.turn @ y
        return x


@frozen
class Pose:
    """A rigid motion: a turn about an axis through a point, and a displacement.

    Attributes:
        place: The frame at rest.
        displacement: One law per component [m].
        axis: Unit axis of the turn, shape (3,).
        about: A point of the axis [m], shape (3,).
        angle: Law of the turn [rad].
    """

    place: Frame
    displacement: tuple[Law, ...]
    axis: FloatArray
    about: FloatArray
    angle: Law
    # the frame at the time last asked for: a trial point asks many times
    _last: dict[float, Frame] = field(init=False, repr=False, compare=False, default_factory=dict)

    @property
    def still(self) -> bool:
        """Whether it never moves."""
        return self.angle.constant and all(law.constant for law in self.displacement)

    def at(self, t: float) -> Frame:
        """The frame at time ``t`` [s]."""
        if self.still:
            t = 0.0
        if t not in self._last:
            frame = self._at(t)
            self._last.clear()
            self._last[t] = frame
        return self._last[t]

    def _at(self, t: float) -> Frame:
        moved = np.array([float(law(t)) for law in self.displacement])
        turn = rotation(self.axis, float(self.angle(t)))
        about = self.about[:, None]
        origin = about + moved[:, None] + turn @ (self.place.origin - about)
        return Frame(origin, turn @ self.place.turn)

    def velocities(self, t: float, x: FloatArray) -> FloatArray:
        """Velocities [m/s] of the points of the obstacle that are at ``x`` (3, K) at time ``t``."""
        if self.still:
            return np.zeros_like(x)
        h = _QUOTIENT * max(abs(t), 1.0)
        own = self.at(t).inward(x)
        early = max(t - h, 0.0)
        velocity: FloatArray = (self.at(t + h).outward(own) - self.at(early).outward(own)) / (t + h - early)
        return velocity
