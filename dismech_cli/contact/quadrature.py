"""Where a line is within reach of a feature, and the points at which its energy is summed there.

On a piece of a line that faces one feature the gap vector is linear along the line, x(s) = x0 + s x1. So
|x|^2 - H^2 is a parabola whose roots bound the part within reach H, and the energy density (H^2 - |x|^2)^2
is a polynomial of degree four there, which three Gauss points integrate exactly.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from ..geometry.kernel import kernel

_ROOT: Final = 0.6**0.5
GAUSS: Final = ((-_ROOT, 5.0 / 18.0), (0.0, 8.0 / 18.0), (_ROOT, 5.0 / 18.0))
"""Places on [-1, 1] and shares of the length."""

# A line that keeps its distance to 1e-12 has roots so far away.
_FLAT: Final = 1e-24
_TINY: Final = 1e-300


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
    return start, np.where(square > 0.0, end, start)
