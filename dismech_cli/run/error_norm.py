"""How large the error of a step is, against the motion so far."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from ..arrays import FloatArray
from ..kinematics.motion import held_dofs
from ..model.model import Model

# Motion counts as at least this share of the robot's size, and turning as at least this angle [rad].
_LEAST, _LEAST_TURN = 1e-3, 0.1


@dataclass(frozen=True, slots=True)
class Size:
    """Root mean squares over what is free and has mass.

    Attributes:
        way: Of nodes [m].
        turn: Of edge angles [rad].
    """

    way: float = 0.0
    turn: float = 0.0

    def larger(self, other: Size) -> Size:
        """The larger of each."""
        return Size(max(self.way, other.way), max(self.turn, other.turn))


@dataclass(frozen=True, slots=True)
class ErrorNorm:
    """Measures changes of shape.

    Attributes:
        model: Whose shapes.
        start: Where motion is counted from, shape (n,).
        extent: Size of the rest shape [m].
    """

    model: Model
    start: FloatArray
    extent: float

    def size(self, x: FloatArray, t: float) -> Size:
        """Of a change (n,) of what is free from time ``t`` [s] on."""
        model = self.model
        free = (model.mass > 0.0) & ~held_dofs(model.motions, model.dofs.n, t)
        squares = np.where(free, x * x, 0.0)
        count = model.dofs.n_positions
        # per node, of which planar ones have two components
        nodes = int(np.count_nonzero(free[:count])) / model.dofs.dimension
        angles = int(np.count_nonzero(free[count:]))
        way = float(squares[:count].sum()) / max(nodes, 1.0)
        return Size(sqrt(way), sqrt(float(squares[count:].sum()) / max(angles, 1)))

    def moved(self, q: FloatArray, t: float) -> Size:
        """Of the way from the start to a shape (n,)."""
        return self.size(q - self.start, t)

    def share(self, error: FloatArray, motion: Size, t: float) -> float:
        """Size of an error (n,) in units of the largest motion so far; infinite if it is no number."""
        found, extent = self.size(error, t), self.extent
        way = found.way / min(max(motion.way, _LEAST * extent), extent)
        share = max(way, found.turn / min(max(motion.turn, _LEAST_TURN), 1.0))
        return share if np.isfinite(share) else float("inf")
