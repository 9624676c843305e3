"""Arithmetic of 3-component vectors and 3x3 blocks, for kernels.

A symmetric block is packed as its upper triangle ``(xx, xy, xz, yy, yz, zz)``; a general one is
the tuple of its nine entries by rows. Each operation has two texts: one for tuples of numbers, and
the NumPy idiom for arrays with one row per component (see :mod:`.kernel`).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .kernel import operation, selection

Vector = Any
Block = Any

# Rows (i, j) of a packed symmetric block, and the components in a cycle, each after the one before.
_ROW, _COLUMN = np.array([0, 0, 0, 1, 1, 2]), np.array([0, 1, 2, 1, 2, 2])
_CYCLE = np.array([1, 2, 0, 1])
# Components of a in the matrix of a x; those on the diagonal are replaced.
_TURNED = np.array([0, 2, 1, 2, 0, 0, 1, 0, 0])


def _combine(s: Any, a: Any, r: Any, b: Any) -> Any:
    """Weighted sum of two arrays; factors of one, common in kernels, cost nothing."""
    first = a if type(s) is float and s == 1.0 else s * a
    if type(r) is float and r == 1.0:
        return first + b
    out = r * b
    out += first
    return out


def _dot(a: Any, b: Any) -> Any:
    products = a * b
    out = products[0]
    out += products[1]
    out += products[2]
    return out


@selection(np.where)
def where(condition: Any, a: Any, b: Any) -> Any:
    """Return a where a condition holds, else b."""
    return a if condition else b


@operation(lambda a, b: a + b)
def add(a: Vector, b: Vector) -> Vector:
    """Return a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@operation(lambda a, b: a - b)
def sub(a: Vector, b: Vector) -> Vector:
    """Return a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@operation(lambda s, a: s * a)
def scale(s: Any, a: Vector) -> Vector:
    """Return s a."""
    return (s * a[0], s * a[1], s * a[2])


@operation(_combine)
def combine(s: Any, a: Vector, r: Any, b: Vector) -> Vector:
    """Return s a + r b."""
    return (s * a[0] + r * b[0], s * a[1] + r * b[1], s * a[2] + r * b[2])


@operation(_dot)
def dot(a: Vector, b: Vector) -> Any:
    """Return a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Any, b: Any) -> Any:
    a, b = a.take(_CYCLE, axis=0), b.take(_CYCLE, axis=0)
    out = a[:3] * b[1:]
    out -= a[1:] * b[:3]
    return out


