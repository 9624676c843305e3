"""Bending of a straight rod with equal stiffness in all directions: E = EI |kappa b|^2 / (2 l_v).

With c = t_e . t_f the curvature binormal (Bergou et al. 2008, eq. 1) has |kappa b|^2 =
4 (1 - c)/(1 + c), so no frame and no angle is needed.
Parameters per stencil: EI [N m^2], Voronoi length l_v [m].
"""

from __future__ import annotations

from typing import Any

from ..geometry.blocks import pack_two
from ..geometry.kernel import kernel
from ..geometry.vectors import (
    add_identity,
    combine,
    combine_block,
    combine_symmetric,
    dot,
    expand,
    norm,
    outer,
    scale,
    self_outer,
    sub,
    sym_outer,
)
from ..kernels.shape import Kernel


@kernel
def bend_isotropic(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to the edge vectors (e, f)."""
    e, f = y[0:3], y[3:6]
    le, lf = norm(e), norm(f)
    te, tf = scale(1.0 / le, e), scale(1.0 / lf, f)
    c = dot(te, tf)
    chi = 1.0 + c
    stiffness = 2.0 * p[0] / p[1]
    # 1 - c from the chord: no cancellation when the rod is almost straight
    chord = sub(tf, te)
    energy = stiffness * 0.5 * dot(chord, chord) / chi
    d1 = -2.0 * stiffness / (chi * chi)  # dE/dc
    d2 = -2.0 * d1 / chi  # d2E/dc2
    ce, cf = combine(1.0 / le, tf, -c / le, te), combine(1.0 / lf, te, -c / lf, tf)
    ge, gf = scale(d1, ce), scale(d1, cf)
    we, wf, wx = d1 / (le * le), d1 / (lf * lf), d1 / (le * lf)
    s, tee, tff = sym_outer(te, tf), self_outer(te), self_outer(tf)
    # second derivatives of c: ee = [3 c te te^T - S(te, tf) - c I] / le^2,
    # ef = [I - te te^T - tf tf^T + c te tf^T] / (le lf)
    ee = combine_symmetric(3.0 * c * we, tee, -we, s)
    ff = combine_symmetric(3.0 * c * wf, tff, -wf, s)
    ef = expand(add_identity(wx, combine_symmetric(-wx, tee, -wx, tff)))
    ef = combine_block(1.0, ef, c * wx, outer(te, tf))
    hessian = pack_two(
        add_identity(-c * we, combine_symmetric(1.0, ee, d2, self_outer(ce))),
        combine_block(1.0, ef, d2, outer(ce, cf)),
        add_identity(-c * wf, combine_symmetric(1.0, ff, d2, self_outer(cf))),
    )
    return energy, (ge[0], ge[1], ge[2], gf[0], gf[1], gf[2]), hessian


BEND_ISOTROPIC = Kernel(
    bend_isotropic, dimension=3, nodes=3, vectors=((0, 1), (1, 2)), constants=("EI", "voronoi")
)
