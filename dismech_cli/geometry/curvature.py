"""Material curvature and material twist of two consecutive edges, with derivatives.

Both strains depend on the edge vectors e, f and the angles theta_e, theta_f of the material
directors. Gradients follow Bergou et al. 2008 (eqs. 2, 7, 9 of its appendix) and Bergou et al.
2010; the second derivatives are the symmetric ones, which are the exact Hessian of the energy at
the state where the reference frames are stored.
"""

from __future__ import annotations

from typing import Any

from .kernel import kernel
from .vectors import (
    Vector,
    add,
    add_identity,
    combine,
    combine_block,
    combine_symmetric,
    cross,
    dot,
    norm,
    outer,
    scale,
    self_outer,
    skew,
    spin,
    sym_outer,
)


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
        kappa [1] and its derivatives to e, f (vectors [1/m]), theta_e, theta_f [1].
    """
    le, lf, te, tf, chi, kb, tt = pair
    d = scale(1.0 / chi, add(de, df))
    kappa = 0.5 * chi * dot(kb, d)
    ge = combine(-kappa / le, tt, 1.0 / le, cross(tf, d))
    gf = combine(-kappa / lf, tt, -1.0 / lf, cross(te, d))
    return kappa, ge, gf, 0.5 * dot(kb, ce), 0.5 * dot(kb, cf)


@kernel
def curvature_hessian(pair: Any, kappa: Any, de: Vector, df: Vector, ce: Vector, cf: Vector) -> Any:
    """Second derivatives of the curvature.

    They are linear in the directors and in ``kappa``, so weighted sums of both material curvatures
    are differentiated in one call.

    Returns:
        Symmetric blocks ee and ff, block ef (row e, column f), vectors e-theta_e, e-theta_f,
        f-theta_e, f-theta_f, and theta_e-theta_e, theta_f-theta_f; theta_e-theta_f vanishes.
    """
    le, lf, te, tf, chi, kb, tt = pair
    d = scale(1.0 / chi, add(de, df))
    u, w = cross(tf, d), cross(te, d)
    k, k2 = kappa / chi, 2.0 * kappa
    a, b, x = 1.0 / (le * le), 1.0 / (lf * lf), 1.0 / (le * lf)
    # S(a, b) = a b^T + b a^T; factors go to vectors, which are smaller than blocks
    # ee = [S(tt, kappa tt - u) - k (I - te te^T) + S(kb, de)/4] / le^2, ff alike
    ee = combine_symmetric(a * k, self_outer(te), 1.0, sym_outer(tt, combine(a * kappa, tt, -a, u)))
    ee = add_identity(-a * k, combine_symmetric(1.0, ee, 1.0, sym_outer(scale(0.25 * a, kb), de)))
    ff = combine_symmetric(b * k, self_outer(tf), 1.0, sym_outer(tt, combine(b * kappa, tt, b, w)))
    ff = add_identity(-b * k, combine_symmetric(1.0, ff, 1.0, sym_outer(scale(0.25 * b, kb), df)))
    # ef = [tt (2 kappa tt + w)^T - u tt^T - k te tf^T - (k I + [d]x)] / (le lf)
    ef = combine_block(1.0, outer(tt, combine(x * k2, tt, x, w)), 1.0, outer(scale(-x, u), tt))
    ef = combine_block(1.0, ef, 1.0, outer(scale(-x * k, te), tf))
    ef = combine_block(1.0, ef, 1.0, spin(-x * k, scale(-x, d)))
    he, hf = 0.5 * dot(kb, ce), 0.5 * dot(kb, cf)
    il, ir = 1.0 / le, 1.0 / lf
    ate = combine(-he * il, tt, il / chi, cross(tf, ce))
    atf = combine(-hf * il, tt, il / chi, cross(tf, cf))
    bte = combine(-he * ir, tt, -ir / chi, cross(te, ce))
    btf = combine(-hf * ir, tt, -ir / chi, cross(te, cf))
    return ee, ff, ef, ate, atf, bte, btf, -0.5 * dot(kb, de), -0.5 * dot(kb, df)


@kernel
def twist_gradient(pair: Any) -> Any:
    """Derivatives of the material twist theta_f - theta_e + beta to e and f (vectors [1/m])."""
    le, lf, _te, _tf, _chi, kb, _tt = pair
    return scale(0.5 / le, kb), scale(0.5 / lf, kb)


@kernel
def twist_hessian(pair: Any) -> Any:
    """Second derivatives of the material twist: symmetric blocks ee, ff and block ef.

    The angles enter linearly: all second derivatives with them vanish.
    """
    le, lf, te, tf, chi, kb, tt = pair
    ee = sym_outer(scale(-0.25 / (le * le), kb), add(te, tt))
    ff = sym_outer(scale(-0.25 / (lf * lf), kb), add(tf, tt))
    x = 0.5 / (le * lf)
    return ee, ff, combine_block(2.0 * x / chi, skew(te), -x, outer(kb, tt))


@kernel
def pack_edges_and_angles(
    ee: Any, ff: Any, ef: Any, ate: Vector, atf: Vector, bte: Vector, btf: Vector, tt: Any
) -> Any:
    """Packed 8x8 Hessian of (e, f, theta_e, theta_f).

    Args:
        ee: Symmetric block; ``ff`` likewise.
        ff: See ``ee``.
        ef: Block with rows e and columns f.
        ate: Column theta_e of rows e; ``atf`` column theta_f; ``bte`` and ``btf`` of rows f.
        atf: See ``ate``.
        bte: See ``ate``.
        btf: See ``ate``.
        tt: Entries (theta_e theta_e, theta_e theta_f, theta_f theta_f).
    """
    return (
        ee[0], ee[1], ee[2], ef[0], ef[1], ef[2], ate[0], atf[0],
        ee[3], ee[4], ef[3], ef[4], ef[5], ate[1], atf[1],
        ee[5], ef[6], ef[7], ef[8], ate[2], atf[2],
        ff[0], ff[1], ff[2], bte[0], btf[0],
        ff[3], ff[4], bte[1], btf[1],
        ff[5], bte[2], btf[2],
        tt[0], tt[1],
        tt[2],
    )  # fmt: skip
