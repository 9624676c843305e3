"""Regularised Coulomb friction at a point of contact, with its derivatives."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...geometry.kernel import kernel
from ...geometry.vectors import (
    Block,
    Vector,
    add_identity,
    combine,
    combine_block,
    combine_symmetric,
    dot,
    expand,
    outer,
    scale,
    scale_symmetric,
    self_outer,
)

_STILL = 1e-300


@kernel
def slip(v: Vector, n: Vector) -> Vector:
    """The part of a relative velocity across the normal."""
    return combine(1.0, v, -dot(v, n), n)


@kernel
def friction_force(load: Any, sharpness: Any, u: Vector) -> Vector:
    """Regularised Coulomb friction against the slip u: load tanh(K u / 2) along it, K = 15 / slip speed.

    Args:
        load: Friction coefficient times normal force [N].
        sharpness: K / 2 [s/m].
        u: Slip [m/s].
    """
    speed = np.sqrt(dot(u, u) + _STILL)
    return scale(load * np.tanh(sharpness * speed) / speed, u)


@kernel
def friction_slopes(load: Any, sharpness: Any, u: Vector) -> Any:
    """Slopes of that force along the slip and across it [N s/m]."""
    speed = np.sqrt(dot(u, u) + _STILL)
    part = np.tanh(sharpness * speed)
    return load * sharpness * (1.0 - part * part), load * part / speed


@kernel
def friction_by_velocity(load: Any, sharpness: Any, u: Vector, n: Vector) -> Block:
    """Derivative of that force to the relative velocity, nine entries by rows; symmetric."""
    along, across = friction_slopes(load, sharpness, u)
    excess = (along - across) / (dot(u, u) + _STILL)
    inside = add_identity(across, scale_symmetric(-across, self_outer(n)))
    return expand(combine_symmetric(1.0, inside, excess, self_outer(u)))


@kernel
def friction_by_position(
    load: Any,
    growth: Any,
    sharpness: Any,
    u: Vector,
    n: Vector,
    e: Vector,
    round_: Any,
    axis: Any,
    v: Vector,
) -> Block:
    """Derivative of that force to the gap vector, nine entries by rows; not symmetric.

    The normal turns by dn = (round T + axis e e^T) dx with T = I - n n^T; the slip by
    du = -(u.dn) n - (n.v) dn.

    Args:
        load: mu times normal force [N].
        growth: Slope of it along the gap [N/m].
        sharpness: K / 2 [s/m].
        u: Slip [m/s].
        n: Unit gap vector.
        e: Axis of the feature, across n; zero for a face.
        round_: How far the normal turns [1/m]: 1 / |x| at a corner or beside an edge, 0 above a face.
        axis: What of that an edge keeps along its axis [1/m].
        v: Relative velocity [m/s].
    """
    along, across = friction_slopes(load, sharpness, u)
    excess = (along - across) / (dot(u, u) + _STILL)
    force = scale(across, u)
    lift, away = dot(n, v), scale(axis * dot(u, e), e)
    out = combine_block(
        growth / (load + _STILL), outer(force, n), -1.0, outer(n, _turned(force, e, round_, axis))
    )
    inside = add_identity(across * round_, scale_symmetric(-across * round_, self_outer(n)))
    inside = combine_symmetric(1.0, inside, across * axis, self_outer(e))
    return combine_block(
        1.0,
        combine_block(1.0, out, -lift, expand(inside)),
        -lift * excess,
        outer(u, combine(round_, u, 1.0, away)),
    )


@kernel
def _turned(a: Vector, e: Vector, round_: Any, axis: Any) -> Vector:
    """The derivative of the normal applied to a vector across the normal."""
    return combine(round_, a, axis * dot(a, e), e)
