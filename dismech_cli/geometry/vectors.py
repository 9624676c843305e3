"""Arithmetic of 2- and 3-component vectors and packed symmetric blocks, for kernels.

A symmetric 3x3 block is packed as its upper triangle ``(xx, xy, xz, yy, yz, zz)``; a general one
is the tuple of its nine entries by rows.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .kernel import kernel

Vector = Any
Block = Any


@kernel
def add(a: Vector, b: Vector) -> Vector:
    """Return a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@kernel
def sub(a: Vector, b: Vector) -> Vector:
    """Return a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@kernel
def scale(s: Any, a: Vector) -> Vector:
    """Return s a."""
    return (s * a[0], s * a[1], s * a[2])


@kernel
def combine(s: Any, a: Vector, r: Any, b: Vector) -> Vector:
    """Return s a + r b."""
    return (s * a[0] + r * b[0], s * a[1] + r * b[1], s * a[2] + r * b[2])


@kernel
def dot(a: Vector, b: Vector) -> Any:
    """Return a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def cross(a: Vector, b: Vector) -> Vector:
    """Return a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@kernel
def norm(a: Vector) -> Any:
    """Return |a|."""
    return np.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@kernel
def outer(a: Vector, b: Vector) -> Block:
    """Return a b^T, nine entries by rows."""
    return (
        a[0] * b[0],
        a[0] * b[1],
        a[0] * b[2],
        a[1] * b[0],
        a[1] * b[1],
        a[1] * b[2],
        a[2] * b[0],
        a[2] * b[1],
        a[2] * b[2],
    )


@kernel
def self_outer(a: Vector) -> Block:
    """Return a a^T, packed symmetric."""
    return (a[0] * a[0], a[0] * a[1], a[0] * a[2], a[1] * a[1], a[1] * a[2], a[2] * a[2])


@kernel
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
