"""The part along its edge of a moment on a shell with free mid-edge normals.

A moment M of fixed direction does the work M.w of the turning w of an edge and its normal. The part of w
across the edge is a matter of its two nodes (``forces/moment.py``). The part along its tangent t is
d(xi) + s.dv: xi turns the normal stored at the start of the step, parallel-transported with the edge v,
and the transport itself turns that normal about v by s per change of v,

    s = -(d x v) / (l (l + d.v)),   l = |v|, d the stored tangent

(energies/midedge.py). The force on the head is therefore (M.t) s, and M.t acts on xi.
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
class EdgeTorque:
    """Torques about shell edges.

    Attributes:
        name: Unique name.
        tails: Position DOFs of the tails, shape (K, 3).
        heads: Position DOFs of the heads, shape (K, 3).
        angles: DOFs xi, shape (K,).
        stored: Places of the stored tangents in the auxiliary array of the frames, shape (K, 3).
        moments: Moment on each edge at unit scale [N m], shape (K, 3).
        law: Scale over time [1].
    """

    name: str
    tails: IntArray
    heads: IntArray
    angles: IntArray
    stored: IntArray
    moments: FloatArray
    law: Law
    velocity_dependent: ClassVar[bool] = False

    @property
    def dofs(self) -> IntArray:
        """DOFs of each edge: tail, head, xi, shape (K, 7)."""
        return np.concatenate((self.tails, self.heads, self.angles[:, None]), axis=1)

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """Both nodes of each edge, and its angle."""
        return (Coupling(self.dofs, symmetric=False),)

    def bind(self, pattern: Pattern, driver: Driver) -> BoundTerm:
        """Look the entries up."""
        return BoundCliques.of(self.name, self.dofs, pattern, self._evaluate)

    def _evaluate(self, c: Configuration) -> tuple[FloatArray, FloatArray]:
        moment = float(self.law(c.t)) * self.moments
        v = c.q[self.heads] - c.q[self.tails]
        d = c.frames.auxiliary[self.stored]
        length = np.sqrt((v * v).sum(axis=1))[:, None]
        t = v / length
        along = (d * v).sum(axis=1)[:, None]
        w = 1.0 / (length * (length + along))
        cross = np.cross(d, v)
        spin = -w * cross
        torque = (moment * t).sum(axis=1)[:, None]
        d_torque = (moment - torque * t) / length
        # [d]x, and the slope of w
        turn = np.cross(d[:, None, :], np.eye(3)).transpose(0, 2, 1)
        d_w = -w * w * (2.0 * v + along * t + length * d)
        d_spin = -w[:, :, None] * turn - cross[:, :, None] * d_w[:, None, :]
        slope = spin[:, :, None] * d_torque[:, None, :] + torque[:, :, None] * d_spin
        residual = np.concatenate((torque * spin, -torque * spin, -torque), axis=1)
        tangent = np.zeros((len(v), 7, 7))
        tangent[:, 0:3, 0:3], tangent[:, 0:3, 3:6] = -slope, slope
        tangent[:, 3:6, 0:3], tangent[:, 3:6, 3:6] = slope, -slope
        tangent[:, 6, 0:3], tangent[:, 6, 3:6] = d_torque, -d_torque
        return residual, tangent
