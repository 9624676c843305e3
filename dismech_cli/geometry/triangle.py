"""The azimuth of a half-plane about an edge, with derivatives: the one angle all shell bending uses.

The half-plane through the edge v and a point f (relative to the edge's tail) turns about v when v
or f moves. The dihedral angle of a hinge is the difference of the azimuths of its two faces, and a
face normal turns about each edge of its face with the azimuth of the opposite corner. An azimuth
has a zero direction only by convention (parallel transport of v), so its second derivative with
respect to v has an antisymmetric part which cancels in differences; here it is left out.

The formulas condense those of Tamstorf & Grinspun 2013 for dihedral angles. With the foot of the
altitude from f at ``along`` v (0 at the tail, 1 at the head) and the inverse altitude s,
d(azimuth) = s n.(df - along dv), and all second derivatives are of n with two vectors of the plane:
the edge and the altitude.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .kernel import kernel
from .vectors import Vector, combine, cross, dot, norm, scale


@kernel
def side(v: Vector, f: Vector, inverse_area: Any) -> Any:
    """What the azimuth about v needs beside the normal.

    Args:
        v: Edge.
        f: Point, relative to the edge's tail.
        inverse_area: 1/|v x f|.

    Returns:
        ``(length, s, along, inverse)``: |v|, inverse altitude s [1/m] of f over v, foot of the altitude
        on v [1], and 1/|v|^2.
    """
    square = dot(v, v)
    length, inverse = np.sqrt(square), 1.0 / square
    return length, inverse_area * length, inverse * dot(v, f), inverse


@kernel
def azimuth_gradient(v: Vector, f: Vector) -> Any:
    """Slopes of the azimuth along the half-plane's normal.

    Returns:
        ``(n, s, along, inverse)``: unit normal n of v x f, the others as in :func:`side`:
        d(azimuth) = s n.(df - along dv).
    """
    m = cross(v, f)
    inverse_area = 1.0 / norm(m)
    _, s, along, inverse = side(v, f, inverse_area)
    return scale(inverse_area, m), s, along, inverse


@kernel
def azimuth_hessian(v: Vector, f: Vector, s: Any, along: Any, inverse: Any, t: Any) -> Any:
    """Vectors (x, y, w, z) of the symmetric part of t times the azimuth's Hessian.

    The blocks are vv = n x^T + x n^T, vf = n y^T + w n^T (row v, column f), ff = n z^T + z n^T. The
    weight t comes in here because numbers are cheaper to scale than vectors.

    Args:
        v: Edge.
        f: Point, relative to the edge's tail.
        s: From :func:`side`, as are ``along`` and ``inverse``.
        along: See ``s``.
        inverse: See ``s``.
        t: Weight: the moment that works on the azimuth.
    """
    altitude = combine(1.0, f, -along, v)
    cubic = t * (s * s * s)
    edge = t * s * inverse
    w = scale(cubic * along, altitude)
    x = combine(edge * along, v, -0.5 * edge - cubic * along * along, altitude)
    return x, combine(-edge, v, 1.0, w), w, scale(-cubic, altitude)


@kernel
def fold(n: Vector, m: Vector, b: Vector, s: Any) -> Any:
    """Dihedral angle [rad] from the normals of its faces, each taken from the edge to its own corner.

    Args:
        n: Unit normal of the first face.
        m: Unit normal of the second face.
        b: Corner of the second face, relative to the edge's tail.
        s: Inverse altitude of b over the edge: s n.b is the sine, exact where the fold is small.
    """
    return np.arctan2(-s * dot(n, b), -dot(n, m))


@kernel
def dihedral_angle(e: Vector, a: Vector, b: Vector) -> Any:
    """Angle [rad] between the faces (e, a) and (b, e) at the edge e; 0 where they are flat.

    Both points are relative to the tail of e. The angle grows when the normals e x a and b x e
    turn away from each other, b's about +e.
    """
    n, _, _, _ = azimuth_gradient(e, a)
    m, s, _, _ = azimuth_gradient(e, b)
    return fold(n, m, b, s)


@kernel
def nearest_turn(angle: Any) -> Any:
    """The same angle [rad], taken the short way round: in [-pi, pi)."""
    turn = 2.0 * np.pi
    return angle - turn * np.floor(angle / turn + 0.5)
