"""The turn from one frame to another as a vector without a branch below pi (Cayley's, twice Rodrigues')."""

from __future__ import annotations

from typing import Any

from .kernel import kernel
from .vectors import Vector, add, combine, cross, dot, scale


@kernel
def turn(d0: Vector, d1: Vector, d2: Vector, g0: Vector, g1: Vector, g2: Vector) -> Vector:
    """Rotation vector 2 tan(phi/2) n from frame d to frame g."""
    trace = dot(d0, g0) + dot(d1, g1) + dot(d2, g2)
    return scale(2.0 / (1.0 + trace), add(add(cross(d0, g0), cross(d1, g1)), cross(d2, g2)))


@kernel
def turn_from_rest(d0: Vector, d1: Vector, d2: Vector, f0: Vector, f1: Vector, f2: Vector, r: Any) -> Vector:
    """Turn from frame d to the copy of it that frame f carries from rest.

    The cosines r = d_i.f_j at rest come by rows.
    """
    return turn(
        d0,
        d1,
        d2,
        combine(r[0], f0, 1.0, combine(r[1], f1, r[2], f2)),
        combine(r[3], f0, 1.0, combine(r[4], f1, r[5], f2)),
        combine(r[6], f0, 1.0, combine(r[7], f1, r[8], f2)),
    )


@kernel
def transposed_turn(w: Vector, a: Vector) -> Vector:
    """Return a + w x a / 2 + (w.a) w / 4: its product with a spin is a . (the change of w)."""
    return add(a, combine(0.5, cross(w, a), 0.25 * dot(w, a), w))
