"""Material curvature and material twist of two consecutive edges, with derivatives.

Both strains depend on the edge vectors e, f and the angles theta_e, theta_f of the material
directors. Gradients follow Bergou et al. 2008 (eqs. 2, 7, 9 of its appendix) and Bergou et al.
2010; the second derivatives are the symmetric ones, which are the exact Hessian of the energy at
the state where the reference frames are stored.
"""

from __future__ import annotations

from typing import Any

from .kernel import kernel
from .vectors import Vector, add, combine, cross, dot, norm, scale, self_outer, sym_outer


@kernel
def edge_pair(e: Vector, f: Vector) -> Any:
    """Shared geometry: |e|, |f|, unit tangents, chi = 1 + t_e.t_f, kappa b, tilted tangent.

    Returns:
        ``(le, lf, te, tf, chi, kb, tt)`` with kb = 2 te x tf / chi and tt = (te + tf)/chi.
    """
    le, lf = norm(e), norm(f)
    te, tf = scale(1.0 / le, e), scale(1.0 / lf, f)
    chi = 1.0 + dot(te, tf)
    kb = scale(2.0 / chi, cross(te, tf))
    tt = scale(1.0 / chi, add(te, tf))
    return le, lf, te, tf, chi, kb, tt


@kernel
def curvature_gradient(pair: Any, de: Vector, df: Vector, ce: Vector, cf: Vector) -> Any:
    """Curvature kappa = kb.(de + df)/2 and its gradient.

    Args:
        pair: Result of :func:`edge_pair`.
        de: Director of edge e that pairs with this curvature; ``df`` that of edge f.
        df: See ``de``.
        ce: Derivative of ``de`` with respect to theta_e; ``cf`` that of ``df`` to theta_f.
        cf: See ``ce``.

    Returns:
        kappa [1] and its derivatives to e (3), f (3) [1/m], theta_e, theta_f [1].
    """
    le, lf, te, tf, chi, kb, tt = pair
    d = scale(1.0 / chi, add(de, df))
    kappa = 0.5 * chi * dot(kb, d)
    ge = scale(1.0 / le, combine(-kappa, tt, 1.0, cross(tf, d)))
    gf = scale(-1.0 / lf, combine(kappa, tt, 1.0, cross(te, d)))
    return kappa, (ge[0], ge[1], ge[2], gf[0], gf[1], gf[2], 0.5 * dot(kb, ce), 0.5 * dot(kb, cf))


