"""Twisting of a framed rod: E = GJ (tau - tau0)^2 / (2 l_v), tau = theta_f - theta_e + beta.

beta is the reference twist (Bergou et al. 2010); angles are signed by the direction in which the
stencil walks its edges. Parameters per stencil, after the natural twist tau0 [rad]: GJ [N m^2],
Voronoi length l_v [m], signs s_e, s_f [1]. Auxiliary input: beta [rad].
"""

from __future__ import annotations

from typing import Any

from ..geometry.curvature import edge_pair, twist_gradient, twist_hessian
from ..geometry.kernel import kernel
from ..geometry.vectors import scale
from ..model.stencil import Kernel


@kernel
def twist(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to (e, f, theta_e, theta_f)."""
    se, sf = p[3], p[4]
    stiffness = p[1] / p[2]
    elastic = sf * y[7] - se * y[6] + a[0] - p[0]
    torque = stiffness * elastic
    pair = edge_pair((y[0], y[1], y[2]), (y[3], y[4], y[5]))
    ge, gf = twist_gradient(pair)
    ee, ff, ef = twist_hessian(pair)
    u, v = scale(stiffness, ge), scale(stiffness, gf)
    gradient = (
        torque * ge[0], torque * ge[1], torque * ge[2],
        torque * gf[0], torque * gf[1], torque * gf[2],
        -se * torque, sf * torque,
    )  # fmt: skip
    constant = stiffness + 0.0 * torque
    hessian = (
        u[0] * ge[0] + torque * ee[0], u[0] * ge[1] + torque * ee[1], u[0] * ge[2] + torque * ee[2],
        u[0] * gf[0] + torque * ef[0], u[0] * gf[1] + torque * ef[1], u[0] * gf[2] + torque * ef[2],
        -se * u[0], sf * u[0],
        u[1] * ge[1] + torque * ee[3], u[1] * ge[2] + torque * ee[4],
        u[1] * gf[0] + torque * ef[3], u[1] * gf[1] + torque * ef[4], u[1] * gf[2] + torque * ef[5],
        -se * u[1], sf * u[1],
        u[2] * ge[2] + torque * ee[5],
        u[2] * gf[0] + torque * ef[6], u[2] * gf[1] + torque * ef[7], u[2] * gf[2] + torque * ef[8],
        -se * u[2], sf * u[2],
        v[0] * gf[0] + torque * ff[0], v[0] * gf[1] + torque * ff[1], v[0] * gf[2] + torque * ff[2],
        -se * v[0], sf * v[0],
        v[1] * gf[1] + torque * ff[3], v[1] * gf[2] + torque * ff[4],
        -se * v[1], sf * v[1],
        v[2] * gf[2] + torque * ff[5],
        -se * v[2], sf * v[2],
        constant, -se * sf * constant,
        constant,
    )  # fmt: skip
    return 0.5 * torque * elastic, gradient, hessian


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
