"""Bending in the plane: E = EI (kappa - kappa0)^2 / (2 l_v), kappa = 2 tan(phi/2).

phi is the turning angle from edge e to edge f, positive from the first to the second axis of the
plane; kappa is the integrated curvature of the discrete elastic rod (Bergou et al. 2008). At a corner phi
counts from the angle at rest, phi0: edge f is turned back by it, so that the corner is as stiff as the
beams on its sides, and the one pole is a turn by pi from rest.

Parameters per stencil, after the natural curvature kappa0 [1]: EI [N m^2], Voronoi length l_v [m]; at
corners cos phi0, sin phi0 [1].
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from ..geometry.kernel import kernel
from ..kernels.shape import Kernel


@kernel
def bent(y: Any, ee: Any, ff: Any, sine: Any, cosine: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian, from |e||f| times the sine and the cosine of phi."""
    ex, ey, fx, fy = y
    # |e||f| (1 + cos phi) vanishes at a fold, where kappa and E are rightly infinite.
    kappa = 2.0 * sine / ((ee * ff) ** 0.5 + cosine)
    stiffness = p[1] / p[2]
    elastic = kappa - p[0]
    slope = 1.0 + 0.25 * kappa * kappa  # d kappa / d phi
    d1 = stiffness * elastic * slope  # dE / d phi
    d2 = stiffness * slope * (slope + 0.5 * elastic * kappa)  # d2E / d phi2
    # grad of an edge's direction angle is u = (-y, x)/|.|^2; its Hessian -(u w^T + w u^T), w = (x, y)/|.|^2
    ux, uy, wx, wy = -ey / ee, ex / ee, ex / ee, ey / ee
    sx, sy, zx, zy = -fy / ff, fx / ff, fx / ff, fy / ff
    gradient = (-d1 * ux, -d1 * uy, d1 * sx, d1 * sy)
    hessian = (
        d2 * ux * ux + 2.0 * d1 * ux * wx,
        d2 * ux * uy + d1 * (ux * wy + uy * wx),
        -d2 * ux * sx,
        -d2 * ux * sy,
        d2 * uy * uy + 2.0 * d1 * uy * wy,
        -d2 * uy * sx,
        -d2 * uy * sy,
        d2 * sx * sx - 2.0 * d1 * sx * zx,
        d2 * sx * sy - d1 * (sx * zy + sy * zx),
        d2 * sy * sy - 2.0 * d1 * sy * zy,
    )
    return 0.5 * stiffness * elastic * elastic, gradient, hessian


@kernel
def bend_planar(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to the edge vectors (e, f)."""
    ex, ey, fx, fy = y
    return bent(y, ex * ex + ey * ey, fx * fx + fy * fy, ex * fy - ey * fx, ex * fx + ey * fy, p)


@kernel
def corner_planar(y: Any, a: Any, p: Any) -> Any:
    """The same with phi from its angle at rest."""
    ex, ey, fx, fy = y
    sine, cosine, c, s = ex * fy - ey * fx, ex * fx + ey * fy, p[3], p[4]
    ee, ff = ex * ex + ey * ey, fx * fx + fy * fy
    return bent(y, ee, ff, c * sine - s * cosine, c * cosine + s * sine, p)


BEND_PLANAR = Kernel(
    bend_planar,
    dimension=2,
    nodes=3,
    vectors=((0, 1), (1, 2)),
    naturals=("kappa",),
    constants=("EI", "voronoi"),
    scales=(("EI",),),
)
CORNER_PLANAR = replace(
    BEND_PLANAR,
    function=corner_planar,
    constants=("EI", "voronoi", "cos_phi0", "sin_phi0"),
    shares=("bending",),
)
