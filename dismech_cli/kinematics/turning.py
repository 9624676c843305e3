"""How frames that are carried from step to step turn when the path that carried them varies.

Parallel transport from a unit tangent t0 to another t1 keeps a frame from spinning, but on another path it
arrives turned about t1, by the area between both paths on the unit sphere (holonomy). For variations of
both tangents that is, per step,

    d(sigma) = -kb.(dt0 + dt1) / 2,   kb = 2 t0 x t1 / (1 + t0.t1)

sigma counts what the frame of an edge turns beyond the change of its angle DOF and beyond the transport to
the varied tangent.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class TurningEdges:
    """Edges whose frames are carried from step to step.

    Attributes:
        tails: Position DOFs of the first node of each edge, shape (3, E).
        heads: Position DOFs of the second node, shape (3, E).
        angles: DOFs of their angles, shape (E,).
        varied: Whether the tangent matrices of kernels know how transport to a trial point turns frames.
    """

    tails: IntArray
    heads: IntArray
    angles: IntArray
    varied: bool

    @property
    def shared(self) -> bool:
        """Whether edges share an angle: then it does not tell by how much each has turned."""
        return len(np.unique(self.angles)) < len(self.angles)

    def along(self, x: FloatArray) -> FloatArray:
        """Head less tail of a vector (n,) or of columns (n, P), shape (3, E) or (3, E, P)."""
        difference: FloatArray = x[self.heads] - x[self.tails]
        return difference

    def holonomy(self, q0: FloatArray, q1: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Slopes of sigma to the edge vectors at both ends of a transport [rad/m], each of shape (3, E).

        Args:
            q0: Where the transport starts, shape (n,).
            q1: Where it ends.
        """
        e0, e1 = self.along(q0), self.along(q1)
        l0, l1 = (np.sqrt((e * e).sum(axis=0)) for e in (e0, e1))
        t0, t1 = e0 / l0, e1 / l1
        kb = 2.0 * np.cross(t0, t1, axis=0) / (1.0 + (t0 * t1).sum(axis=0))
        return -0.5 * kb / l0, -0.5 * kb / l1

    def add_along(self, x: FloatArray, by_edge: FloatArray) -> None:
        """Add to ``x`` (n,) what :meth:`along` transposed makes of a vector of each edge, shape (3, E)."""
        np.add.at(x, self.heads, by_edge)
        np.subtract.at(x, self.tails, by_edge)
