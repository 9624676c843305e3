"""Quadratic drag of the air or water that a shell pushes along its normal.

Each corner of a triangle of rest area A feels f = -(rho c A / 6) |w| w n, with w = u.n the normal
part of the corner's velocity u and n the triangle's unit normal.
Parameters per stencil: rho c A / 6 [kg/m].
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..geometry.blocks import entries
from ..geometry.kernel import kernel
from ..geometry.vectors import combine, cross, dot, norm, outer, scale
from ..kernels.shape import DragKernel
from ..kinematics.dofs import DofMap
from ..model.drag import DragForce


@kernel
def _corner(n: Any, u: Any, ta: Any, tb: Any, k: Any) -> Any:
    """Share of one corner: force, and the rows of its slopes to a, to b and to u."""
    w = dot(u, n)
    size = k * np.abs(w)
    # dn = ta (n.da) + tb (n.db);  d(|w| w n) = 2 |w| n dw + |w| w dn
    ga = combine(2.0 * size * dot(u, ta), n, size * w, ta)
    gb = combine(2.0 * size * dot(u, tb), n, size * w, tb)
    return (
        entries(scale(size * w, n)),
        entries(outer(ga, n)),
        entries(outer(gb, n)),
        entries(outer(scale(2.0 * size, n), n)),
    )


@kernel
def aerodynamic(y: Any, u: Any, p: Any) -> Any:
    """Residual shares of the three corners, slopes to (x1 - x0, x2 - x0) and to the velocities."""
    a, b = y[0:3], y[3:6]
    m = cross(a, b)
    inverse = 1.0 / norm(m)
    n = scale(inverse, m)
    # in-plane normals of the sides opposite x1 and x2, over twice the area
    ta, tb = scale(-inverse, cross(b, n)), scale(inverse, cross(a, n))
    f0, a0, b0, c0 = _corner(n, u[0:3], ta, tb, p[0])
    f1, a1, b1, c1 = _corner(n, u[3:6], ta, tb, p[0])
    f2, a2, b2, c2 = _corner(n, u[6:9], ta, tb, p[0])
    z = 0.0 * inverse
    none, pair = (z, z, z), (z, z, z, z, z, z)
    stiffness = (
        a0[:3] + b0[:3] + a0[3:6] + b0[3:6] + a0[6:] + b0[6:]
        + a1[:3] + b1[:3] + a1[3:6] + b1[3:6] + a1[6:] + b1[6:]
        + a2[:3] + b2[:3] + a2[3:6] + b2[3:6] + a2[6:] + b2[6:]
    )  # fmt: skip
    damping = (
        c0[:3] + pair + c0[3:6] + pair + c0[6:] + pair
        + none + c1[:3] + none + none + c1[3:6] + none + none + c1[6:] + none
        + pair + c2[:3] + pair + c2[3:6] + pair + c2[6:]
    )  # fmt: skip
    return f0 + f1 + f2, stiffness, damping


AERODYNAMIC = DragKernel(
    aerodynamic, dimension=3, nodes=3, vectors=((0, 1), (0, 2)), loaded=(0, 1, 2), constants=("drag",)
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
    return DragForce.of(
        name,
        AERODYNAMIC,
        dofs.of_nodes(triangles).reshape(len(triangles), -1),
        {"drag": (fluid_density * coefficient / 6.0) * areas},
    )
