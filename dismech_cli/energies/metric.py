"""From derivatives to the metric of a triangle to derivatives to its edge vectors."""

from __future__ import annotations

from typing import Any

from ..geometry.blocks import add_diagonal, add_symmetric, outer_pair, pack_two
from ..geometry.kernel import kernel
from ..geometry.vectors import add_identity, combine, scale, sym_outer


@kernel
def by_edges(u: Any, v: Any, s: Any, c: Any) -> Any:
    """Gradient and packed Hessian to (u, v) of an energy of the metric strains.

    Args:
        u: First edge vector.
        v: Second edge vector.
        s: Stresses: derivatives to u.u / 2, v.v / 2 and u.v.
        c: Derivatives of the stresses to these, upper triangle by rows.
    """
    s0, s1, s2 = s
    c00, c01, c02, c11, c12, c22 = c
    g, h = combine(s0, u, s2, v), combine(s1, v, s2, u)
    # slopes of the stresses: ds0 = c00 u.da + c02 (v.da + u.db) + c01 v.db, ds1 and ds2 alike
    first = add_symmetric(sym_outer(u, combine(0.5 * c00, u, c02, v)), sym_outer(v, scale(0.5 * c22, v)))
    second = add_symmetric(sym_outer(v, combine(0.5 * c11, v, c12, u)), sym_outer(u, scale(0.5 * c22, u)))
    mixed = outer_pair(u, combine(c02, u, c01, v), v, combine(c22, u, c12, v))
    hessian = pack_two(add_identity(s0, first), add_diagonal(s2, mixed), add_identity(s1, second))
    return (g[0], g[1], g[2], h[0], h[1], h[2]), hessian