@operation(_cross)
def cross(a: Vector, b: Vector) -> Vector:
    """Return a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@operation(lambda a: np.sqrt(_dot(a, a)))
def norm(a: Vector) -> Any:
    """Return |a|."""
    return np.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@operation(lambda a, b: (a[:, None] * b).reshape(9, -1))
def outer(a: Vector, b: Vector) -> Block:
    """Return a b^T, nine entries by rows."""
    return (
        a[0] * b[0], a[0] * b[1], a[0] * b[2],
        a[1] * b[0], a[1] * b[1], a[1] * b[2],
        a[2] * b[0], a[2] * b[1], a[2] * b[2],
    )  # fmt: skip


def _self_outer(a: Any) -> Any:
    out = a.take(_ROW, axis=0)
    out *= a.take(_COLUMN, axis=0)
    return out


@operation(_self_outer)
def self_outer(a: Vector) -> Block:
    """Return a a^T, packed symmetric."""
    return (a[0] * a[0], a[0] * a[1], a[0] * a[2], a[1] * a[1], a[1] * a[2], a[2] * a[2])


def _sym_outer(a: Any, b: Any) -> Any:
    out = a.take(_ROW, axis=0)
    out *= b.take(_COLUMN, axis=0)
    other = a.take(_COLUMN, axis=0)
    other *= b.take(_ROW, axis=0)
    out += other
    return out


@operation(_sym_outer)
def sym_outer(a: Vector, b: Vector) -> Block:
    """Return a b^T + b a^T, packed symmetric."""
    return (
        2.0 * a[0] * b[0],
        a[0] * b[1] + a[1] * b[0],
        a[0] * b[2] + a[2] * b[0],
        2.0 * a[1] * b[1],
        a[1] * b[2] + a[2] * b[1],
        2.0 * a[2] * b[2],
    )


def _plus_sym_outer(block: Any, a: Any, b: Any) -> Any:
    block += _sym_outer(a, b)
    return block


@operation(_plus_sym_outer)
def plus_sym_outer(block: Block, a: Vector, b: Vector) -> Block:
    """Return block + a b^T + b a^T, packed symmetric; the block given is used up."""
    return (
        block[0] + 2.0 * a[0] * b[0],
        block[1] + a[0] * b[1] + a[1] * b[0],
        block[2] + a[0] * b[2] + a[2] * b[0],
        block[3] + 2.0 * a[1] * b[1],
        block[4] + a[1] * b[2] + a[2] * b[1],
        block[5] + 2.0 * a[2] * b[2],
    )


def _plus_dyad(block: Any, a: Any, b: Any) -> Any:
    dyad = a.take(_ROW, axis=0)
    dyad *= b.take(_COLUMN, axis=0)
    block += dyad
    return block


@operation(_plus_dyad)
def plus_dyad(block: Block, a: Vector, b: Vector) -> Block:
    """Return block + a b^T of parallel vectors, packed symmetric; the block given is used up."""
    return (
        block[0] + a[0] * b[0], block[1] + a[0] * b[1], block[2] + a[0] * b[2],
        block[3] + a[1] * b[1], block[4] + a[1] * b[2], block[5] + a[2] * b[2],
    )  # fmt: skip


def _plus_outer(block: Any, a: Any, b: Any) -> Any:
    block += (a[:, None] * b).reshape(9, -1)
    return block


@operation(_plus_outer)
def plus_outer(block: Block, a: Vector, b: Vector) -> Block:
    """Return block + a b^T, nine entries by rows; the block given is used up."""
    return (
        block[0] + a[0] * b[0], block[1] + a[0] * b[1], block[2] + a[0] * b[2],
        block[3] + a[1] * b[0], block[4] + a[1] * b[1], block[5] + a[1] * b[2],
        block[6] + a[2] * b[0], block[7] + a[2] * b[1], block[8] + a[2] * b[2],
    )  # fmt: skip


@operation(lambda s, a: s * a)
def scale_symmetric(s: Any, a: Block) -> Block:
    """Return s a of a packed symmetric block."""
    return (s * a[0], s * a[1], s * a[2], s * a[3], s * a[4], s * a[5])


@operation(_combine)
def combine_symmetric(s: Any, a: Block, r: Any, b: Block) -> Block:
    """Return s a + r b of packed symmetric blocks."""
    return (
        s * a[0] + r * b[0], s * a[1] + r * b[1], s * a[2] + r * b[2],
        s * a[3] + r * b[3], s * a[4] + r * b[4], s * a[5] + r * b[5],
    )  # fmt: skip


@operation(_combine)
def combine_block(s: Any, a: Block, r: Any, b: Block) -> Block:
    """Return s a + r b of general blocks."""
    return (
        s * a[0] + r * b[0], s * a[1] + r * b[1], s * a[2] + r * b[2],
        s * a[3] + r * b[3], s * a[4] + r * b[4], s * a[5] + r * b[5],
        s * a[6] + r * b[6], s * a[7] + r * b[7], s * a[8] + r * b[8],
    )  # fmt: skip


def _expand(a: Any) -> Any:
    return a.take([0, 1, 2, 1, 3, 4, 2, 4, 5], axis=0)


@operation(_expand)
def expand(a: Block) -> Block:
    """Return the nine entries of a packed symmetric block."""
    return (a[0], a[1], a[2], a[1], a[3], a[4], a[2], a[4], a[5])


def _add_identity(s: Any, a: Any) -> Any:
    for entry in (a[0], a[3], a[5]):
        entry += s
    return a


@operation(_add_identity)
def add_identity(s: Any, a: Block) -> Block:
    """Return s I + a of a packed symmetric block, which is used up."""
    return (a[0] + s, a[1], a[2], a[3] + s, a[4], a[5] + s)


def _spin(s: Any, a: Any) -> Any:
    out = a.take(_TURNED, axis=0)
    for entry in (out[1], out[5], out[6]):
        np.negative(entry, out=entry)
    out[::4] = s
    return out


@operation(_spin)
def spin(s: Any, a: Vector) -> Block:
    """Return s I + the matrix of a x, nine entries by rows."""
    return (s, -a[2], a[1], a[2], s, -a[0], -a[1], a[0], s)
