"""Kernels of follower loads: a force that turns with the frame of an edge or a triangle.

Parameters per stencil: the force along the vectors of the frame [N or N/m], for a triangle the constants
alpha, beta_u, beta_v of ``geometry/face_rotation.py`` [1/m], and the weight of the force on each node
[1 or m]. Auxiliary inputs of a framed edge: m1, m2.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..geometry.blocks import add_diagonal, entries, scale_block, side_by_side, with_column
from ..geometry.face_rotation import face_frame
from ..geometry.kernel import kernel
from ..geometry.vectors import combine, combine_block, cross, dot, norm, outer, scale
from ..kernels.shape import LoadKernel


@kernel
def follower_planar(y: Any, a: Any, p: Any) -> Any:
    """Residual on tail and head, and its slopes to the edge vector, in the plane."""
    il = 1.0 / np.sqrt(y[0] * y[0] + y[1] * y[1])
    tx, ty = il * y[0], il * y[1]
    # along t and its normal n; a change of the edge turns both by n.de / l
    fx, fy = p[0] * tx - p[1] * ty, p[0] * ty + p[1] * tx
    kxx, kxy, kyx, kyy = il * fy * ty, -il * fy * tx, -il * fx * ty, il * fx * tx
    v, w = -p[2], -p[3]
    return (
        (v * fx, v * fy, w * fx, w * fy),
        (v * kxx, v * kxy, v * kyx, v * kyy, w * kxx, w * kxy, w * kyx, w * kyy),
    )


@kernel
def follower_framed(y: Any, a: Any, p: Any) -> Any:
    """Residual on tail, head and angle, and its slopes to the edge vector and the angle."""
    il = 1.0 / norm(y[0:3])
    t = scale(il, y[0:3])
    f = combine(p[0], t, 1.0, combine(p[1], a[0:3], p[2], a[3:6]))
    # (t x de) x f / l = [(t.f) I - t f^T] de / l
    slope = add_diagonal(il * dot(t, f), outer(scale(-il, t), f))
    about = cross(t, f)
    z = 0.0 * il
    v, w = -p[3], -p[4]
    tail, head = scale(v, f), scale(w, f)
    return (
        (tail[0], tail[1], tail[2], head[0], head[1], head[2], z),
        with_column(scale_block(v, slope), scale(v, about))
        + with_column(scale_block(w, slope), scale(w, about))
        + (z, z, z, z),
    )


@kernel
def follower_face(y: Any, a: Any, p: Any) -> Any:
    """Residual on the corners, and its slopes to (x1 - x0, x2 - x0)."""
    u, v = y[0:3], y[3:6]
    g, h, n, _, area, pu, pv = face_frame(u, v, p[3], p[4], p[5])
    f = combine(p[0], g, 1.0, combine(p[1], h, p[2], n))
    # about n as the polar rotation says, across it as n turns: w = n (p.d) + (u n.dv - v n.du) / area
    about = cross(n, f)
    by_u = combine_block(1.0, outer(about, pu), -1.0 / area, outer(cross(v, f), n))
    by_v = combine_block(1.0, outer(about, pv), 1.0 / area, outer(cross(u, f), n))
    s0, s1, s2 = -p[6], -p[7], -p[8]
    return (
        entries(scale(s0, f)) + entries(scale(s1, f)) + entries(scale(s2, f)),
        side_by_side(scale_block(s0, by_u), scale_block(s0, by_v))
        + side_by_side(scale_block(s1, by_u), scale_block(s1, by_v))
        + side_by_side(scale_block(s2, by_u), scale_block(s2, by_v)),
    )


_ENDS = ("share_0", "share_1")
FOLLOWER_PLANAR = LoadKernel(
    follower_planar,
    dimension=2,
    nodes=2,
    vectors=((0, 1),),
    constants=("force_0", "force_1", *_ENDS),
)
FOLLOWER_FRAMED = LoadKernel(
    follower_framed,
    dimension=3,
    nodes=2,
    vectors=((0, 1),),
    constants=("force_0", "force_1", "force_2", *_ENDS),
    angles=1,
    auxiliaries=6,
)
FOLLOWER_FACE = LoadKernel(
    follower_face,
    dimension=3,
    nodes=3,
    vectors=((0, 1), (0, 2)),
    constants=("force_0", "force_1", "force_2", "alpha", "beta_u", "beta_v", *_ENDS, "share_2"),
)
