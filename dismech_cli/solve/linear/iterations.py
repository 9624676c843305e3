"""Iterations that solve with a matrix by factors of one near it."""

from __future__ import annotations

from math import sqrt

import numpy as np

from ...arrays import FloatArray
from .factors import Linear

# Less curvature along a direction than this share of what the factors have there, and the matrix may be about
# to turn indefinite: factors of its own tell.
_SOFTER = 0.5


def conjugate_gradients(
    nearly: Linear, product: Linear, rhs: FloatArray, left: float, most: int
) -> FloatArray | None:
    """Solve A x = b by conjugate gradients; None where A is not near enough.

    Args:
        nearly: Solves with a symmetric positive definite matrix near A.
        product: A times a vector; symmetric.
        rhs: b, shape (m,).
        left: What may be left of b, as a share in the norm of the inverse.
        most: Solutions with the factors at most.
    """
    x, r = np.zeros_like(rhs), rhs.copy()
    p, first, before = rhs, 0.0, 1.0
    for k in range(most):
        z = nearly(r)
        size = float(r @ z)
        if not size > 0.0:
            return None
        if k == 0:
            p, first = z, size
        elif size <= left * left * first:
            return x + z
        else:
            p = z + (size / before) * p
        along = product(p)
        curvature = float(p @ along)
        if not curvature > _SOFTER * size:
            return None
        step = size / curvature
        x += step * p
        r -= step * along
        before = size
    return None


def conjugate_residuals(
    nearly: Linear, product: Linear, rhs: FloatArray, left: float, most: int
) -> FloatArray | None:
    """Solve A x = b by generalised conjugate residuals; None where A is not near enough.

    Args:
        nearly: Solves with a matrix near A.
        product: A times a vector.
        rhs: b, shape (m,).
        left: What may be left of b, as a share of its norm.
        most: Solutions with the factors at most.
    """
    x, r = np.zeros_like(rhs), rhs.copy()
    goal = left * sqrt(float(rhs @ rhs))
    steps: list[tuple[FloatArray, FloatArray]] = []
    for _ in range(most):
        p = nearly(r)
        along = product(p)
        for other, known in steps:
            share = float(along @ known)
            p = p - share * other
            along = along - share * known
        size = sqrt(float(along @ along))
        if not size > 0.0:
            return None
        p, along = p / size, along / size
        step = float(r @ along)
        x += step * p
        r -= step * along
        if sqrt(float(r @ r)) <= goal:
            return x
        steps.append((p, along))
    return None