@kernel
def curvature_hessian(pair: Any, kappa: Any, de: Vector, df: Vector, ce: Vector, cf: Vector) -> Any:
    """Packed 8x8 Hessian of the curvature with respect to (e, f, theta_e, theta_f).

    It is linear in the directors and in ``kappa``, so weighted sums of both material curvatures
    are differentiated in one call.
    """
    le, lf, te, tf, chi, kb, tt = pair
    d = scale(1.0 / chi, add(de, df))
    u, w = cross(tf, d), cross(te, d)
    k = kappa / chi
    k2 = 2.0 * kappa
    a, b, x = 1.0 / (le * le), 1.0 / (lf * lf), 1.0 / (le * lf)
    t2 = self_outer(tt)
    s, q, m = sym_outer(u, tt), sym_outer(kb, de), self_outer(te)
    ee0 = a * (k2 * t2[0] - s[0] - k + k * m[0] + 0.25 * q[0])
    ee1 = a * (k2 * t2[1] - s[1] + k * m[1] + 0.25 * q[1])
    ee2 = a * (k2 * t2[2] - s[2] + k * m[2] + 0.25 * q[2])
    ee3 = a * (k2 * t2[3] - s[3] - k + k * m[3] + 0.25 * q[3])
    ee4 = a * (k2 * t2[4] - s[4] + k * m[4] + 0.25 * q[4])
    ee5 = a * (k2 * t2[5] - s[5] - k + k * m[5] + 0.25 * q[5])
    r, z, n = sym_outer(w, tt), sym_outer(kb, df), self_outer(tf)
    ff0 = b * (k2 * t2[0] + r[0] - k + k * n[0] + 0.25 * z[0])
    ff1 = b * (k2 * t2[1] + r[1] + k * n[1] + 0.25 * z[1])
    ff2 = b * (k2 * t2[2] + r[2] + k * n[2] + 0.25 * z[2])
    ff3 = b * (k2 * t2[3] + r[3] - k + k * n[3] + 0.25 * z[3])
    ff4 = b * (k2 * t2[4] + r[4] + k * n[4] + 0.25 * z[4])
    ff5 = b * (k2 * t2[5] + r[5] - k + k * n[5] + 0.25 * z[5])
    # row = component of e, column = component of f
    ef0 = x * (-k - k * te[0] * tf[0] + k2 * t2[0] - u[0] * tt[0] + tt[0] * w[0])
    ef1 = x * (-k * te[0] * tf[1] + k2 * t2[1] - u[0] * tt[1] + tt[0] * w[1] + d[2])
    ef2 = x * (-k * te[0] * tf[2] + k2 * t2[2] - u[0] * tt[2] + tt[0] * w[2] - d[1])
    ef3 = x * (-k * te[1] * tf[0] + k2 * t2[1] - u[1] * tt[0] + tt[1] * w[0] - d[2])
    ef4 = x * (-k - k * te[1] * tf[1] + k2 * t2[3] - u[1] * tt[1] + tt[1] * w[1])
    ef5 = x * (-k * te[1] * tf[2] + k2 * t2[4] - u[1] * tt[2] + tt[1] * w[2] + d[0])
    ef6 = x * (-k * te[2] * tf[0] + k2 * t2[2] - u[2] * tt[0] + tt[2] * w[0] + d[1])
    ef7 = x * (-k * te[2] * tf[1] + k2 * t2[4] - u[2] * tt[1] + tt[2] * w[1] - d[0])
    ef8 = x * (-k - k * te[2] * tf[2] + k2 * t2[5] - u[2] * tt[2] + tt[2] * w[2])
    he, hf = 0.5 * dot(kb, ce), 0.5 * dot(kb, cf)
    ic, il, ir = 1.0 / chi, 1.0 / le, 1.0 / lf
    ate = scale(il, combine(-he, tt, ic, cross(tf, ce)))
    atf = scale(il, combine(-hf, tt, ic, cross(tf, cf)))
    bte = scale(-ir, combine(he, tt, ic, cross(te, ce)))
    btf = scale(-ir, combine(hf, tt, ic, cross(te, cf)))
    return (
        ee0, ee1, ee2, ef0, ef1, ef2, ate[0], atf[0],
        ee3, ee4, ef3, ef4, ef5, ate[1], atf[1],
        ee5, ef6, ef7, ef8, ate[2], atf[2],
        ff0, ff1, ff2, bte[0], btf[0],
        ff3, ff4, bte[1], btf[1],
        ff5, bte[2], btf[2],
        -0.5 * dot(kb, de), 0.0 * k,
        -0.5 * dot(kb, df),
    )  # fmt: skip


@kernel
def twist_gradient(pair: Any) -> Any:
    """Derivatives of the material twist theta_f - theta_e + beta to e (3) and f (3) [1/m]."""
    le, lf, _te, _tf, _chi, kb, _tt = pair
    return scale(0.5 / le, kb), scale(0.5 / lf, kb)


@kernel
def twist_hessian(pair: Any) -> Any:
    """Second derivatives of the material twist: packed blocks ee, ff and nine entries of ef.

    The angles enter linearly: all second derivatives with them vanish.
    """
    le, lf, te, tf, chi, kb, tt = pair
    ee = sym_outer(scale(-0.25 / (le * le), kb), add(te, tt))
    ff = sym_outer(scale(-0.25 / (lf * lf), kb), add(tf, tt))
    x = 0.5 / (le * lf)
    g = scale(2.0 * x / chi, te)
    ef = (
        -x * kb[0] * tt[0], -x * kb[0] * tt[1] - g[2], -x * kb[0] * tt[2] + g[1],
        -x * kb[1] * tt[0] + g[2], -x * kb[1] * tt[1], -x * kb[1] * tt[2] - g[0],
        -x * kb[2] * tt[0] - g[1], -x * kb[2] * tt[1] + g[0], -x * kb[2] * tt[2],
    )  # fmt: skip
    return ee, ff, ef
