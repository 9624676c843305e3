"""Bending of a shell at its hinges: E = k (theta - theta_0)^2 / 2, theta the dihedral angle.

Stencil (x0, x1, x2, x3): x0 -> x1 is the shared edge, x2 the corner opposite in the first face, x3
in the second (Grinspun et al. 2003). Constant k is a plate on nets of equilateral triangles only.
Parameters per stencil, after the natural angle theta_0 [rad]: k [N m].
"""

from __future__ import annotations

from typing import Any

from ..arrays import FloatArray, IntArray
from ..geometry.blocks import add_symmetric, pack_three, two_sided
from ..geometry.kernel import kernel
from ..geometry.triangle import azimuth_gradient, azimuth_hessian, dihedral_angle, fold, nearest_turn
from ..geometry.vectors import Vector, combine, outer, scale, sym_outer
from ..kernels.shape import Kernel
from ..kinematics.dofs import DofMap
from ..model.stencil import StencilEnergy


@kernel
def by_angle(e: Vector, f: Vector, g: Vector, first: Any, second: Any, t: Any, k: Any) -> Any:
    """Gradient and packed Hessian of an energy of the angle, of slope t and curvature k.

    Args:
        e: The edge.
        f: To the corner of the first face; ``g`` to that of the second.
        g: See ``f``.
        first: Of the first face, from :func:`azimuth_gradient`; ``second`` likewise.
        second: See ``first``.
        t: Derivative to the angle.
        k: Second derivative to it.
    """
    n, ns, nc, r = first
    m, ms, mc, _ = second
    # theta = azimuth of the second face - azimuth of the first: d theta = de.de + ms m.dg - ns n.df
    de = combine(nc * ns, n, -mc * ms, m)
    nx, ny, nw, nz = azimuth_hessian(e, f, ns, nc, r, -t)
    mx, my, mw, mz = azimuth_hessian(e, g, ms, mc, r, t)
    # All slopes are along n and m: the rank-one part k (d theta)^2 joins the vectors beside them.
    kn, km = k * ns, k * ms
    nx, mx = combine(1.0, nx, 0.5 * nc * kn, de), combine(1.0, mx, -0.5 * mc * km, de)
    nz, mz = combine(1.0, nz, 0.5 * ns * kn, n), combine(1.0, mz, 0.5 * ms * km, m)
    hessian = pack_three(
        add_symmetric(sym_outer(n, nx), sym_outer(m, mx)),
        two_sided(n, ny, combine(1.0, nw, -kn, de)),
        two_sided(m, my, combine(1.0, mw, km, de)),
        sym_outer(n, nz),
        outer(scale(-ns * km, n), m),
        sym_outer(m, mz),
    )
    ge, gf, gg = scale(t, de), scale(-t * ns, n), scale(t * ms, m)
    return (ge[0], ge[1], ge[2], gf[0], gf[1], gf[2], gg[0], gg[1], gg[2]), hessian


@kernel
def hinge(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to (x1 - x0, x2 - x0, x3 - x0)."""
    e, f, g = y[0:3], y[3:6], y[6:9]
    first, second = azimuth_gradient(e, f), azimuth_gradient(e, g)
    k = p[1]
    elastic = nearest_turn(fold(first[0], second[0], g, second[1]) - p[0])
    t = k * elastic
    gradient, hessian = by_angle(e, f, g, first, second, t, k)
    return 0.5 * t * elastic, gradient, hessian


HINGE = Kernel(
    hinge,
    dimension=3,
    nodes=4,
    vectors=((0, 1), (0, 2), (0, 3)),
    naturals=("theta",),
    constants=("k",),
    scales=(("k",),),
)


def hinge_angles(nodes: FloatArray, hinges: IntArray) -> FloatArray:
    """Dihedral angles [rad], shape (H,).

    Args:
        nodes: Positions [m], shape (N, 3).
        hinges: Node indices (x0, x1, x2, x3), shape (H, 4).
    """
    x0, x1, x2, x3 = (nodes[hinges[:, k]].T for k in range(4))
    angles: FloatArray = dihedral_angle(x1 - x0, x2 - x0, x3 - x0)
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
        stiffness: k [N m], shape (H,): see ``sections.shells.hinge_stiffness``.

    Returns:
        Energy with one stencil per hinge; its natural strain (1, H) is the dihedral angle [rad].
    """
    return StencilEnergy.of(
        name,
        HINGE,
        dofs.of_nodes(hinges).reshape(len(hinges), -1),
        {"theta": hinge_angles(nodes, hinges), "k": stiffness},
    )
