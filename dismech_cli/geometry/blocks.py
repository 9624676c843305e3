"""Packed Hessians from 3x3 blocks, for kernels whose variables are vectors.

A diagonal block is packed symmetric (six entries), an off-diagonal one has nine entries by rows.
"""

from __future__ import annotations

from typing import Any

from .kernel import kernel
from .vectors import Block, Vector


@kernel
def add_symmetric(a: Block, b: Block) -> Block:
    """Return the sum of two packed symmetric blocks."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5])


@kernel
def add_block(a: Block, b: Block) -> Block:
    """Return the sum of two general blocks."""
    return (
        a[0] + b[0], a[1] + b[1], a[2] + b[2],
        a[3] + b[3], a[4] + b[4], a[5] + b[5],
        a[6] + b[6], a[7] + b[7], a[8] + b[8],
    )  # fmt: skip


@kernel
def two_sided(n: Vector, y: Vector, w: Vector) -> Block:
    """Return n y^T + w n^T, nine entries by rows."""
    return (
        n[0] * y[0] + w[0] * n[0], n[0] * y[1] + w[0] * n[1], n[0] * y[2] + w[0] * n[2],
        n[1] * y[0] + w[1] * n[0], n[1] * y[1] + w[1] * n[1], n[1] * y[2] + w[1] * n[2],
        n[2] * y[0] + w[2] * n[0], n[2] * y[1] + w[2] * n[1], n[2] * y[2] + w[2] * n[2],
    )  # fmt: skip


@kernel
def outer_sum(a: Any, b: Any) -> Block:
    """Return a_0 b_0^T + a_1 b_1^T + a_2 b_2^T of three vectors each, nine entries by rows."""
    (p, q, r), (u, v, w) = a, b
    return (
        p[0] * u[0] + q[0] * v[0] + r[0] * w[0],
        p[0] * u[1] + q[0] * v[1] + r[0] * w[1],
        p[0] * u[2] + q[0] * v[2] + r[0] * w[2],
        p[1] * u[0] + q[1] * v[0] + r[1] * w[0],
        p[1] * u[1] + q[1] * v[1] + r[1] * w[1],
        p[1] * u[2] + q[1] * v[2] + r[1] * w[2],
        p[2] * u[0] + q[2] * v[0] + r[2] * w[0],
        p[2] * u[1] + q[2] * v[1] + r[2] * w[1],
        p[2] * u[2] + q[2] * v[2] + r[2] * w[2],
    )


@kernel
def symmetric_outer_sum(a: Any, b: Any) -> Block:
    """The same where the sum is known to be symmetric, packed."""
    (p, q, r), (u, v, w) = a, b
    return (
        p[0] * u[0] + q[0] * v[0] + r[0] * w[0],
        p[0] * u[1] + q[0] * v[1] + r[0] * w[1],
        p[0] * u[2] + q[0] * v[2] + r[0] * w[2],
        p[1] * u[1] + q[1] * v[1] + r[1] * w[1],
        p[1] * u[2] + q[1] * v[2] + r[1] * w[2],
        p[2] * u[2] + q[2] * v[2] + r[2] * w[2],
    )


@kernel
def pack_two(aa: Block, ab: Block, bb: Block) -> Any:
    """Packed 6x6 Hessian of two vectors."""
    return (
        aa[0], aa[1], aa[2], ab[0], ab[1], ab[2],
        aa[3], aa[4], ab[3], ab[4], ab[5],
        aa[5], ab[6], ab[7], ab[8],
        bb[0], bb[1], bb[2], bb[3], bb[4], bb[5],
    )  # fmt: skip


@kernel
def pack_three(aa: Block, ab: Block, ac: Block, bb: Block, bc: Block, cc: Block) -> Any:
    """Packed 9x9 Hessian of three vectors."""
    return (
        aa[0], aa[1], aa[2], ab[0], ab[1], ab[2], ac[0], ac[1], ac[2],
        aa[3], aa[4], ab[3], ab[4], ab[5], ac[3], ac[4], ac[5],
        aa[5], ab[6], ab[7], ab[8], ac[6], ac[7], ac[8],
        bb[0], bb[1], bb[2], bc[0], bc[1], bc[2],
        bb[3], bb[4], bc[3], bc[4], bc[5],
        bb[5], bc[6], bc[7], bc[8],
        cc[0], cc[1], cc[2], cc[3], cc[4], cc[5],
    )  # fmt: skip


@kernel
def pack_five(d: Any, o: Any) -> Any:
    """Packed 15x15 Hessian of five vectors.

    Args:
        d: The five diagonal blocks.
        o: The off-diagonal blocks 01, 02, 03, 04, 12, 13, 14, 23, 24, 34.
    """
    a, b, c, e, f = d
    ab, ac, ae, af, bc, be, bf, ce, cf, ef = o
    return (
        a[:3] + ab[:3] + ac[:3] + ae[:3] + af[:3]
        + a[3:5] + ab[3:6] + ac[3:6] + ae[3:6] + af[3:6]
        + a[5:] + ab[6:] + ac[6:] + ae[6:] + af[6:]
        + b[:3] + bc[:3] + be[:3] + bf[:3]
        + b[3:5] + bc[3:6] + be[3:6] + bf[3:6]
        + b[5:] + bc[6:] + be[6:] + bf[6:]
        + c[:3] + ce[:3] + cf[:3]
        + c[3:5] + ce[3:6] + cf[3:6]
        + c[5:] + ce[6:] + cf[6:]
        + e[:3] + ef[:3]
        + e[3:5] + ef[3:6]
        + e[5:] + ef[6:]
        + f
    )  # fmt: skip
