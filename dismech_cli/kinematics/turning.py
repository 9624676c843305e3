"""How frames that are carried from step to step turn when the path that carried them varies.

Parallel transport from a unit tangent t0 to another t1 keeps a frame from spinning, but on another path it
arrives turned about t1, by the area between both paths on the unit sphere (holonomy). For variations of
both tangents that is, per step,

    d(sigma) = -kb.(dt0 + dt1) / 2,   kb = 2 t0 x t1 / (1 + t0.t1)

sigma counts what the frame of an edge turns beyond the change of its angle DOF and beyond the transport to
the varied tangent.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray, distinct
from ..frozen import frozen


@frozen
class Holonomy:
    """How the frames of some edges turn with the ends of the C ways that they were carried along.

    Attributes:
        before: Slope of sigma to the edge vectors where a way starts [rad/m], shape (C, 3, E).
        after: To those where it ends.
        edge: The edge vectors there [m], shape (C, 3, E).
        length: Their lengths, shape (C, E).
    """

    before: FloatArray
    after: FloatArray
    edge: FloatArray
    length: FloatArray


def crossed(a: FloatArray, b: FloatArray) -> FloatArray:
    """Cross products of columns, shape (3, ...)."""
    return np.stack((a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]))


@frozen
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
        return len(distinct(self.angles)) < len(self.angles)

    def along(self, x: FloatArray) -> FloatArray:
        """Head less tail of a vector (n,) or of columns (n, P), shape (3, E) or (3, E, P)."""
        difference: FloatArray = x[self.heads] - x[self.tails]
        return difference

    def holonomy(self, q0: FloatArray, q1: FloatArray) -> Holonomy:
        """That of transports from shapes (C, n) to others."""
        e0, e1 = self.along(q0.T).swapaxes(1, 2), self.along(q1.T).swapaxes(1, 2)
        l0, l1 = (np.sqrt((e * e).sum(axis=0)) for e in (e0, e1))
        half = crossed(e0, e1) / -(l0 * l1 + (e0 * e1).sum(axis=0))
        before, after, edge = (np.ascontiguousarray(x.swapaxes(0, 1)) for x in (half / l0, half / l1, e1))
        return Holonomy(before, after, edge, l1)

    def add_along(self, x: FloatArray, by_edge: FloatArray) -> None:
        """Add to ``x`` (n,) what :meth:`along` transposed makes of a vector of each edge, shape (3, E)."""
        np.add.at(x, self.heads, by_edge)
        np.subtract.at(x, self.tails, by_edge)
