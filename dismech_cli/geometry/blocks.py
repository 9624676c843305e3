"""Packed Hessians from 3x3 blocks, for kernels whose variables are vectors.

A diagonal block is packed symmetric (six entries), an off-diagonal one has nine entries by rows.
"""

from __future__ import annotations

from typing import Any

from .kernel import kernel, operation
from .vectors import Block, Vector


@operation(lambda a, b: a + b)
def add_symmetric(a: Block, b: Block) -> Block:
    """Return the sum of two packed symmetric blocks."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5])


@operation(lambda a, b: a + b)
def add_block(a: Block, b: Block) -> Block:
    """Return the sum of two general blocks."""
    return (
        a[0] + b[0], a[1] + b[1], a[2] + b[2],
        a[3] + b[3], a[4] + b[4], a[5] + b[5],
        a[6] + b[6], a[7] + b[7], a[8] + b[8],
    )  # fmt: skip


def _add_diagonal(s: Any, a: Any) -> Any:
    out = a.copy()
    diagonal = out[::4]
    diagonal += s
    return out


@operation(_add_diagonal)
def add_diagonal(s: Any, a: Block) -> Block:
    """Return s I + a of a general block."""
    return (a[0] + s, a[1], a[2], a[3], a[4] + s, a[5], a[6], a[7], a[8] + s)


def _outer_pair(a: Any, b: Any, c: Any, d: Any) -> Any:
    out = a[:, None] * b
    out += c[:, None] * d
    return out.reshape(9, -1)


@operation(_outer_pair)
def outer_pair(a: Vector, b: Vector, c: Vector, d: Vector) -> Block:
    """Return a b^T + c d^T, nine entries by rows."""
    return (
        a[0] * b[0] + c[0] * d[0], a[0] * b[1] + c[0] * d[1], a[0] * b[2] + c[0] * d[2],
        a[1] * b[0] + c[1] * d[0], a[1] * b[1] + c[1] * d[1], a[1] * b[2] + c[1] * d[2],
        a[2] * b[0] + c[2] * d[0], a[2] * b[1] + c[2] * d[1], a[2] * b[2] + c[2] * d[2],
    )  # fmt: skip


def _three_outers(a: Any, b: Any, c: Any, d: Any, e: Any, f: Any) -> Any:
    out = a[:, None] * b
    out += c[:, None] * d
    out += e[:, None] * f
    return out.reshape(9, -1)


@operation(_three_outers)
def three_outers(a: Vector, b: Vector, c: Vector, d: Vector, e: Vector, f: Vector) -> Block:
    """Return a b^T + c d^T + e f^T, nine entries by rows."""
    return (
        a[0] * b[0] + c[0] * d[0] + e[0] * f[0],
        a[0] * b[1] + c[0] * d[1] + e[0] * f[1],
        a[0] * b[2] + c[0] * d[2] + e[0] * f[2],
        a[1] * b[0] + c[1] * d[0] + e[1] * f[0],
        a[1] * b[1] + c[1] * d[1] + e[1] * f[1],
        a[1] * b[2] + c[1] * d[2] + e[1] * f[2],
        a[2] * b[0] + c[2] * d[0] + e[2] * f[0],
        a[2] * b[1] + c[2] * d[1] + e[2] * f[1],
        a[2] * b[2] + c[2] * d[2] + e[2] * f[2],
    )


@kernel
def two_sided(n: Vector, y: Vector, w: Vector) -> Block:
    """Return n y^T + w n^T, nine entries by rows."""
    return outer_pair(n, y, w, n)


@kernel
def outer_sum(a: Any, b: Any) -> Block:
    """Return a_0 b_0^T + a_1 b_1^T + a_2 b_2^T of three vectors each, nine entries by rows."""
    return three_outers(a[0], b[0], a[1], b[1], a[2], b[2])


@operation(lambda a: a.take((0, 1, 2, 4, 5, 8), axis=0))
def upper(a: Block) -> Block:
    """Return the packed upper triangle of a general block that is symmetric."""
    return (a[0], a[1], a[2], a[4], a[5], a[8])


@kernel
def symmetric_outer_sum(a: Any, b: Any) -> Block:
    """The same as :func:`outer_sum` where the sum is known to be symmetric, packed."""
    return upper(outer_sum(a, b))


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
def pack_three_and_angle(
    aa: Block,
    ab: Block,
    ac: Block,
    bb: Block,
    bc: Block,
    cc: Block,
    at: Vector,
    bt: Vector,
    ct: Vector,
    tt: Any,
) -> Any:
    """Packed 10x10 Hessian of three vectors and an angle.

    Args:
        aa: Diagonal block; ``bb`` and ``cc`` likewise.
        ab: Rows of the first vector, columns of the second; ``ac`` and ``bc`` likewise.
        ac: See ``ab``.
        bb: See ``aa``.
        bc: See ``ab``.
        cc: See ``aa``.
        at: Column of the angle in the rows of the first vector; ``bt`` and ``ct`` likewise.
        bt: See ``at``.
        ct: See ``at``.
        tt: Second derivative to the angle.
    """
    return (
        aa[0], aa[1], aa[2], ab[0], ab[1], ab[2], ac[0], ac[1], ac[2], at[0],
        aa[3], aa[4], ab[3], ab[4], ab[5], ac[3], ac[4], ac[5], at[1],
        aa[5], ab[6], ab[7], ab[8], ac[6], ac[7], ac[8], at[2],
        bb[0], bb[1], bb[2], bc[0], bc[1], bc[2], bt[0],
        bb[3], bb[4], bc[3], bc[4], bc[5], bt[1],
        bb[5], bc[6], bc[7], bc[8], bt[2],
        cc[0], cc[1], cc[2], ct[0],
        cc[3], cc[4], ct[1],
        cc[5], ct[2],
        tt,
    )  # fmt: skip


@operation(tuple)
def entries(a: Block) -> Any:
    """The rows of a block: slices of arrays would add where those of tuples join."""
    return a


@operation(lambda s, a: s * a)
def scale_block(s: Any, a: Block) -> Block:
    """Return s a of a block given by all entries."""
    return (s * a[0], s * a[1], s * a[2], s * a[3], s * a[4], s * a[5], s * a[6], s * a[7], s * a[8])


@kernel
def side_by_side(a: Block, b: Block) -> Any:
    """Rows of two blocks, one beside the other: 18 entries."""
    left, right = entries(a), entries(b)
    return left[:3] + right[:3] + left[3:6] + right[3:6] + left[6:] + right[6:]


@kernel
def with_column(a: Block, b: Vector) -> Any:
    """Rows of a block with a column beside it: 12 entries."""
    return (
        a[0], a[1], a[2], b[0],
        a[3], a[4], a[5], b[1],
        a[6], a[7], a[8], b[2],
    )  # fmt: skip


@kernel
def pack_five(d: Any, o: Any) -> Any:
    """Packed 15x15 Hessian of five vectors.

    Args:
        d: The five diagonal blocks.
        o: The off-diagonal blocks 01, 02, 03, 04, 12, 13, 14, 23, 24, 34.
    """
    a, b, c, e, f = entries(d[0]), entries(d[1]), entries(d[2]), entries(d[3]), entries(d[4])
    ab, ac, ae, af, bc = entries(o[0]), entries(o[1]), entries(o[2]), entries(o[3]), entries(o[4])
    be, bf, ce, cf, ef = entries(o[5]), entries(o[6]), entries(o[7]), entries(o[8]), entries(o[9])
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
