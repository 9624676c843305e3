"""Parallel transport and signed angles, for kernels (Bergou et al. 2008, 2010)."""

from __future__ import annotations

from typing import Any

import numpy as np

from .kernel import kernel
from .vectors import Vector, add, combine, cross, dot, norm, scale

# Below |t0 x t1|^2 of this size antiparallel tangents define no plane of rotation.
_TINY = 1e-300


@kernel
def parallel_transport(u: Vector, t0: Vector, t1: Vector) -> Vector:
    """Rotate ``u`` by the smallest rotation that takes unit vector ``t0`` to unit vector ``t1``.

    Rodrigues' formula P u = c u + b x u + (b.u) b / (1 + c), with b = t0 x t1, c = t0.t1. The
    factor 1/(1 + c) is taken as (1 - c)/|b|^2 where c < 0: the textbook form loses eight digits
    at nearly antiparallel tangents.
    """
    b = cross(t0, t1)
    c = dot(t0, t1)
    acute = 1.0 * (c.real > 0.0)
    factor = acute / (2.0 - acute + acute * c) + (1.0 - acute) * (1.0 - c) / (dot(b, b) + acute + _TINY)
    return add(combine(c, u, factor * dot(b, u), b), cross(b, u))


@kernel
def orthonormal_to(u: Vector, t: Vector) -> Vector:
    """Return ``u`` less its component along unit vector ``t``, normalised."""
    w = combine(1.0, u, -dot(u, t), t)
    return scale(1.0 / norm(w), w)


@kernel
def rotate_about(u: Vector, t: Vector, angle: Any) -> Vector:
    """Rotate ``u``, orthogonal to unit vector ``t``, about ``t`` by ``angle`` [rad]."""
    return combine(np.cos(angle), u, np.sin(angle), cross(t, u))


@kernel
def signed_angle(u: Vector, v: Vector, axis: Vector) -> Any:
    """Angle [rad] in (-pi, pi] from ``u`` to ``v`` about unit vector ``axis``."""
    return np.arctan2(dot(axis, cross(u, v)), dot(u, v))
