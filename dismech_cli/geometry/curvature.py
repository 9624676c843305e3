"""Material curvatures of two consecutive edges, for kernels (Bergou et al. 2008, 2010)."""

from __future__ import annotations

from typing import Any

from .kernel import kernel
from .vectors import Vector, add, combine, cross, dot, norm, scale


@kernel
def edge_pair(e: Vector, f: Vector) -> Any:
    """Shared geometry: 1/|e|, 1/|f|, unit tangents, 1/chi, curvature binormal, tilted tangent.

    Returns:
        ``(il, ir, te, tf, ic, kb, tt)`` with chi = 1 + te.tf, kb = 2 te x tf / chi and
        tt = (te + tf)/chi.
    """
    il, ir = 1.0 / norm(e), 1.0 / norm(f)
    te, tf = scale(il, e), scale(ir, f)
    ic = 1.0 / (1.0 + dot(te, tf))
    return il, ir, te, tf, ic, scale(2.0 * ic, cross(te, tf)), scale(ic, add(te, tf))


@kernel
def turned(r1: Vector, r2: Vector, cosine: Any, sine: Any) -> Any:
    """Directors turned back by an angle about their tangent."""
    return combine(cosine, r1, -sine, r2), combine(sine, r1, cosine, r2)


@kernel
def curvature_slopes(kb: Vector, m1: Vector, m2: Vector) -> Any:
    """Derivatives of both material curvatures to the angle of one edge: -kb.m1/2 and -kb.m2/2.

    The curvatures themselves are kappa_1 = kb.(m2e + m2f)/2 and kappa_2 = -kb.(m1e + m1f)/2: sums of
    these numbers.
    """
    return -0.5 * dot(kb, m1), -0.5 * dot(kb, m2)


@kernel
def curvature_gradients(slope: Any, tilt: Any, tt: Vector, kappa: Any, c1: Vector, c2: Vector) -> Any:
    """Derivatives of both material curvatures to one edge vector [1/m].

    With d = (m2e + m2f)/chi the derivative of kappa_1 to e is (tf x d - kappa_1 tt)/|e|, and that to
    f is -(te x d + kappa_1 tt)/|f|. As t x m1 = m2 and t x m2 = -m1, the cross products are
    ``c1 = tf x m2e - m1f`` for e and ``te x m2f - m1e`` for f; those of kappa_2, with -m1 in place
    of m2, are ``-c2 = -(tf x m1e + m2f)`` and ``-(te x m1f + m2e)``.

    Args:
        slope: 1/|e|, or 1/|f|.
        tilt: 1/(|e| chi), or -1/(|f| chi).
        tt: Tilted tangent.
        kappa: Both curvatures.
        c1: See above.
        c2: See above.
    """
    k1, k2 = kappa
    return combine(tilt, c1, -slope * k1, tt), combine(-tilt, c2, -slope * k2, tt)


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
