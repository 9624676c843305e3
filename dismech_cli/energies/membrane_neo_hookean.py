"""In-plane stretching of a triangle of rubber: incompressible, neo-Hookean, plane stress.

Per rest volume W = mu/2 (I - 3 + 1/J), I = tr C and J = det C of the plane Cauchy-Green tensor C: the
sheet thins to h / sqrt(J), so that its volume stays. With C = 1 + X, t = tr X and d = det X,

    I - 3 + 1/J = (t^2 + t d - d) / J,    J = 1 + t + d,

of second order in X and without differences of large numbers. A natural strain g grows the rest
triangle by 1 + g in every direction of its plane; its thickness stays. For small strains this is
:mod:`.membrane` with nu = 1/2 and E = 3 mu.

Parameters per stencil, after g [1]: rest metric A11, A22, A12 [m^2], and mu V [J], V the rest volume.
"""

from __future__ import annotations

from typing import Any

from ..arrays import FloatArray, IntArray, Numbers
from ..geometry.kernel import kernel
from ..geometry.vectors import dot
from ..kernels.shape import Kernel
from ..kinematics.dofs import DofMap
from ..kinematics.strains import rest_metric
from ..mesh.measure import triangle_areas
from ..model.stencil import StencilEnergy
from .metric import by_edges


@kernel
def membrane_neo_hookean(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to the edge vectors (a, b)."""
    u, v = y[0:3], y[3:6]
    growth = (1.0 + p[0]) * (1.0 + p[0])
    a11, a22, a12 = growth * p[1], growth * p[2], growth * p[3]
    square = a11 * a22 - a12 * a12
    e0 = 0.5 * (dot(u, u) - a11)
    e1 = 0.5 * (dot(v, v) - a22)
    e2 = dot(u, v) - a12
    # t and its slopes to the strains; d and its own, d = k (e0 e1 - e2^2 / 4)
    t0, t1, t2 = 2.0 * a22 / square, 2.0 * a11 / square, -2.0 * a12 / square
    k = 4.0 / square
    d0, d1, d2 = k * e1, k * e0, -0.5 * k * e2
    t = t0 * e0 + t1 * e1 + t2 * e2
    d = k * (e0 * e1 - 0.25 * e2 * e2)
    change = t + d
    by_j = 1.0 / (1.0 + change)
    half = 0.5 * growth * p[4]
    by_d = -half * by_j * by_j
    by_t = -by_d * change * (2.0 + change)
    w = -2.0 * by_d * by_j
    j0, j1, j2 = t0 + d0, t1 + d1, t2 + d2
    stress = (by_t * t0 + by_d * d0, by_t * t1 + by_d * d1, by_t * t2 + by_d * d2)
    slopes = (
        w * j0 * j0,
        w * j0 * j1 + by_d * k,
        w * j0 * j2,
        w * j1 * j1,
        w * j1 * j2,
        w * j2 * j2 - 0.5 * by_d * k,
    )
    gradient, hessian = by_edges(u, v, stress, slopes)
    return half * (t * t + t * d - d) * by_j, gradient, hessian


_METRIC = ("A11", "A22", "A12")
MEMBRANE_NEO_HOOKEAN = Kernel(
    membrane_neo_hookean,
    dimension=3,
    nodes=3,
    vectors=((0, 1), (0, 2)),
    naturals=("growth",),
    constants=(*_METRIC, "muV"),
    scales=(("muV",),),
)


def neo_hookean_term(
    name: str,
    dofs: DofMap,
    nodes: FloatArray,
    triangles: IntArray,
    *,
    shear_modulus: Numbers,
    thickness: Numbers,
) -> StencilEnergy:
    """Build the membrane energy of a shell of rubber.

    Args:
        name: Unique name.
        dofs: Numbering.
        nodes: Rest positions [m], shape (N, 3).
        triangles: Shape (T, 3).
        shear_modulus: mu = E / 3 [Pa].
        thickness: h at rest [m].

    Returns:
        Energy with one stencil per triangle; its natural strain (1, T) is the growth g [1].
    """
    return StencilEnergy.of(
        name,
        MEMBRANE_NEO_HOOKEAN,
        dofs.of_nodes(triangles).reshape(len(triangles), -1),
        {
            "growth": 0.0,
            **dict(zip(_METRIC, rest_metric(nodes, triangles), strict=True)),
            "muV": shear_modulus * thickness * triangle_areas(nodes, triangles),
        },
    )
