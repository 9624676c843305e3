"""A moment of fixed direction on edges: a couple of nodal forces across the edge.

The couple (M x t)/l on the head and its opposite on the tail does the work M.w of the edge's
rotation; the part of M along t turns the edge's angle. The direction of M is fixed in space, so
the load is conservative in the plane only and the tangent is not symmetric in space.

Where the edge carries an angle, its frame turns by half the area that t sweeps around a loop. The
symmetric tangents of the elastic energies leave out what the torque they balance does on that turn,
a skew term (M.t)/2 [t]x / l^2; the tangent here makes up for it, so that Newton's method sees the
derivative of the whole balance.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..arrays import FloatArray, IntArray
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Pattern
from ..laws.laws import Law
from ..model.clique import BoundCliques
from ..model.configuration import Configuration
from ..model.term import BoundTerm


@dataclass(frozen=True, slots=True)
class EdgeMoment:
    """Moments on edges.

    Attributes:
        name: Unique name.
        tails: Position DOFs of the tails, shape (K, d).
        heads: Position DOFs of the heads, shape (K, d).
        angles: Angle DOFs, shape (K,), or (0,) where edges carry none.
        axes: Space axes of the d components.
        moments: Moment on each edge at unit scale [N m], shape (K, 3).
        law: Scale over time [1].
    """

    name: str
    tails: IntArray
    heads: IntArray
    angles: IntArray
    axes: tuple[int, ...]
    moments: FloatArray
    law: Law
    velocity_dependent: ClassVar[bool] = False

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """Both nodes of each edge, and its angle."""
        return (Coupling(self._dofs, symmetric=False),)

    @property
    def _dofs(self) -> IntArray:
        parts = [self.tails, self.heads]
        if self.angles.size:
            parts.append(self.angles[:, None])
        return np.concatenate(parts, axis=1)

    def bind(self, pattern: Pattern, driver: Driver) -> BoundTerm:
        """Look the entries up."""
        return BoundCliques.of(self.name, self._dofs, pattern, self._evaluate)

    def _evaluate(self, c: Configuration) -> tuple[FloatArray, FloatArray]:
        axes = list(self.axes)
        moment = float(self.law(c.t)) * self.moments
        e = np.zeros((len(moment), 3))
        e[:, axes] = c.q[self.heads] - c.q[self.tails]
        square = (e * e).sum(axis=1)[:, None]
        couple = np.cross(moment, e) / square
        # d(M x e / e.e)/de = [M]x / e.e - 2 couple e^T / e.e
        d = np.zeros((len(moment), 3, 3))
        d[:, 0, 1], d[:, 0, 2], d[:, 1, 2] = -moment[:, 2], moment[:, 1], -moment[:, 0]
        d -= d.transpose(0, 2, 1)
        d = (d - 2.0 * couple[:, :, None] * e[:, None, :]) / square[:, :, None]
        if self.angles.size:
            # M.t [t]x / l^2, with t = e/l
            along = (moment * e).sum(axis=1)[:, None, None] / square[:, :, None] ** 2
            d -= 0.5 * along * np.cross(np.eye(3), e[:, None, :])
        k, f = d[:, axes][:, :, axes], couple[:, axes]
        n = len(axes)
        size = self._dofs.shape[1]
        residual = np.zeros((len(moment), size))
        residual[:, :n], residual[:, n : 2 * n] = f, -f
        tangent = np.zeros((len(moment), size, size))
        tangent[:, :n, :n], tangent[:, :n, n : 2 * n] = -k, k
        tangent[:, n : 2 * n, :n], tangent[:, n : 2 * n, n : 2 * n] = k, -k
        if self.angles.size:
            length = np.sqrt(square)
            t = e / length
            residual[:, -1] = -(moment * t).sum(axis=1)
            slope = -(moment + residual[:, -1:] * t) / length  # d(-M.t)/de
            tangent[:, -1, :n], tangent[:, -1, n : 2 * n] = -slope, slope
        return residual, tangent
