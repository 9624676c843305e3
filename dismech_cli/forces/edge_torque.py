"""The part along its edge of a moment on a shell with free mid-edge normals.

A moment M of fixed direction does the work M.w of the turning w of an edge and its normal. The part of w
across the edge is a matter of its two nodes (``forces/moment.py``). The part along its tangent t is
d(xi) + s.dv: xi turns the normal stored at the start of the step, parallel-transported with the edge v,
and the transport itself turns that normal about v by s per change of v,

    s = -(d x v) / (l (l + d.v)),   l = |v|, d the stored tangent

(energies/midedge.py). The force on the head is therefore (M.t) s, and M.t acts on xi.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..geometry.blocks import scale_block, with_column
from ..geometry.kernel import kernel
from ..geometry.vectors import combine, combine_block, cross, dot, norm, outer, scale, spin
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Pattern
from ..kernels.shape import LoadKernel
from ..laws.signal import Signal
from ..model.load import BoundLoad
from ..model.term import BoundTerm


@kernel
def edge_torque(y: Any, a: Any, p: Any) -> Any:
    """Residual on tail, head and xi, and its slopes to the edge vector and xi."""
    v, d, moment = y[0:3], a[0:3], p[0:3]
    length = norm(v)
    t = scale(1.0 / length, v)
    along = dot(d, v)
    w = 1.0 / (length * (length + along))
    turn = cross(d, v)
    s = scale(-w, turn)
    torque = dot(moment, t)
    by_torque = scale(1.0 / length, combine(1.0, moment, -torque, t))
    # dw = by_w . dv, ds = -w [d]x dv - (d x v) dw
    by_w = scale(-w * w, combine(2.0, v, 1.0, combine(along, t, length, d)))
    z = 0.0 * torque
    turning = combine_block(1.0, outer(s, by_torque), -torque, outer(turn, by_w))
    slope = combine_block(1.0, turning, 1.0, spin(z, scale(-torque * w, d)))
    f, still = scale(torque, s), (z, z, z)
    return (
        (f[0], f[1], f[2], -f[0], -f[1], -f[2], -torque),
        with_column(slope, still)
        + with_column(scale_block(-1.0, slope), still)
        + (-by_torque[0], -by_torque[1], -by_torque[2], z),
    )


EDGE_TORQUE = LoadKernel(
    edge_torque,
    dimension=3,
    nodes=2,
    vectors=((0, 1),),
    constants=("moment_x", "moment_y", "moment_z"),
    angles=1,
    auxiliaries=3,
)


@frozen
class EdgeTorque:
    """Torques about shell edges.

    Attributes:
        name: Unique name.
        tails: Position DOFs of the tails, shape (K, 3).
        heads: Position DOFs of the heads, shape (K, 3).
        angles: DOFs xi, shape (K,).
        stored: Places of the stored tangents in the auxiliary array of the frames, shape (K, 3).
        moments: Moment on each edge at unit scale [N m], shape (K, 3).
        signal: Scale over time [1].
    """

    name: str
    tails: IntArray
    heads: IntArray
    angles: IntArray
    stored: IntArray
    moments: FloatArray
    signal: Signal
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
        """Make the loop."""
        moments = dict(zip(EDGE_TORQUE.constants, self.moments.T, strict=True))
        return BoundLoad.of(
            self.name, EDGE_TORQUE, self.dofs, moments, self.signal, pattern, driver, self.stored
        )
