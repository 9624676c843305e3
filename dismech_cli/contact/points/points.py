"""Points of contact: what each adds to energy, force and stiffness, whatever feature it faces.

The gap vector x = sum_i w_i x_i runs from the feature that is faced to the point on the line. Where the
feature is spanned by nodes the weights of those follow the point of the line, with slopes G_i; that point
stays the closest one, so forces need no slopes: the gradient to node i is pull w_i x. The second derivative
of |x|^2 / 2 is w_i w_j Q - w_i G_j x^T - w_j x G_i^T - G_i.G_j x x^T, with Q = I at a corner, I - e e^T
beside an edge along e, and e e^T above a face of normal e.
"""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ..law.quadrature import density, second_derivative, within
from ..law.rubbing import friction_by_position, friction_by_velocity, friction_force, slip
from ..pieces.pieces import Pieces, spots


@frozen
class Points:
    """Points of contact on the items of one kind, n nodes each.

    Attributes:
        item: Item of each, shape (K,).
        s: Place on the line, shape (K,).
        weights: Of the nodes in the gap, those of the line first, shape (n, K).
        spread: Slopes of the weights [1/m], shape (n, 3, K).
        gap: Gap vector, or the normal of a plane, shape (3, K).
        normal: Unit vector of the force on the line, shape (3, K).
        energy: [J], shape (K,).
        pull: The gradient to node i is pull times weight times gap, shape (K,).
        along: Stiffness along the gap, shape (K,).
        bend: Factor of the second derivative of half the squared gap, shape (K,).
        load: Normal force [N], below zero where a feature is taken off again, shape (K,).
        growth: Slope of it along the gap [N/m], shape (K,).
        identity: See :class:`.pieces.Pieces`.
        axis: See there.
        e: See there.
        turn: How far the normal turns per length [1/m], shape (K,): 0 above a plane.
    """

    item: IntArray
    s: FloatArray
    weights: FloatArray
    spread: FloatArray
    gap: FloatArray
    normal: FloatArray
    energy: FloatArray
    pull: FloatArray
    along: FloatArray
    bend: FloatArray
    load: FloatArray
    growth: FloatArray
    identity: FloatArray
    axis: FloatArray
    e: FloatArray
    turn: FloatArray

    @property
    def points(self) -> Points:
        """Themselves; implements :class:`.strips.Strips`."""
        return self

    @property
    def table(self) -> None:
        """None."""
        return None

    @property
    def curved(self) -> bool:
        """Whether their stiffness is more than that along the gaps."""
        return bool(self.bend.any())

    def gradients(self) -> FloatArray:
        """dE/dx of the nodes [N], shape (n, 3, K)."""
        force: FloatArray = self.weights[:, None] * (self.pull * self.gap)
        return force

    def hessians(self) -> FloatArray:
        """Second derivatives, shape (n, n, 3, 3, K)."""
        w, spread, x = self.weights, self.spread, self.gap
        shape = self.axis * self.e[:, None] * self.e[None]
        shape[[0, 1, 2], [0, 1, 2]] += self.identity
        out: FloatArray = second_derivative(
            self.along,
            self.bend,
            w[:, None, None, None],
            w[None, :, None, None],
            (spread[:, None] * spread[None]).sum(axis=2)[:, :, None, None],
            spread[:, None, None, :],
            spread[None, :, :, None],
            x[:, None],
            x[None],
            shape,
        )
        return out

    def directions(self) -> FloatArray:
        """Vectors whose squares times ``along`` are the Hessian along the gaps, shape (n, 3, K)."""
        out: FloatArray = self.weights[:, None] * self.gap
        return out

    def friction(self, coefficient: FloatArray, sharpness: float, velocity: FloatArray) -> FloatArray:
        """Force against the slip [N], shape (3, K).

        Args:
            coefficient: mu, shape (K,).
            sharpness: Half of K [s/m].
            velocity: Relative velocity [m/s], shape (3, K).
        """
        force: FloatArray = friction_force(coefficient * self.load, sharpness, slip(velocity, self.normal))
        return force

    def friction_tangents(
        self, coefficient: FloatArray, sharpness: float, velocity: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Derivatives of that force to the gap vector and to the velocity, shapes (3, 3, K)."""
        u = slip(velocity, self.normal)
        load = coefficient * self.load
        e = self.e - (self.e * self.normal).sum(axis=0) * self.normal
        by_position = friction_by_position(
            load,
            coefficient * self.growth,
            sharpness,
            u,
            self.normal,
            e,
            self.identity * self.turn,
            self.axis * self.turn,
            velocity,
        )
        by_velocity = friction_by_velocity(load, sharpness, u, self.normal)
        return by_position.reshape(3, 3, -1), by_velocity.reshape(3, 3, -1)


def round_points(pieces: Pieces, reach: FloatArray, factor: FloatArray) -> Points:
    """Points of the energy sum over lines of factor (H^2 - |x|^2)^2 / (4 H^2).

    Args:
        pieces: Pieces of lines, by the feature that they face.
        reach: H of each item [m], shape (S,).
        factor: Stiffness times rest length times sign of each item [N/m], shape (S,).
    """
    near = pieces.within(reach)
    at = spots(near.low, near.high)
    near = near.some(at.piece)
    x = near.start + at.s * near.slope
    square = (x * x).sum(axis=0)
    h = reach[near.item]
    energy, pull, along, load, growth, turn = density(square, h, factor[near.item] * at.share)
    normal = x / (np.sqrt(square) + np.finfo(float).tiny)
    weights, spread = _weights(near, at.s)
    return Points(
        item=near.item,
        s=at.s,
        weights=weights,
        spread=spread,
        gap=x,
        normal=normal,
        energy=energy,
        pull=pull,
        along=along,
        bend=pull,
        load=load,
        growth=growth,
        identity=near.identity,
        axis=near.axis,
        e=near.e,
        turn=turn,
    )


def _weights(near: Pieces, s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Weights of the nodes of the line and of what it faces, and their slopes."""
    faced = near.along[0] + s * near.along[1]
    nothing = np.zeros((2, 3, len(s)))
    return np.concatenate((np.stack((1.0 - s, s)), -faced)), np.concatenate((nothing, near.spread))


def flat_points(
    start: FloatArray, slope: FloatArray, normal: FloatArray, reach: FloatArray, factor: FloatArray
) -> Points:
    """Points of the energy sum over lines of factor (H - g)^2 above a plane.

    Args:
        start: Height g of the lines at s = 0 [m], shape (S,).
        slope: Its growth to the other end [m], shape (S,).
        normal: Of the plane, shape (3,).
        reach: H of each line [m], shape (S,).
        factor: Stiffness times rest length of each line [N/m], shape (S,).
    """
    count = len(start)
    low, high = within(np.zeros(count), 0.5 * slope, start - reach, np.zeros(count), np.ones(count))
    kept = np.flatnonzero(high > low)
    at = spots(low[kept], high[kept])
    item = kept[at.piece]
    depth = np.maximum(reach[item] - start[item] - at.s * slope[item], 0.0)
    f = factor[item] * at.share
    n = np.broadcast_to(normal[:, None], (3, len(item)))
    zero = np.zeros(len(item))
    nothing = np.zeros((2, 3, len(item)))
    return Points(
        item=item,
        s=at.s,
        weights=np.stack((1.0 - at.s, at.s)),
        spread=nothing,
        gap=n,
        normal=n,
        energy=f * depth * depth,
        pull=-2.0 * f * depth,
        along=2.0 * f,
        bend=zero,
        load=2.0 * f * depth,
        growth=-2.0 * f,
        identity=zero,
        axis=zero,
        e=nothing[0],
        turn=zero,
    )
