"""Rigid motion of what is held together: rotations one after another, then a displacement."""

from __future__ import annotations

from typing import Final

import numpy as np

from ..arrays import FloatArray
from ..errors import LawError
from ..frozen import frozen
from ..laws.laws import Law

# Parts of a step by which the spin of several rotations is summed: it need only be right to half a turn.
_PARTS: Final = 32


@frozen
class Turn:
    """A rotation about a line fixed in space.

    Attributes:
        axis: Unit vector along it, shape (3,).
        angle: Right-handed angle over time [rad].
        centre: A point of the line [m], shape (3,).
    """

    axis: FloatArray
    angle: Law
    centre: FloatArray

    def matrix(self, t: float) -> FloatArray:
        """The rotation at a time, shape (3, 3)."""
        x, y, z = self.axis
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        angle = float(self.angle(t))
        # 1 - cos without cancellation
        half = np.sin(0.5 * angle)
        out: FloatArray = np.eye(3) + np.sin(angle) * cross + 2.0 * half * half * (cross @ cross)
        return out


@frozen
class Rigid:
    """Rotations in their order, each about a line of its own that the others leave where it is.

    Attributes:
        name: For messages.
        turns: At least one.
    """

    name: str
    turns: tuple[Turn, ...]

    @property
    def constant(self) -> bool:
        """Whether nothing ever turns."""
        return all(turn.angle.constant for turn in self.turns)

    def rotation(self, t: float) -> FloatArray:
        """All rotations together at a time, shape (3, 3)."""
        total = np.eye(3)
        for turn in self.turns:
            total = turn.matrix(t) @ total
        return total

    def moved(self, t: float, x: FloatArray) -> FloatArray:
        """Where points x (N, 3) are at a time [m]."""
        for turn in self.turns:
            x = turn.centre + (x - turn.centre) @ turn.matrix(t).T
        return x

    def refuse_leaps(self, before: float, t: float) -> None:
        """Refuse a step in which anything turns by half a turn or more: which way is then unknown.

        Raises:
            LawError: It does.
        """
        for turn in self.turns:
            angle = abs(float(turn.angle(t)) - float(turn.angle(before)))
            if angle >= np.pi:
                raise LawError(
                    f"{self.name} turns by {angle:.3g} rad in one step, from t = {before:g} to {t:g}: "
                    "less than half a turn is needed; take shorter steps (dt, or load_steps)"
                )

    def spin(self, before: float, t: float, directions: FloatArray) -> FloatArray:
        """Angle by which carried lines turn about themselves between two times [rad], shape (K,).

        The integral of the angular velocity along the line: exact for the first rotation, whose axis
        stands at a fixed angle to the line, and a sum over parts of the step for those after it.

        Args:
            before: Start [s].
            t: End [s].
            directions: Their unit vectors at rest, shape (3, K).
        """
        ends = np.linspace(before, t, _PARTS + 1)
        total = np.zeros(directions.shape[1])
        for number, turn in enumerate(self.turns):
            if number == 0:
                total += (float(turn.angle(t)) - float(turn.angle(before))) * (turn.axis @ directions)
                continue
            for a, b in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True):
                there = directions
                for earlier in self.turns[:number]:
                    there = earlier.matrix(0.5 * (a + b)) @ there
                total += (float(turn.angle(b)) - float(turn.angle(a))) * (turn.axis @ there)
        return total
