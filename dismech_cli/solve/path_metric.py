"""Length along a path of equilibria (q, lambda): what makes metres, radians and load factors one number."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from ..model.model import Model

# The unit of length of a path, for displacements: root mean square, as a share of the robot's size.
_SHARE = 0.1


@frozen
class Way:
    """A way along a path, or its direction.

    Attributes:
        q: Of positions and angles, shape (n,).
        load: Of the load factor.
    """

    q: FloatArray
    load: float


@frozen
class PathMetric:
    """Inner product of two ways along a path.

    Attributes:
        weights: Of each DOF, shape (n,).
        load: Of the load factor.
    """

    weights: FloatArray
    load: float

    @classmethod
    def of(cls, model: Model, load_factor: float) -> PathMetric:
        """One unit is a tenth of the robot's size, half a turn, or the whole load factor; RMS of each."""
        n, split = model.dofs.n, model.dofs.n_positions
        nodes = max(split // model.dofs.dimension, 1)
        extent = float(np.ptp(model.dofs.positions(model.rest), axis=0).max())
        weights = np.full(n, 1.0 / (nodes * (_SHARE * extent) ** 2))
        weights[split:] = 1.0 / (max(n - split, 1) * pi**2)
        return cls(weights, 1.0 / load_factor**2)

    def dot(self, a: Way, b: Way) -> float:
        """Their inner product."""
        return float((self.weights * a.q) @ b.q) + self.load * a.load * b.load

    def length(self, a: Way) -> float:
        """Length of a way."""
        return sqrt(self.dot(a, a))
