"""Bending of a framed rod: E = [EI1 (k1 - k1_0)^2 + EI2 (k2 - k2_0)^2] / (2 l_v).

The material curvatures k1 = kb.(m2e + m2f)/2 and k2 = -kb.(m1e + m1f)/2 are integrated over the
Voronoi length (Bergou et al. 2008, 2010). A sign of -1 means that the stencil walks its edge
backwards: then m1 stays, m2 and theta change sign. The directors of edge f are turned back by the
rest twist psi of the joint before they are averaged with those of e: at a junction of several edges no
choice of directors is free of such a twist, and averaging across it would soften the joint.

Parameters per stencil, after the natural curvatures k1_0, k2_0 [1]: EI1, EI2 [N m^2], Voronoi
length l_v [m], signs s_e, s_f, cos psi, sin psi [1]. Auxiliary inputs: m1, m2 of edge e, then of f.
"""

from __future__ import annotations

from typing import Any

from ..geometry.curvature import curvature_gradient, curvature_hessian, edge_pair, pack_edges_and_angles
from ..geometry.kernel import kernel
from ..geometry.vectors import (
    add,
    combine,
    combine_block,
    combine_symmetric,
    outer,
    scale,
    self_outer,
)
from ..model.stencil import Kernel


@kernel
def bend_framed(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to (e, f, theta_e, theta_f)."""
    se, sf = p[5], p[6]
    m1e, m2e = a[0:3], scale(se, a[3:6])
    # the directors of f, turned to stand as those of e do in the rest shape
    r1f, r2f = a[6:9], scale(sf, a[9:12])
    m1f, m2f = combine(p[7], r1f, -p[8], r2f), combine(p[8], r1f, p[7], r2f)
    n1e, n2e, n1f, n2f = scale(-1.0, m1e), scale(-1.0, m2e), scale(-1.0, m1f), scale(-1.0, m2f)
    pair = edge_pair(y[0:3], y[3:6])
    k1, e1, f1, a1, b1 = curvature_gradient(pair, m2e, m2f, n1e, n1f)
    k2, e2, f2, a2, b2 = curvature_gradient(pair, n1e, n1f, n2e, n2f)
    s1, s2 = p[2] / p[4], p[3] / p[4]
    w1, w2 = s1 * (k1 - p[0]), s2 * (k2 - p[1])
    energy = 0.5 * (w1 * (k1 - p[0]) + w2 * (k2 - p[1]))
    # one call for both curvatures: second derivatives are linear in directors and curvature
    ee, ff, ef, ate, atf, bte, btf, tee, tff = curvature_hessian(
        pair,
        w1 * k1 + w2 * k2,
        combine(w1, m2e, w2, n1e),
        combine(w1, m2f, w2, n1f),
        combine(w1, n1e, w2, n2e),
        combine(w1, n1f, w2, n2f),
    )
    # the rank-one parts s x x^T from vectors scaled by the root of the stiffness
    h1, h2 = s1**0.5, s2**0.5
    x1, x2, z1, z2 = scale(h1, e1), scale(h2, e2), scale(h1, f1), scale(h2, f2)
    c1, c2, d1, d2 = h1 * a1, h2 * a2, h1 * b1, h2 * b2
    hessian = pack_edges_and_angles(
        combine_symmetric(1.0, ee, 1.0, combine_symmetric(1.0, self_outer(x1), 1.0, self_outer(x2))),
        combine_symmetric(1.0, ff, 1.0, combine_symmetric(1.0, self_outer(z1), 1.0, self_outer(z2))),
        combine_block(1.0, ef, 1.0, combine_block(1.0, outer(x1, z1), 1.0, outer(x2, z2))),
        scale(se, add(ate, combine(c1, x1, c2, x2))),
        scale(sf, add(atf, combine(d1, x1, d2, x2))),
        scale(se, add(bte, combine(c1, z1, c2, z2))),
        scale(sf, add(btf, combine(d1, z1, d2, z2))),
        (
            tee + c1 * c1 + c2 * c2,
            se * sf * (c1 * d1 + c2 * d2),
            tff + d1 * d1 + d2 * d2,
        ),
    )
    ge, gf = combine(w1, e1, w2, e2), combine(w1, f1, w2, f2)
    angles = (se * (w1 * a1 + w2 * a2), sf * (w1 * b1 + w2 * b2))
    return energy, (ge[0], ge[1], ge[2], gf[0], gf[1], gf[2], angles[0], angles[1]), hessian


BEND_FRAMED = Kernel(
    bend_framed,
    dimension=3,
    nodes=3,
    vectors=((0, 1), (1, 2)),
    angles=2,
    auxiliaries=12,
    naturals=2,
    parameters=9,
)
