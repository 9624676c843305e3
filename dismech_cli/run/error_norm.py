"""How large the error of a step is, against the motion so far."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import sqrt

import numpy as np

from ..arrays import FloatArray
from ..kinematics.motion import held_dofs
from ..model.model import Model

# Motion counts as at least this share of the robot's size, and as at most the whole of it.
_LEAST = 1e-3


@dataclass(frozen=True)
class ErrorNorm:
    """Root mean square over the nodes of what is free and has mass [m].

    Angles count as the way of a circle of gyration: a rod of radius r that turns by an angle moves by
    r / sqrt(2) times that. Its torsion is faster than all that bends; measured in radians it would set
    the step.

    Attributes:
        model: Whose changes of shape are measured.
        start: Where motion is counted from, shape (n,).
        extent: Size of the rest shape [m].
    """

    model: Model
    start: FloatArray
    extent: float

    @cached_property
    def _squares(self) -> FloatArray:
        """Squares of the way per change of each DOF, shape (n,); 0 without mass."""
        mass, count = self.model.mass, self.model.dofs.n_positions
        nodes = mass[:count][mass[:count] > 0.0]
        squares = np.where(mass > 0.0, 1.0, 0.0)
        squares[count:] = mass[count:] / (np.median(nodes) if nodes.size else 1.0)
        return squares

    def size(self, x: FloatArray, t: float) -> float:
        """Of a change (n,) of what is free from time ``t`` [s] on."""
        dofs = self.model.dofs
        weights = np.where(held_dofs(self.model.motions, dofs.n, t), 0.0, self._squares)
        # per node, of which planar ones have two components
        nodes = int(np.count_nonzero(weights[: dofs.n_positions])) / dofs.dimension
        return sqrt(float(weights @ (x * x)) / max(nodes, 1.0))

    def moved(self, q: FloatArray, t: float) -> float:
        """Of the way from the start to a shape (n,), less that of what is held.

        A base that carries a robot along does not move it: measured against that way, steps would not see
        how it swings.
        """
        way, dofs = q - self.start, self.model.dofs
        ways = dofs.positions(way)
        held = held_dofs(self.model.motions, dofs.n, t)[: dofs.n_positions].reshape(ways.shape)
        ways -= np.where(held, ways, 0.0).sum(axis=0) / np.maximum(held.sum(axis=0), 1)
        return self.size(way, t)

    def share(self, error: FloatArray, motion: float, t: float) -> float:
        """Size of an error (n,) in units of the largest motion so far; infinite if it is no number."""
        share = self.size(error, t) / min(max(motion, _LEAST * self.extent), self.extent)
        return share if np.isfinite(share) else float("inf")
