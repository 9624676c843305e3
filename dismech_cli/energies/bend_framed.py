"""Bending of a framed rod: E = [EI1 (k1 - k1_0)^2 + EI2 (k2 - k2_0)^2] / (2 l_v).

The material curvatures k1 = kb.(m2e + m2f)/2 and k2 = -kb.(m1e + m1f)/2 are integrated over the
Voronoi length (Bergou et al. 2008, 2010). A sign of -1 means that the stencil walks its edge
backwards: then m1 stays, m2 and theta change sign.

Parameters per stencil, after the natural curvatures k1_0, k2_0 [1]: EI1, EI2 [N m^2], Voronoi
length l_v [m], signs s_e, s_f [1]. Auxiliary inputs: m1 and m2 of edge e, m1 and m2 of edge f.
"""

from __future__ import annotations

from typing import Any

from ..geometry.curvature import curvature_gradient, curvature_hessian, edge_pair
from ..geometry.kernel import kernel
from ..geometry.vectors import combine, scale
from ..model.stencil import Kernel


@kernel
def bend_framed(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to (e, f, theta_e, theta_f)."""
    se, sf = p[5], p[6]
    m1e, m2e = (a[0], a[1], a[2]), scale(se, (a[3], a[4], a[5]))
    m1f, m2f = (a[6], a[7], a[8]), scale(sf, (a[9], a[10], a[11]))
    pair = edge_pair((y[0], y[1], y[2]), (y[3], y[4], y[5]))
    k1, g = curvature_gradient(pair, m2e, m2f, scale(-1.0, m1e), scale(-1.0, m1f))
    k2, h = curvature_gradient(pair, scale(-1.0, m1e), scale(-1.0, m1f), scale(-1.0, m2e), scale(-1.0, m2f))
    s1, s2 = p[2] / p[4], p[3] / p[4]
    w1, w2 = s1 * (k1 - p[0]), s2 * (k2 - p[1])
    energy = 0.5 * (w1 * (k1 - p[0]) + w2 * (k2 - p[1]))
    # one call for both curvatures: the Hessian is linear in directors and curvature
    c = curvature_hessian(
        pair,
        w1 * k1 + w2 * k2,
        combine(w1, m2e, -w2, m1e),
        combine(w1, m2f, -w2, m1f),
        combine(-w1, m1e, -w2, m2e),
        combine(-w1, m1f, -w2, m2f),
    )
    gradient = (
        w1 * g[0] + w2 * h[0], w1 * g[1] + w2 * h[1], w1 * g[2] + w2 * h[2],
        w1 * g[3] + w2 * h[3], w1 * g[4] + w2 * h[4], w1 * g[5] + w2 * h[5],
        se * (w1 * g[6] + w2 * h[6]), sf * (w1 * g[7] + w2 * h[7]),
    )  # fmt: skip
    a0, a1, a2, a3 = s1 * g[0], s1 * g[1], s1 * g[2], s1 * g[3]
    a4, a5, a6, a7 = s1 * g[4], s1 * g[5], s1 * g[6], s1 * g[7]
    b0, b1, b2, b3 = s2 * h[0], s2 * h[1], s2 * h[2], s2 * h[3]
    b4, b5, b6, b7 = s2 * h[4], s2 * h[5], s2 * h[6], s2 * h[7]
    hessian = (
        a0 * g[0] + b0 * h[0] + c[0], a0 * g[1] + b0 * h[1] + c[1], a0 * g[2] + b0 * h[2] + c[2],
        a0 * g[3] + b0 * h[3] + c[3], a0 * g[4] + b0 * h[4] + c[4], a0 * g[5] + b0 * h[5] + c[5],
        se * (a0 * g[6] + b0 * h[6] + c[6]), sf * (a0 * g[7] + b0 * h[7] + c[7]),
        a1 * g[1] + b1 * h[1] + c[8], a1 * g[2] + b1 * h[2] + c[9], a1 * g[3] + b1 * h[3] + c[10],
        a1 * g[4] + b1 * h[4] + c[11], a1 * g[5] + b1 * h[5] + c[12],
        se * (a1 * g[6] + b1 * h[6] + c[13]), sf * (a1 * g[7] + b1 * h[7] + c[14]),
        a2 * g[2] + b2 * h[2] + c[15], a2 * g[3] + b2 * h[3] + c[16], a2 * g[4] + b2 * h[4] + c[17],
        a2 * g[5] + b2 * h[5] + c[18], se * (a2 * g[6] + b2 * h[6] + c[19]),
        sf * (a2 * g[7] + b2 * h[7] + c[20]),
        a3 * g[3] + b3 * h[3] + c[21], a3 * g[4] + b3 * h[4] + c[22], a3 * g[5] + b3 * h[5] + c[23],
        se * (a3 * g[6] + b3 * h[6] + c[24]), sf * (a3 * g[7] + b3 * h[7] + c[25]),
        a4 * g[4] + b4 * h[4] + c[26], a4 * g[5] + b4 * h[5] + c[27],
        se * (a4 * g[6] + b4 * h[6] + c[28]), sf * (a4 * g[7] + b4 * h[7] + c[29]),
        a5 * g[5] + b5 * h[5] + c[30],
        se * (a5 * g[6] + b5 * h[6] + c[31]), sf * (a5 * g[7] + b5 * h[7] + c[32]),
        a6 * g[6] + b6 * h[6] + c[33], se * sf * (a6 * g[7] + b6 * h[7]),
        a7 * g[7] + b7 * h[7] + c[35],
    )  # fmt: skip
    return energy, gradient, hessian


BEND_FRAMED = Kernel(
    bend_framed,
    dimension=3,
    nodes=3,
    vectors=((0, 1), (1, 2)),
    angles=2,
    auxiliaries=12,
    naturals=2,
    parameters=7,
)
