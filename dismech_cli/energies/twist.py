"""Twisting of a framed rod: E = GJ (tau - tau0)^2 / (2 l_v), tau = theta_f - theta_e + beta.

beta is the reference twist (Bergou et al. 2010); angles are signed by the direction in which the
stencil walks its edges. Parameters per stencil, after the natural twist tau0 [rad]: GJ [N m^2],
Voronoi length l_v [m], signs s_e, s_f [1]. Auxiliary input: beta [rad].
"""

from __future__ import annotations

from typing import Any

from ..geometry.curvature import edge_pair, pack_edges_and_angles, twist_gradient, twist_hessian
from ..geometry.kernel import kernel
from ..geometry.vectors import combine_block, combine_symmetric, outer, scale, self_outer
from ..model.stencil import Kernel


@kernel
def twist(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to (e, f, theta_e, theta_f)."""
    se, sf = p[3], p[4]
    stiffness = p[1] / p[2]
    elastic = sf * y[7] - se * y[6] + a[0] - p[0]
    torque = stiffness * elastic
    pair = edge_pair(y[0:3], y[3:6])
    ge, gf = twist_gradient(pair)
    ee, ff, ef = twist_hessian(pair)
    u, v = scale(stiffness, ge), scale(stiffness, gf)
    hessian = pack_edges_and_angles(
        combine_symmetric(torque, ee, stiffness, self_outer(ge)),
        combine_symmetric(torque, ff, stiffness, self_outer(gf)),
        combine_block(torque, ef, 1.0, outer(u, gf)),
        scale(-se, u),
        scale(sf, u),
        scale(-se, v),
        scale(sf, v),
        (stiffness, -se * sf * stiffness, stiffness),
    )
    he, hf = scale(torque, ge), scale(torque, gf)
    return (
        0.5 * torque * elastic,
        (he[0], he[1], he[2], hf[0], hf[1], hf[2], -se * torque, sf * torque),
        hessian,
    )


TWIST = Kernel(
    twist,
    dimension=3,
    nodes=3,
    vectors=((0, 1), (1, 2)),
    angles=2,
    auxiliaries=1,
    naturals=1,
    parameters=5,
)
