"""Bending and twisting of a framed rod.

E = [EI1 (k1 - k1_0)^2 + EI2 (k2 - k2_0)^2] / (2 l_v) and GJ (m - m_0)^2 / (2 l_v).

The material curvatures k1 = kb.d2 and k2 = -kb.d1 and the material twist m = theta_f - theta_e + beta
are integrated over the Voronoi length; beta is the reference twist (Bergou et al. 2008, 2010). The
directors d of the joint lie half way between those of its edges: m of e turned by half of m - psi about
its tangent, which parallel transport takes to m of f turned by as much the other way. Bergou et al.
average the directors instead; that mean is shorter by the cosine of this half angle, so that twist
would soften bending. Here it does not, at any twist. psi is the rest twist of the joint: at a junction
of several edges no choice of directors is free of one. A sign of -1 means that the stencil walks its
edge backwards: then m1 stays, m2 and theta change sign.

Gradients follow Bergou et al. 2008 (eqs. 2, 7, 9 of its appendix) with d in place of m: where directors
are held, turning them with the twist changes no curvature, because d of e and d of f are one vector for
kb. The second derivatives are the symmetric ones, which are the exact Hessian of the energy at the
state where the reference frames are stored; turning adds a quarter of each curvature times the dyad of
the twist's gradient. Bending and twist are one kernel because they share the geometry of a stencil,
which costs more than either.

Parameters per stencil, after the natural k1_0, k2_0 [1] and m_0 [rad]: EI1, EI2, GJ [N m^2], Voronoi
length l_v [m], signs s_e, s_f, cos psi, sin psi [1], psi [rad]. Auxiliary inputs: m1, m2 of edge e, then
of f, then beta [rad].
"""

from __future__ import annotations

from typing import Any

from ..geometry.curvature import (
    curvature_gradients,
    curvature_slopes,
    edge_pair,
    joint_directors,
    pack_edges_and_angles,
)
from ..geometry.kernel import kernel
from ..geometry.vectors import (
    add,
    add_identity,
    combine,
    cross,
    plus_dyad,
    plus_outer,
    plus_sym_outer,
    scale,
    spin,
    sub,
    sym_outer,
)
from ..kernels.shape import Kernel


@kernel
def bend_twist(y: Any, a: Any, p: Any) -> Any:
    """Both energies, gradient and packed Hessian with respect to (e, f, theta_e, theta_f)."""
    se, sf = p[7], p[8]
    il, ir, te, tf, ic, kb, tt = edge_pair(y[0:3], y[3:6])
    twist = sf * y[7] - se * y[6] + a[12]
    m1e, m2e, m1f, m2f = joint_directors(
        a[0:3], scale(se, a[3:6]), a[6:9], scale(sf, a[9:12]), 0.5 * (twist - p[11]), p[9], p[10]
    )
    p1, p2, q1, q2 = cross(tf, m1e), cross(tf, m2e), cross(te, m1f), cross(te, m2f)
    # equal on both edges; their mean alone has the right slope where directors are held
    a1, a2 = curvature_slopes(scale(0.5, kb), add(m1e, m1f), add(m2e, m2f))
    k1, k2 = -2.0 * a2, 2.0 * a1
    e1, e2 = curvature_gradients(il, il * ic, tt, (k1, k2), sub(p2, m1f), add(p1, m2f))
    f1, f2 = curvature_gradients(ir, -ir * ic, tt, (k1, k2), sub(q2, m1e), add(q1, m2e))
    # stiffness and moment of each of the three strains
    s1, s2, s3 = p[3] / p[6], p[4] / p[6], p[5] / p[6]
    w1, w2, w3 = s1 * (k1 - p[0]), s2 * (k2 - p[1]), s3 * (twist - p[2])
    ge, gf = combine(w1, e1, w2, e2), combine(w1, f1, w2, f2)
    h = w1 * a1 + w2 * a2

    # Second derivatives of both curvatures at once: they are linear in directors and curvature. Those
    # of the twist, and its rank-one part, join them in the blocks that contain kb.
    wk = w1 * k1 + w2 * k2
    k, x = wk * ic, il * ir
    de, df = combine(w1, m2e, -w2, m1e), combine(w1, m2f, -w2, m1f)
    x1, x2, z1, z2 = scale(s1, e1), scale(s2, e2), scale(s1, f1), scale(s2, f2)
    s4 = s3 + 0.25 * wk
    stiff = scale(0.5 * s4, kb)
    ne = add(de, combine(-w3, add(te, tt), 1.0, stiff))
    nf = add(df, combine(-w3, add(tf, tt), 1.0, stiff))
    ee = add_identity(-k * il * il, sym_outer(scale(-il, tt), ge))
    ee = plus_sym_outer(ee, scale(0.25 * il * il, kb), ne)
    ee = plus_dyad(plus_dyad(plus_dyad(ee, x1, e1), x2, e2), scale(k * il * il, te), te)
    ff = add_identity(-k * ir * ir, sym_outer(scale(-ir, tt), gf))
    ff = plus_sym_outer(ff, scale(0.25 * ir * ir, kb), nf)
    ff = plus_dyad(plus_dyad(plus_dyad(ff, z1, f1), z2, f2), scale(k * ir * ir, tf), tf)
    ef = spin(-x * k, combine(x * ic * w3, te, -x * ic, add(de, df)))
    ef = plus_outer(plus_outer(ef, scale(-il, tt), gf), scale(-ir, ge), tt)
    ef = plus_outer(plus_outer(ef, x1, f1), x2, f2)
    ef = plus_outer(ef, scale(-x * k, te), tf)
    ef = plus_outer(ef, scale(0.5 * x, kb), combine(-w3, tt, 1.0, stiff))
    # e and f with theta_e, then with theta_f; tf x m2f = -m1f and its like spare cross products
    ate = combine(-h, tt, -ic, combine(w1, p1, w2, p2))
    bte = combine(-h, tt, ic, de)
    atf = combine(-h, tt, -ic, df)
    btf = combine(-h, tt, ic, combine(w1, q1, w2, q2))
    x3, z3 = combine(a1, x1, a2, x2), combine(a1, z1, a2, z2)
    bent = s1 * a1 * a1 + s2 * a2 * a2
    hessian = pack_edges_and_angles(
        ee,
        ff,
        ef,
        combine(se * il, sub(ate, stiff), se, x3),
        combine(sf * il, add(atf, stiff), sf, x3),
        combine(se * ir, sub(bte, stiff), se, z3),
        combine(sf * ir, add(btf, stiff), sf, z3),
        # a curvature falls by a half of itself over the square of either angle
        (bent + s4 - 0.5 * wk, se * sf * (bent - s4), bent + s4 - 0.5 * wk),
    )
    ge, gf = combine(1.0, ge, 0.5 * il * w3, kb), combine(1.0, gf, 0.5 * ir * w3, kb)
    return (
        (0.5 * (w1 * (k1 - p[0]) + w2 * (k2 - p[1])), 0.5 * w3 * (twist - p[2])),
        (ge[0], ge[1], ge[2], gf[0], gf[1], gf[2], se * (h - w3), sf * (h + w3)),
        hessian,
    )


BEND_TWIST = Kernel(
    bend_twist,
    dimension=3,
    nodes=3,
    vectors=((0, 1), (1, 2)),
    angles=2,
    auxiliaries=13,
    naturals=("kappa_1", "kappa_2", "twist"),
    constants=("EI_1", "EI_2", "GJ", "voronoi", "sign_e", "sign_f", "cos_psi", "sin_psi", "psi"),
    scales=(("EI_1",), ("EI_2",), ("GJ",)),
    shares=("bending", "twist"),
)
