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

from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..geometry.blocks import entries, scale_block, with_column
from ..geometry.kernel import kernel
from ..geometry.vectors import combine, combine_block, cross, dot, norm, outer, scale, spin
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Pattern
from ..kernels.shape import LoadKernel
from ..laws.signal import Signal
from ..model.load import BoundLoad
from ..model.term import BoundTerm


@kernel
def moment(y: Any, a: Any, p: Any) -> Any:
    """Residual on tail and head, and its slopes to the edge vector."""
    e, m = y[0:3], p[0:3]
    inverse = 1.0 / dot(e, e)
    f = scale(inverse, cross(m, e))
    # d(M x e / e.e) = ([M]x - 2 f e^T) de / e.e
    turning = spin(0.0 * inverse, scale(inverse, m))
    slope = combine_block(1.0, turning, -2.0 * inverse, outer(f, e))
    return (
        (f[0], f[1], f[2], -f[0], -f[1], -f[2]),
        entries(slope) + entries(scale_block(-1.0, slope)),
    )


@kernel
def moment_framed(y: Any, a: Any, p: Any) -> Any:
    """Residual on tail, head and angle, and its slopes to the edge vector and the angle."""
    e, m = y[0:3], p[0:3]
    inverse = 1.0 / dot(e, e)
    f = scale(inverse, cross(m, e))
    z = 0.0 * inverse
    # M.t [t]x / l^2, by halves, makes up for the turning of the frame
    along = inverse * inverse * dot(m, e)
    turning = spin(z, combine(inverse, m, -0.5 * along, e))
    slope = combine_block(1.0, turning, -2.0 * inverse, outer(f, e))
    length = norm(e)
    t = scale(1.0 / length, e)
    torque = dot(m, t)
    by_torque = scale(1.0 / length, combine(-1.0, m, torque, t))
    still = (z, z, z)
    return (
        (f[0], f[1], f[2], -f[0], -f[1], -f[2], -torque),
        with_column(slope, still)
        + with_column(scale_block(-1.0, slope), still)
        + (by_torque[0], by_torque[1], by_torque[2], z),
    )


@kernel
def moment_planar(y: Any, a: Any, p: Any) -> Any:
    """Residual on tail and head, and its slopes to the edge vector, in the plane."""
    ex, ey, m = y[0], y[1], p[0]
    inverse = 1.0 / (ex * ex + ey * ey)
    fx, fy = -m * inverse * ey, m * inverse * ex
    kxx, kxy = -2.0 * inverse * fx * ex, -m * inverse - 2.0 * inverse * fx * ey
    kyx, kyy = m * inverse - 2.0 * inverse * fy * ex, -2.0 * inverse * fy * ey
    return (fx, fy, -fx, -fy), (kxx, kxy, kyx, kyy, -kxx, -kxy, -kyx, -kyy)


MOMENT = LoadKernel(
    moment,
    dimension=3,
    nodes=2,
    vectors=((0, 1),),
    constants=("moment_x", "moment_y", "moment_z"),
)
MOMENT_FRAMED = replace(MOMENT, function=moment_framed, angles=1)
MOMENT_PLANAR = replace(MOMENT, function=moment_planar, dimension=2, constants=("moment",))


def plane_normal(axes: tuple[int, ...]) -> FloatArray:
    """Normal of the plane of two space axes, about which the first turns to the second, shape (3,)."""
    first, second = np.eye(3)[list(axes)]
    return np.cross(first, second)


@frozen
class EdgeMoment:
    """Moments on edges.

    Attributes:
        name: Unique name.
        tails: Position DOFs of the tails, shape (K, d).
        heads: Position DOFs of the heads, shape (K, d).
        angles: Angle DOFs, shape (K,), or (0,) where edges carry none.
        axes: Space axes of the d components.
        moments: Moment on each edge at unit scale [N m], shape (K, 3).
        signal: Scale over time [1].
    """

    name: str
    tails: IntArray
    heads: IntArray
    angles: IntArray
    axes: tuple[int, ...]
    moments: FloatArray
    signal: Signal
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
        """Make the loop."""
        if len(self.axes) == 2:
            # a moment within the plane would push out of it
            chosen, moments = MOMENT_PLANAR, {"moment": self.moments @ plane_normal(self.axes)}
        else:
            chosen = MOMENT_FRAMED if self.angles.size else MOMENT
            moments = dict(zip(chosen.constants, self.moments.T, strict=True))
        return BoundLoad.of(self.name, chosen, self._dofs, moments, self.signal, pattern, driver)
