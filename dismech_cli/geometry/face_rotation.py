"""The rotation of a triangle: of its normal, and about it that of the polar decomposition.

A triangle with sides u, v moves with an in-plane deformation gradient F, whose polar rotation takes
a direction G of the rest shape to (F + cof F) G, normalised: the closest rotation, by which pure
stretching turns nothing. With G along u at rest and G' across it, F G = alpha u and
F G' = beta_u u + beta_v v: :func:`face_axes`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import FloatArray
from .blocks import add_block, add_symmetric, two_sided
from .kernel import kernel
from .vectors import Vector, add, combine, cross, dot, norm, outer, scale, sub, sym_outer


def face_axes(u: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rest axes of faces with sides u, v [m], shape (S, 3).

    Returns:
        alpha, beta_u, beta_v [1/m], shape (3, S); unit vectors along u, across it and normal to the
        face, shape (S, 3, 3).
    """
    length = np.linalg.norm(u, axis=1)
    normal = np.cross(u, v)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    along = u / length[:, None]
    across = np.cross(normal, along)
    beta_v = 1.0 / (v * across).sum(axis=1)
    beta_u = -beta_v * (v * along).sum(axis=1) / length
    return np.stack((1.0 / length, beta_u, beta_v)), np.stack((along, across, normal), axis=1)


@kernel
def face_frame(u: Vector, v: Vector, alpha: Any, beta_u: Any, beta_v: Any) -> Any:
    """Rotated frame of a face with sides u, v, and the vectors that give its spin.

    Returns:
        ``(f, h, n, size, area, pu, pv)``: unit vectors along, across and normal; the norm of
        alpha u + (beta_u u + beta_v v) x n, which points along f; twice the area; the spin about n
        is pu.du + pv.dv.
    """
    m = cross(u, v)
    area = norm(m)
    n = scale(1.0 / area, m)
    # (F + cof F) G of the reference direction G: the rotation of the polar decomposition in the plane
    w = combine(alpha, u, 1.0, cross(combine(beta_u, u, beta_v, v), n))
    size = norm(w)
    f = scale(1.0 / size, w)
    h = cross(n, f)
    return f, h, n, size, area, combine(alpha / size, h, -beta_u / size, f), scale(-beta_v / size, f)


@kernel
def face_turning(
    m: Vector,
    u: Vector,
    v: Vector,
    f: Vector,
    h: Vector,
    n: Vector,
    size: Any,
    area: Any,
    alpha: Any,
    beta_u: Any,
    beta_v: Any,
    pu: Vector,
    pv: Vector,
) -> Any:
    """Blocks uu, uv, vv of m . (change of the face's spin) along straight paths of u and v."""
    ia, ig = 1.0 / area, dot(m, n) / size
    # dual basis of the face, and its spin's coefficients along m
    du, dv = scale(ia, cross(v, n)), scale(ia, cross(n, u))
    mu, mv, cu, cv = ia * dot(u, m), ia * dot(v, m), dot(du, m), dot(dv, m)
    qu, qv = combine(alpha, f, beta_u, h), scale(beta_v, h)
    fu, fv, hu, hv = dot(f, du), dot(f, dv), dot(h, du), dot(h, dv)
    # n.du and n.dv times these slopes, each halved to make a symmetric matrix
    half = scale(0.5 * ia, m)
    shared = combine(0.5 * mv, dv, -0.5 * mu, du)
    nu_u = combine(mv, du, 0.5 * ig * (hu * alpha - fu * beta_u), n)
    nu_u = combine(1.0, nu_u, -0.5 * cu, pu)
    nu_v = combine(1.0, shared, 0.5 * ig * (hv * alpha - fu * beta_v - fv * beta_u), n)
    nu_v = combine(1.0, nu_v, -0.5 * cu, pv)
    nv_v = combine(-mu, dv, -0.5 * ig * fv * beta_v, n)
    nv_v = combine(1.0, nv_v, -0.5 * cv, pv)
    nv_u = combine(1.0, shared, -0.5 * cv, pu)
    uu = add_symmetric(sym_outer(n, nu_u), sym_outer(scale(-ig, pu), qu))
    vv = add_symmetric(sym_outer(n, nv_v), sym_outer(scale(-ig, pv), qv))
    one, two = sub(nu_v, half), add(nv_u, half)
    uv = add_block(two_sided(n, one, two), outer(scale(-ig, pu), qv))
    return uu, add_block(uv, outer(scale(-ig, qu), pv)), vv
