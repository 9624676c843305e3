"""Material curvatures of two consecutive edges, for kernels (Bergou et al. 2008, 2010)."""

from __future__ import annotations

from typing import Any

import numpy as np

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
def joint_directors(
    m1e: Vector, m2e: Vector, m1f: Vector, m2f: Vector, half: Any, cosine: Any, sine: Any
) -> Any:
    """Directors half way between two edges, on either of them.

    Those on f are those on e, parallel-transported, at any twist.

    Args:
        m1e: Directors of the edge walked first; ``m2e`` likewise.
        m2e: See ``m1e``.
        m1f: Directors of the other; ``m2f`` likewise.
        m2f: See ``m1f``.
        half: Half of the twist beyond the rest twist [rad].
        cosine: Of the rest twist; ``sine`` likewise.
        sine: See ``cosine``.
    """
    c, s = np.cos(half), np.sin(half)
    d1e, d2e = turned(m1e, m2e, c, -s)
    d1f, d2f = turned(m1f, m2f, c * cosine - s * sine, s * cosine + c * sine)
    return d1e, d2e, d1f, d2f


@kernel
def curvature_slopes(kb: Vector, d1: Vector, d2: Vector) -> Any:
    """Derivatives of both material curvatures to the angle of either edge: -kb.d1/2 and -kb.d2/2.

    The curvatures themselves are kappa_1 = kb.d2 and kappa_2 = -kb.d1 with directors half way between
    those of the edges.
    """
    return -0.5 * dot(kb, d1), -0.5 * dot(kb, d2)


@kernel
def curvature_gradients(slope: Any, tilt: Any, tt: Vector, kappa: Any, c1: Vector, c2: Vector) -> Any:
    """Derivatives of both material curvatures to one edge vector [1/m].

    With the joint's directors d on either edge and d = (d2e + d2f)/chi the derivative of kappa_1 to e is
    (tf x d - kappa_1 tt)/|e|, and that to f is -(te x d + kappa_1 tt)/|f|. As t x d1 = d2 and
    t x d2 = -d1, the cross products are ``c1 = tf x d2e - d1f`` for e and ``te x d2f - d1e`` for f; those
    of kappa_2, with -d1 in place of d2, are ``-c2 = -(tf x d1e + d2f)`` and ``-(te x d1f + d2e)``.

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
