"""In-plane stretching of a triangle: linear finite element, St. Venant-Kirchhoff, plane stress.

Strain is the change of the metric: eps = ((a.a - A11)/2, (b.b - A22)/2, a.b - A12) of the edge
vectors a = x1 - x0, b = x2 - x0, and E = eps.C.eps / 2. A natural strain g grows the rest
triangle by 1 + g in every direction of its plane.

Parameters per stencil, after g [1]: rest metric A11, A22, A12 [m^2], and the upper triangle of C
by rows [N/m^3]: thickness, area and material in one.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..geometry.blocks import pack_two
from ..geometry.kernel import kernel
from ..geometry.vectors import combine, dot, outer, self_outer, sym_outer
from ..model.dofs import DofMap
from ..model.shell import plane_stress_stiffness, rest_metric
from ..model.stencil import Kernel, StencilEnergy, no_auxiliaries


@kernel
def membrane(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to the edge vectors (a, b)."""
    u, v = (y[0], y[1], y[2]), (y[3], y[4], y[5])
    growth = (1.0 + p[0]) * (1.0 + p[0])
    e0 = 0.5 * (dot(u, u) - growth * p[1])
    e1 = 0.5 * (dot(v, v) - growth * p[2])
    e2 = dot(u, v) - growth * p[3]
    # C has the units of area / length^4: it shrinks by (1 + g)^2 as the triangle grows
    w = 1.0 / growth
    c00, c01, c02, c11, c12, c22 = w * p[4], w * p[5], w * p[6], w * p[7], w * p[8], w * p[9]
    s0 = c00 * e0 + c01 * e1 + c02 * e2
    s1 = c01 * e0 + c11 * e1 + c12 * e2
    s2 = c02 * e0 + c12 * e1 + c22 * e2
    g, h = combine(s0, u, s2, v), combine(s1, v, s2, u)
    uu, vv, uv, sym = self_outer(u), self_outer(v), outer(u, v), sym_outer(u, v)
    first = (
        s0 + c00 * uu[0] + c02 * sym[0] + c22 * vv[0],
        c00 * uu[1] + c02 * sym[1] + c22 * vv[1],
        c00 * uu[2] + c02 * sym[2] + c22 * vv[2],
        s0 + c00 * uu[3] + c02 * sym[3] + c22 * vv[3],
        c00 * uu[4] + c02 * sym[4] + c22 * vv[4],
        s0 + c00 * uu[5] + c02 * sym[5] + c22 * vv[5],
    )
    second = (
        s1 + c11 * vv[0] + c12 * sym[0] + c22 * uu[0],
        c11 * vv[1] + c12 * sym[1] + c22 * uu[1],
        c11 * vv[2] + c12 * sym[2] + c22 * uu[2],
        s1 + c11 * vv[3] + c12 * sym[3] + c22 * uu[3],
        c11 * vv[4] + c12 * sym[4] + c22 * uu[4],
        s1 + c11 * vv[5] + c12 * sym[5] + c22 * uu[5],
    )
    mixed = (
        s2 + c01 * uv[0] + c02 * uu[0] + c12 * vv[0] + c22 * uv[0],
        c01 * uv[1] + c02 * uu[1] + c12 * vv[1] + c22 * uv[3],
        c01 * uv[2] + c02 * uu[2] + c12 * vv[2] + c22 * uv[6],
        c01 * uv[3] + c02 * uu[1] + c12 * vv[1] + c22 * uv[1],
        s2 + c01 * uv[4] + c02 * uu[3] + c12 * vv[3] + c22 * uv[4],
        c01 * uv[5] + c02 * uu[4] + c12 * vv[4] + c22 * uv[7],
        c01 * uv[6] + c02 * uu[2] + c12 * vv[2] + c22 * uv[2],
        c01 * uv[7] + c02 * uu[4] + c12 * vv[4] + c22 * uv[5],
        s2 + c01 * uv[8] + c02 * uu[5] + c12 * vv[5] + c22 * uv[8],
    )
    energy = 0.5 * (s0 * e0 + s1 * e1 + s2 * e2)
    return energy, (g[0], g[1], g[2], h[0], h[1], h[2]), pack_two(first, mixed, second)


MEMBRANE = Kernel(membrane, dimension=3, nodes=3, vectors=((0, 1), (0, 2)), naturals=1, parameters=10)


def membrane_term(
    name: str,
    dofs: DofMap,
    nodes: FloatArray,
    triangles: IntArray,
    *,
    youngs_modulus: float,
    poisson_ratio: float,
    thickness: float,
) -> StencilEnergy:
    """Build the membrane energy of a shell.

    Args:
        name: Unique name.
        dofs: Numbering.
        nodes: Rest positions [m], shape (N, 3).
        triangles: Shape (T, 3).
        youngs_modulus: E [Pa].
        poisson_ratio: nu [1].
        thickness: h [m].

    Returns:
        Energy with one stencil per triangle; its natural strain (1, T) is the growth g [1].
    """
    metric = rest_metric(nodes, triangles)
    stiffness = plane_stress_stiffness(metric, youngs_modulus, poisson_ratio, thickness)
    count = len(triangles)
    return StencilEnergy(
        name,
        MEMBRANE,
        dofs.of_nodes(triangles).reshape(count, -1),
        np.concatenate((np.zeros((1, count)), metric, stiffness)),
        no_auxiliaries(count),
    )
