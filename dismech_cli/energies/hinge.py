"""Bending of a shell at its hinges: E = k (theta - theta_0)^2 / 2, theta the dihedral angle.

Stencil (x0, x1, x2, x3): x0 -> x1 is the shared edge, x2 the corner opposite in the first face, x3
in the second (Grinspun et al. 2003). Constant k is a plate on nets of equilateral triangles only.
Parameters per stencil, after the natural angle theta_0 [rad]: k [N m].
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..geometry.blocks import add_block, add_symmetric, pack_three, two_sided
from ..geometry.kernel import kernel
from ..geometry.triangle import azimuth_gradient, azimuth_hessian, dihedral_angle, nearest_turn
from ..geometry.vectors import combine, outer, scale, scale_symmetric, self_outer, sym_outer
from ..model.dofs import DofMap
from ..model.stencil import Kernel, StencilEnergy, no_auxiliaries


@kernel
def hinge(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to (x1 - x0, x2 - x0, x3 - x0)."""
    e, f, g = (y[0], y[1], y[2]), (y[3], y[4], y[5]), (y[6], y[7], y[8])
    elastic = nearest_turn(dihedral_angle(e, f, g) - p[0])
    moment = p[1] * elastic
    # theta = azimuth of the second face - azimuth of the first
    n, na, nl, nv, nf = azimuth_gradient(e, f)
    m, ma, ml, mv, mf = azimuth_gradient(e, g)
    de = combine(mv, m, -nv, n)
    df, dg = scale(-nf, n), scale(mf, m)
    nx, ny, nw, nz = azimuth_hessian(e, f, n, na, nl)
    mx, my, mw, mz = azimuth_hessian(e, g, m, ma, ml)
    k, t = p[1], moment
    ee = add_symmetric(
        scale_symmetric(k, self_outer(de)),
        add_symmetric(sym_outer(scale(t, m), mx), sym_outer(scale(-t, n), nx)),
    )
    ef = add_block(outer(scale(k, de), df), two_sided(n, scale(-t, ny), scale(-t, nw)))
    eg = add_block(outer(scale(k, de), dg), two_sided(m, scale(t, my), scale(t, mw)))
    ff = add_symmetric(scale_symmetric(k, self_outer(df)), sym_outer(n, scale(-t, nz)))
    gg = add_symmetric(scale_symmetric(k, self_outer(dg)), sym_outer(m, scale(t, mz)))
    fg = outer(scale(k, df), dg)
    gradient = (
        t * de[0], t * de[1], t * de[2],
        t * df[0], t * df[1], t * df[2],
        t * dg[0], t * dg[1], t * dg[2],
    )  # fmt: skip
    return 0.5 * moment * elastic, gradient, pack_three(ee, ef, eg, ff, fg, gg)


HINGE = Kernel(hinge, dimension=3, nodes=4, vectors=((0, 1), (0, 2), (0, 3)), naturals=1, parameters=2)


def hinge_angles(nodes: FloatArray, hinges: IntArray) -> FloatArray:
    """Dihedral angles [rad], shape (H,).

    Args:
        nodes: Positions [m], shape (N, 3).
        hinges: Node indices (x0, x1, x2, x3), shape (H, 4).
    """
    x0, x1, x2, x3 = (nodes[hinges[:, k]].T for k in range(4))
    angles: FloatArray = dihedral_angle(tuple(x1 - x0), tuple(x2 - x0), tuple(x3 - x0))
    return angles


def hinge_term(
    name: str, dofs: DofMap, nodes: FloatArray, hinges: IntArray, stiffness: FloatArray
) -> StencilEnergy:
    """Build the bending energy of the hinges of a shell, stress-free in the rest shape.

    Args:
        name: Unique name.
        dofs: Numbering.
        nodes: Rest positions [m], shape (N, 3).
        hinges: Node indices (x0, x1, x2, x3), shape (H, 4).
        stiffness: k [N m], shape (H,): see ``model.shell.hinge_stiffness``.

    Returns:
        Energy with one stencil per hinge; its natural strain (1, H) is the dihedral angle [rad].
    """
    count = len(hinges)
    return StencilEnergy(
        name,
        HINGE,
        dofs.of_nodes(hinges).reshape(count, -1),
        np.stack((hinge_angles(nodes, hinges), stiffness)),
        no_auxiliaries(count),
    )
