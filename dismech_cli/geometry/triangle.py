"""The azimuth of a half-plane about an edge, with derivatives: the one angle all shell bending uses.

The half-plane through the edge v and a point f (relative to the edge's tail) turns about v when v
or f moves. The dihedral angle of a hinge is the difference of the azimuths of its two faces, and a
face normal turns about each edge of its face with the azimuth of the opposite corner. An azimuth
has a zero direction only by convention (parallel transport of v), so its second derivative with
respect to v has an antisymmetric part which cancels in differences; here it is left out.

The formulas condense those of Tamstorf & Grinspun 2013 for dihedral angles.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .kernel import kernel
from .vectors import Vector, combine, cross, dot, norm, scale


@kernel
def azimuth_gradient(v: Vector, f: Vector) -> Any:
    """Slopes of the azimuth along the half-plane's normal.

    Returns:
        ``(n, area, length, gv, gf)``: unit normal n = v x f / area, twice the triangle's area, |v|,
        and the slopes: d(azimuth) = gv n.dv + gf n.df.
    """
    m = cross(v, f)
    area, length = norm(m), norm(v)
    return scale(1.0 / area, m), area, length, -dot(v, f) / (length * area), length / area


@kernel
def azimuth_hessian(v: Vector, f: Vector, n: Vector, area: Any, length: Any) -> Any:
    """Vectors (x, y, w, z) of the symmetric part of the azimuth's Hessian.

    The blocks are vv = n x^T + x n^T, vf = n y^T + w n^T (row v, column f), ff = n z^T + z n^T.
    """
    along = dot(v, f) / (length * length)
    inverse = 1.0 / area
    k = along * length * inverse * inverse
    t = cross(v, n)
    # Part of f across the edge, per edge length.
    across = scale(1.0 / length, combine(1.0, f, -along, v))
    x = combine(-0.5 * inverse, across, k, cross(f, n))
    w = scale(-k, t)
    y = combine(-inverse / length, v, 1.0, w)
    return x, y, w, scale(length * inverse * inverse, t)


@kernel
def dihedral_angle(e: Vector, a: Vector, b: Vector) -> Any:
    """Angle [rad] between the faces (e, a) and (b, e) at the edge e; 0 where they are flat.

    Both points are relative to the tail of e. The angle grows when the normals e x a and b x e
    turn away from each other, b's about +e.
    """
    m = cross(e, a)
    return np.arctan2(-norm(e) * dot(m, b), dot(m, cross(b, e)))


@kernel
def nearest_turn(angle: Any) -> Any:
    """The same angle [rad], taken the short way round: in [-pi, pi)."""
    turn = 2.0 * np.pi
    return angle - turn * np.floor(angle / turn + 0.5)
