"""Two edges of rods joined rigidly at any angle: E = (w - w_0)^T S (w - w_0) / 2.

Edge f carries a copy (g0, g1, g2) of the frame (t, m1, m2) that edge e has at rest; w is the rotation
vector 2 tan(phi/2) n from the frame of e to that copy, by components along the frame of e: twist, then
both curvatures, integrated. The stiffness S is that of half an edge of either rod in series, each with
its own axes, so that a kink of any angle is as stiff as the beams on its sides; only angles from rest
enter, and the one pole is a turn by pi from rest. Edges are walked through the joint: where one is
walked backwards (sign -1) m1 stays, m2 and theta change sign.

As in all energies of rods the second derivatives are those along paths on which the frames are
parallel-transported, which are exact where frames are stored (Bergou et al. 2010).

The energy of twist is that of the moment along either edge on its half, the rest is that of bending.

Parameters per stencil: the natural w_0 (3) [1]; the upper triangle of S by rows (6) [N m]; the cosines
R_ij between axis i of e and axis j of f at rest (9) [1]; the signs (2); the compliance of either half in
twist (2) [1/(N m)]. Auxiliary inputs: m1, m2 of edge e, then of f.
"""

from __future__ import annotations

from typing import Any

from ..geometry.blocks import add_block, outer_sum, symmetric_outer_sum
from ..geometry.curvature import pack_edges_and_angles
from ..geometry.frame_turn import transposed_turn, turn_from_rest
from ..geometry.kernel import kernel
from ..geometry.vectors import (
    Vector,
    add,
    combine,
    cross,
    dot,
    norm,
    plus_sym_outer,
    scale,
    spin,
)
from ..kernels.shape import Kernel

STIFFNESS = ("S_00", "S_01", "S_02", "S_11", "S_12", "S_22")
"""Names of the upper triangle of S, by rows."""

COSINES = tuple(f"R_{i}{j}" for i in range(3) for j in range(3))
"""Names of the cosines at rest, by rows."""


@kernel
def spin_slopes(a: Vector, d0: Vector, f0: Vector, il: Any, ir: Any, se: Any, sf: Any) -> Any:
    """Slopes, with respect to (e, f, theta_e, theta_f), of a . (spin of f - spin of e).

    An edge of length l spins by t x de / l + s dtheta t.
    """
    return scale(il, cross(d0, a)), scale(-ir, cross(f0, a)), -se * dot(d0, a), sf * dot(f0, a)


