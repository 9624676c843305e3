"""Where a line is within reach of a feature, and the points at which its energy is summed there.

On a piece of a line that faces one feature the gap vector is linear along the line, x(s) = x0 + s x1. So
|x|^2 - H^2 is a parabola whose roots bound the part within reach H, and the energy density (H^2 - |x|^2)^2
is a polynomial of degree four there, which three Gauss points integrate exactly.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from ...geometry.kernel import kernel
from ...geometry.vectors import where

_ROOT: Final = 0.6**0.5
GAUSS: Final = ((-_ROOT, 5.0 / 18.0), (0.0, 8.0 / 18.0), (_ROOT, 5.0 / 18.0))
"""Places on [-1, 1] and shares of the length."""

# A line that keeps its distance to 1e-12 has roots so far away.
_FLAT: Final = 1e-24
_TINY: Final = 1e-300
# The secant is that of so much of the reach where a line passes through what it faces.
_NEAR: Final = 1e-3
_TINIEST: Final = float(np.finfo(float).tiny)


@kernel
def within(a: Any, b: Any, c: Any, low: Any, high: Any) -> Any:
    """The part of [low, high] where a s^2 + 2 b s + c < 0, a >= 0; empty (high <= low) if there is none.

    The roots are taken in the form that does not cancel, and a line that keeps its distance (a = 0) is
    one whose roots are far away.
    """
    a = a + _FLAT * np.abs(c)
    square = b * b - a * c
    root = np.sqrt(np.maximum(square, 0.0))
    twice = -(b + np.copysign(root, b))
    one, other = twice / (a + _TINY), c / (twice + np.copysign(_TINY, twice))
    first, last = np.minimum(one, other), np.maximum(one, other)
    start, end = np.maximum(first, low), np.minimum(last, high)
    return start, where(square > 0.0, end, start)


@kernel
def passing(t0: Any, t1: Any) -> Any:
    """The part [early, late] of a line that runs beside a segment, at t0 + s t1 along it, cut at 0 and 1."""
    at_first = where(t1 == 0.0, where(t0 > 0.0, -np.inf, np.inf), -t0 / t1)
    at_second = where(t1 == 0.0, where(t0 > 1.0, -np.inf, np.inf), (1.0 - t0) / t1)
    early = np.minimum(np.maximum(np.minimum(at_first, at_second), 0.0), 1.0)
    late = np.minimum(np.maximum(np.maximum(at_first, at_second), 0.0), 1.0)
    # a line that runs across all along faces the one feature from start to end
    return where((t1 == 0.0) & (t0 >= 0.0) & (t0 <= 1.0), 0.0, early), late


@kernel
def density(square: Any, h: Any, factor: Any) -> Any:
    """The sum of factor (H^2 - |x|^2)^2 / (4 H^2) at one point, with its slopes.

    Args:
        square: |x|^2 [m^2].
        h: H [m].
        factor: Stiffness times rest length times share of it [N/m].

    Returns:
        Energy [J], pull, stiffness along the gap, load [N], its growth along the gap [N/m], 1 / |x| [1/m];
        see :class:`.points.Points`.
    """
    depth = np.maximum(h * h - square, 0.0)
    f = factor / (4.0 * h * h)
    distance = np.sqrt(square) + _TINIEST
    pull = -4.0 * f * depth
    return (
        f * depth * depth,
        pull,
        8.0 * f,
        -pull * distance,
        4.0 * f * (depth - 2.0 * square),
        1.0 / distance,
    )


@kernel
def secant(along: Any, square: Any, h: Any) -> Any:
    """Stiffness along the gap of the secant from where nothing touches; see :mod:`.secant`.

    Args:
        along: That of the tangent.
        square: |x|^2 [m^2].
        h: H [m].
    """
    distance = np.maximum(np.sqrt(square), _NEAR * h)
    return along * 0.5 * (h + distance) / distance


@kernel
def second_derivative(
    along: Any, bend: Any, w: Any, u: Any, both: Any, g: Any, k: Any, x: Any, y: Any, shape: Any
) -> Any:
    """Entry of the second derivative of the energy of a point to component a of node i and b of node j.

    Args:
        along: Stiffness along the gap.
        bend: Factor of the second derivative of half the squared gap.
        w: Weight of node i.
        u: Weight of node j.
        both: G_i . G_j of the slopes of the weights.
        g: Component b of G_i.
        k: Component a of G_j.
        x: Component a of the gap.
        y: Component b of the gap.
        shape: Entry a, b of Q; see :mod:`.points`.
    """
    level = (along * (w * u) - bend * both) * (x * y) + (bend * (w * u)) * shape
    return level - (bend * w) * k * y - (bend * u) * g * x
