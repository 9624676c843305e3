"""In-plane stretching of a triangle: linear finite element, St. Venant-Kirchhoff, plane stress.

Strain is the change of the metric: eps = ((a.a - A11)/2, (b.b - A22)/2, a.b - A12) of the edge
vectors a = x1 - x0, b = x2 - x0, and E = eps.C.eps / 2. A natural strain g grows the rest
triangle by 1 + g in every direction of its plane.

Parameters per stencil, after g [1]: rest metric A11, A22, A12 [m^2], and the upper triangle of C
by rows [N/m^3]: thickness, area and material in one.
"""

from __future__ import annotations

from typing import Any

from ..arrays import FloatArray, IntArray, Numbers
from ..geometry.kernel import kernel
from ..geometry.vectors import dot
from ..kernels.shape import Kernel
from ..kinematics.dofs import DofMap
from ..kinematics.strains import rest_metric
from ..model.stencil import StencilEnergy
from ..sections.shells import plane_stress_stiffness
from .metric import by_edges


@kernel
def membrane(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to the edge vectors (a, b)."""
    u, v = y[0:3], y[3:6]
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
    energy = 0.5 * (s0 * e0 + s1 * e1 + s2 * e2)
    gradient, hessian = by_edges(u, v, (s0, s1, s2), (c00, c01, c02, c11, c12, c22))
    return energy, gradient, hessian


_METRIC = ("A11", "A22", "A12")
_STIFFNESS = ("C11", "C12", "C13", "C22", "C23", "C33")
MEMBRANE = Kernel(
    membrane,
    dimension=3,
    nodes=3,
    vectors=((0, 1), (0, 2)),
    naturals=("growth",),
    constants=_METRIC + _STIFFNESS,
    scales=(_STIFFNESS,),
)


def membrane_term(
    name: str,
    dofs: DofMap,
    nodes: FloatArray,
    triangles: IntArray,
    *,
    youngs_modulus: Numbers,
    poisson_ratio: float,
    thickness: Numbers,
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
    return StencilEnergy.of(
        name,
        MEMBRANE,
        dofs.of_nodes(triangles).reshape(len(triangles), -1),
        {
            "growth": 0.0,
            **dict(zip(_METRIC, metric, strict=True)),
            **dict(zip(_STIFFNESS, stiffness, strict=True)),
        },
    )
