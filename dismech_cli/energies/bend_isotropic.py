"""Bending of a straight rod with equal stiffness in all directions: E = EI |kappa b|^2 / (2 l_v).

With c = t_e . t_f the curvature binormal (Bergou et al. 2008, eq. 1) has |kappa b|^2 =
4 (1 - c)/(1 + c), so no frame and no angle is needed.
Parameters per stencil: EI [N m^2], Voronoi length l_v [m].
"""

from __future__ import annotations

from typing import Any

from ..geometry.kernel import kernel
from ..geometry.vectors import combine, dot, norm, outer, scale, self_outer, sub, sym_outer
from ..model.stencil import Kernel


@kernel
def bend_isotropic(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to the edge vectors (e, f)."""
    e, f = (y[0], y[1], y[2]), (y[3], y[4], y[5])
    le, lf = norm(e), norm(f)
    te, tf = scale(1.0 / le, e), scale(1.0 / lf, f)
    c = dot(te, tf)
    chi = 1.0 + c
    stiffness = 2.0 * p[0] / p[1]
    # 1 - c from the chord: no cancellation when the rod is almost straight
    chord = sub(tf, te)
    energy = stiffness * 0.5 * dot(chord, chord) / chi
    d1 = -2.0 * stiffness / (chi * chi)
    d2 = -2.0 * d1 / chi
    ce = scale(1.0 / le, combine(1.0, tf, -c, te))
    cf = scale(1.0 / lf, combine(1.0, te, -c, tf))
    ge, gf = scale(d1, ce), scale(d1, cf)

    we, wf, wx = d1 / (le * le), d1 / (lf * lf), d1 / (le * lf)
    s, tee, tff = sym_outer(te, tf), self_outer(te), self_outer(tf)
    cee, cff, cef = self_outer(ce), self_outer(cf), outer(ce, cf)
    ee = (
        d2 * cee[0] + we * (3.0 * c * tee[0] - s[0] - c),
        d2 * cee[1] + we * (3.0 * c * tee[1] - s[1]),
        d2 * cee[2] + we * (3.0 * c * tee[2] - s[2]),
        d2 * cee[3] + we * (3.0 * c * tee[3] - s[3] - c),
        d2 * cee[4] + we * (3.0 * c * tee[4] - s[4]),
        d2 * cee[5] + we * (3.0 * c * tee[5] - s[5] - c),
    )
    ff = (
        d2 * cff[0] + wf * (3.0 * c * tff[0] - s[0] - c),
        d2 * cff[1] + wf * (3.0 * c * tff[1] - s[1]),
        d2 * cff[2] + wf * (3.0 * c * tff[2] - s[2]),
        d2 * cff[3] + wf * (3.0 * c * tff[3] - s[3] - c),
        d2 * cff[4] + wf * (3.0 * c * tff[4] - s[4]),
        d2 * cff[5] + wf * (3.0 * c * tff[5] - s[5] - c),
    )
    x = outer(te, tf)
    ef = (
        d2 * cef[0] + wx * (1.0 - tee[0] - tff[0] + c * x[0]),
        d2 * cef[1] + wx * (c * x[1] - tee[1] - tff[1]),
        d2 * cef[2] + wx * (c * x[2] - tee[2] - tff[2]),
        d2 * cef[3] + wx * (c * x[3] - tee[1] - tff[1]),
        d2 * cef[4] + wx * (1.0 - tee[3] - tff[3] + c * x[4]),
        d2 * cef[5] + wx * (c * x[5] - tee[4] - tff[4]),
        d2 * cef[6] + wx * (c * x[6] - tee[2] - tff[2]),
        d2 * cef[7] + wx * (c * x[7] - tee[4] - tff[4]),
        d2 * cef[8] + wx * (1.0 - tee[5] - tff[5] + c * x[8]),
    )
    hessian = (
        ee[0], ee[1], ee[2], ef[0], ef[1], ef[2],
        ee[3], ee[4], ef[3], ef[4], ef[5],
        ee[5], ef[6], ef[7], ef[8],
        ff[0], ff[1], ff[2], ff[3], ff[4], ff[5],
    )  # fmt: skip
    return energy, (ge[0], ge[1], ge[2], gf[0], gf[1], gf[2]), hessian


BEND_ISOTROPIC = Kernel(
    bend_isotropic, dimension=3, nodes=3, vectors=((0, 1), (1, 2)), naturals=0, parameters=2
)
