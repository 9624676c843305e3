"""Resistive force theory of slender bodies in viscous fluid (Gray & Hancock 1955).

Each node feels f = -l [c_n u + (c_t - c_n) t (t.u)], with the tangent t of the chord between its
neighbours. Parameters per stencil: weight length l [m], c_t, c_n [N s/m^2].
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..geometry.kernel import kernel
from ..geometry.vectors import combine, dot, norm, scale
from ..kernels.shape import DragKernel
from ..kinematics.dofs import DofMap
from ..model.drag import DragForce


@kernel
def resistive(y: Any, u: Any, p: Any) -> Any:
    """Residual share on the centre node, its tangents to the chord and to the velocity."""
    chord = norm(y)
    t = scale(1.0 / chord, y)
    along = dot(t, u)
    normal = p[0] * p[2]
    excess = p[0] * (p[1] - p[2])
    r = combine(normal, u, excess * along, t)
    # d(t (t.u))/dy = [(t.u) P + t (P u)^T] / |y|,  P = I - t t^T
    s = excess / chord
    w = combine(1.0, u, -2.0 * along, t)
    d0, d1, d2 = scale(s, t)
    sa = s * along
    stiffness = (
        d0 * w[0] + sa, d0 * w[1], d0 * w[2],
        d1 * w[0], d1 * w[1] + sa, d1 * w[2],
        d2 * w[0], d2 * w[1], d2 * w[2] + sa,
    )  # fmt: skip
    e0, e1, e2 = scale(excess, t)
    damping = (
        e0 * t[0] + normal, e0 * t[1], e0 * t[2],
        e1 * t[0], e1 * t[1] + normal, e1 * t[2],
        e2 * t[0], e2 * t[1], e2 * t[2] + normal,
    )  # fmt: skip
    return r, stiffness, damping


@kernel
def resistive_planar(y: Any, u: Any, p: Any) -> Any:
    """The same in the plane."""
    chord = np.sqrt(y[0] * y[0] + y[1] * y[1])
    tx, ty = y[0] / chord, y[1] / chord
    along = tx * u[0] + ty * u[1]
    normal = p[0] * p[2]
    excess = p[0] * (p[1] - p[2])
    s = excess / chord
    wx, wy = u[0] - 2.0 * along * tx, u[1] - 2.0 * along * ty
    return (
        (normal * u[0] + excess * along * tx, normal * u[1] + excess * along * ty),
        (s * (tx * wx + along), s * tx * wy, s * ty * wx, s * (ty * wy + along)),
        (excess * tx * tx + normal, excess * tx * ty, excess * ty * tx, excess * ty * ty + normal),
    )


RESISTIVE = DragKernel(
    resistive,
    dimension=3,
    nodes=3,
    vectors=((0, 2),),
    loaded=(1,),
    constants=("length", "tangential", "normal"),
)
RESISTIVE_PLANAR = replace(RESISTIVE, function=resistive_planar, dimension=2)


def resistive_force(
    name: str, dofs: DofMap, edges: IntArray, lengths: FloatArray, tangential: float, normal: float
) -> DragForce:
    """Build the drag of a set of rod edges.

    A node between two edges has the chord of its neighbours as tangent; at ends and junctions
    each adjacent edge acts with half its length and its own direction.

    Args:
        name: Unique name.
        dofs: Numbering.
        edges: Rod edges in the fluid, shape (E, 2).
        lengths: Rest lengths [m], shape (E,).
        tangential: c_t [N s/m^2].
        normal: c_n [N s/m^2].
    """
    ends = edges.reshape(-1)
    others = edges[:, ::-1].reshape(-1)
    halves = np.repeat(0.5 * lengths, 2)
    degree = np.bincount(ends, minlength=dofs.n_nodes)
    order = np.argsort(ends, kind="stable")
    order = order[degree[ends[order]] == 2]
    first, second = order[0::2], order[1::2]
    # Walk from the neighbour on the earlier edge to that on the later one.
    chords = np.stack((others[first], ends[first], others[second]), axis=1)
    single = np.flatnonzero(degree[ends] != 2)
    sides = np.stack((ends[single], ends[single], others[single]), axis=1)
    nodes = np.concatenate((chords, sides))
    weights = np.concatenate((halves[first] + halves[second], halves[single]))
    kernels = {3: RESISTIVE, 2: RESISTIVE_PLANAR}
    return DragForce.of(
        name,
        kernels[dofs.dimension],
        dofs.of_nodes(nodes).reshape(len(nodes), -1),
        {"length": weights, "tangential": tangential, "normal": normal},
    )