@kernel
def rigid_joint(y: Any, a: Any, p: Any) -> Any:
    """Both energies, gradient and packed Hessian with respect to (e, f, theta_e, theta_f)."""
    se, sf = p[18], p[19]
    il, ir = 1.0 / norm(y[0:3]), 1.0 / norm(y[3:6])
    d0, d1, d2 = scale(il, y[0:3]), a[0:3], scale(se, a[3:6])
    f0, f1, f2 = scale(ir, y[3:6]), a[6:9], scale(sf, a[9:12])
    w = turn_from_rest(d0, d1, d2, f0, f1, f2, p[9:18])
    u0, u1, u2 = dot(w, d0) - p[0], dot(w, d1) - p[1], dot(w, d2) - p[2]
    b0 = p[3] * u0 + p[4] * u1 + p[5] * u2
    b1 = p[4] * u0 + p[6] * u1 + p[7] * u2
    b2 = p[5] * u0 + p[7] * u1 + p[8] * u2
    # what each strain changes with the spin of f against e, then the moments that these changes meet
    t0, t1, t2 = transposed_turn(w, d0), transposed_turn(w, d1), transposed_turn(w, d2)
    s0 = combine(p[3], t0, 1.0, combine(p[4], t1, p[5], t2))
    s1 = combine(p[4], t0, 1.0, combine(p[6], t1, p[7], t2))
    s2 = combine(p[5], t0, 1.0, combine(p[7], t1, p[8], t2))
    # dE = m . (spin of f - spin of e)
    m = combine(b0, t0, 1.0, combine(b1, t1, b2, t2))
    me, mf, mte, mtf = spin_slopes(m, d0, f0, il, ir, se, sf)

    we, wf, wte, wtf = spin_slopes(scale(0.25, w), d0, f0, il, ir, se, sf)
    xe, xf, xte, xtf = spin_slopes(t0, d0, f0, il, ir, se, sf)
    ye, yf, yte, ytf = spin_slopes(t1, d0, f0, il, ir, se, sf)
    ze, zf, zte, ztf = spin_slopes(t2, d0, f0, il, ir, se, sf)
    pe, pf, pte, ptf = spin_slopes(s0, d0, f0, il, ir, se, sf)
    qe, qf, qte, qtf = spin_slopes(s1, d0, f0, il, ir, se, sf)
    re, rf, rte, rtf = spin_slopes(s2, d0, f0, il, ir, se, sf)
    # m . (change of the spins along a straight path, and of one edge's spin by the other's)
    md, mfo, df = dot(m, d0), dot(m, f0), dot(d0, f0)
    half_e, half_f = 0.5 * il, 0.5 * ir
    ee = symmetric_outer_sum((xe, ye, ze), (pe, qe, re))
    ee = plus_sym_outer(plus_sym_outer(ee, we, me), scale(-il * il, d0), cross(d0, m))
    ff = symmetric_outer_sum((xf, yf, zf), (pf, qf, rf))
    ff = plus_sym_outer(plus_sym_outer(ff, wf, mf), scale(ir * ir, f0), cross(f0, m))
    ef = add_block(outer_sum((xe, ye, ze), (pf, qf, rf)), spin(0.0, scale(half_e * ir * md, f0)))
    ef = add_block(ef, outer_sum((we, me, scale(-half_e * ir, m)), (mf, wf, cross(d0, f0))))
    hessian = pack_edges_and_angles(
        ee,
        ff,
        ef,
        add(
            combine(pte, xe, 1.0, combine(qte, ye, rte, ze)),
            add(combine(mte, we, wte, me), scale(-se * half_e, combine(1.0, m, -md, d0))),
        ),
        add(
            combine(ptf, xe, 1.0, combine(qtf, ye, rtf, ze)),
            add(combine(mtf, we, wtf, me), scale(sf * half_e, combine(md, f0, -df, m))),
        ),
        add(
            combine(pte, xf, 1.0, combine(qte, yf, rte, zf)),
            add(combine(mte, wf, wte, mf), scale(se * half_f, combine(df, m, -mfo, d0))),
        ),
        add(
            combine(ptf, xf, 1.0, combine(qtf, yf, rtf, zf)),
            add(combine(mtf, wf, wtf, mf), scale(sf * half_f, combine(1.0, m, -mfo, f0))),
        ),
        (
            xte * pte + yte * qte + zte * rte + 2.0 * wte * mte,
            xte * ptf + yte * qtf + zte * rtf + wte * mtf + mte * wtf + 0.5 * se * sf * dot(m, cross(f0, d0)),
            xtf * ptf + ytf * qtf + ztf * rtf + 2.0 * wtf * mtf,
        ),
    )
    along_f = p[9] * b0 + p[12] * b1 + p[15] * b2
    twist = 0.5 * (p[20] * b0 * b0 + p[21] * along_f * along_f)
    bending = 0.5 * (b0 * u0 + b1 * u1 + b2 * u2) - twist
    return (bending, twist), (me[0], me[1], me[2], mf[0], mf[1], mf[2], mte, mtf), hessian


RIGID_JOINT = Kernel(
    rigid_joint,
    dimension=3,
    nodes=3,
    vectors=((0, 1), (1, 2)),
    angles=2,
    auxiliaries=12,
    naturals=("w_0", "w_1", "w_2"),
    constants=(*STIFFNESS, *COSINES, "sign_e", "sign_f", "twist_e", "twist_f"),
    scales=(("S_00", "S_01", "S_02"), ("S_01", "S_11", "S_12"), ("S_02", "S_12", "S_22")),
    shares=("bending", "twist"),
)
