"""Quadratic drag of the air or water that a shell pushes along its normal.

Each corner of a triangle of rest area A feels f = -(rho c A / 6) |w| w n, with w = u.n the normal
part of the corner's velocity u and n the triangle's unit normal.
Parameters per stencil: rho c A / 6 [kg/m].
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..geometry.kernel import kernel
from ..geometry.vectors import combine, cross, dot, norm, scale
from ..model.dofs import DofMap
from ..model.drag import DragForce, DragKernel


@kernel
def _corner(n: Any, u: Any, ta: Any, tb: Any, k: Any) -> Any:
    """Share of one corner: force, its rows of slopes to a and b, its slope to u (3x3)."""
    w = dot(u, n)
    size = k * np.abs(w)
    # dn = ta (n.da) + tb (n.db);  d(|w| w n) = 2 |w| n dw + |w| w dn
    sa, sb = 2.0 * size * dot(u, ta), 2.0 * size * dot(u, tb)
    ga, gb = combine(sa, n, size * w, ta), combine(sb, n, size * w, tb)
    g = scale(2.0 * size, n)
    rows = (
        ga[0] * n[0], ga[0] * n[1], ga[0] * n[2], gb[0] * n[0], gb[0] * n[1], gb[0] * n[2],
        ga[1] * n[0], ga[1] * n[1], ga[1] * n[2], gb[1] * n[0], gb[1] * n[1], gb[1] * n[2],
        ga[2] * n[0], ga[2] * n[1], ga[2] * n[2], gb[2] * n[0], gb[2] * n[1], gb[2] * n[2],
    )  # fmt: skip
    slope = (
        (g[0] * n[0], g[0] * n[1], g[0] * n[2]),
        (g[1] * n[0], g[1] * n[1], g[1] * n[2]),
        (g[2] * n[0], g[2] * n[1], g[2] * n[2]),
    )
    return scale(size * w, n), rows, slope


@kernel
def aerodynamic(y: Any, u: Any, p: Any) -> Any:
    """Residual shares of the three corners, slopes to (x1 - x0, x2 - x0) and to the velocities."""
    a, b = (y[0], y[1], y[2]), (y[3], y[4], y[5])
    m = cross(a, b)
    inverse = 1.0 / norm(m)
    n = scale(inverse, m)
    # in-plane normals of the sides opposite x1 and x2, over twice the area
    ta, tb = scale(-inverse, cross(b, n)), scale(inverse, cross(a, n))
    f0, d0, c0 = _corner(n, (u[0], u[1], u[2]), ta, tb, p[0])
    f1, d1, c1 = _corner(n, (u[3], u[4], u[5]), ta, tb, p[0])
    f2, d2, c2 = _corner(n, (u[6], u[7], u[8]), ta, tb, p[0])
    z = 0.0 * inverse
    none, pair = (z, z, z), (z, z, z, z, z, z)
    damping = (
        c0[0] + pair + c0[1] + pair + c0[2] + pair
        + none + c1[0] + none + none + c1[1] + none + none + c1[2] + none
        + pair + c2[0] + pair + c2[1] + pair + c2[2]
    )  # fmt: skip
    return f0 + f1 + f2, d0 + d1 + d2, damping


AERODYNAMIC = DragKernel(
    aerodynamic, dimension=3, nodes=3, vectors=((0, 1), (0, 2)), loaded=(0, 1, 2), parameters=1
)


def aerodynamic_drag(
    name: str,
    dofs: DofMap,
    triangles: IntArray,
    areas: FloatArray,
    *,
    fluid_density: float,
    coefficient: float,
) -> DragForce:
    """Build the drag of a set of triangles.

    Args:
        name: Unique name.
        dofs: Numbering.
        triangles: Wetted triangles, shape (T, 3).
        areas: Rest areas [m^2], shape (T,).
        fluid_density: rho [kg/m^3].
        coefficient: Drag coefficient c [1].
    """
    parameters = (fluid_density * coefficient / 6.0) * areas[None, :]
    return DragForce(
        name, AERODYNAMIC, dofs.of_nodes(triangles).reshape(len(triangles), -1), np.array(parameters)
    )
