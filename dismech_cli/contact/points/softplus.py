"""The family's law of pairs: a force that sets in softly, over a width about where things touch.

With g the distance beyond that one, d the width and K = 15 / d, the energy of a pair is k L^2,
L = log(1 + exp(-K g)) / K: deep inside it is k g^2, and beyond the width it is nothing to sixteen digits.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...geometry.kernel import kernel
from .barrier import Closest, radial_points
from .points import Points

_SHARPNESS: Final = 15.0


@kernel
def softplus(gap: Any, sharpness: Any, stiffness: Any) -> Any:
    """Energy, slope and curvature of a pair.

    Args:
        gap: g, distance beyond the one at which things touch [m].
        sharpness: K [1/m].
        stiffness: k [N/m].
    """
    x = -sharpness * gap
    small = np.exp(-np.abs(x))
    soft = (np.maximum(x, 0.0) + np.log1p(small)) / sharpness
    share = np.where(x > 0.0, 1.0, small) / (1.0 + small)
    return (
        stiffness * soft * soft,
        -2.0 * stiffness * soft * share,
        2.0 * stiffness * (share * share + sharpness * soft * share * (1.0 - share)),
    )


@frozen
class Softplus:
    """The law of a scene.

    Attributes:
        stiffness: k of each pair [N/m].
        width: d [m].
    """

    stiffness: float
    width: float

    def __call__(self, gap: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Energy, slope and curvature at gaps (K,) [m]."""
        energy, slope, curvature = softplus(gap, _SHARPNESS / self.width, self.stiffness)
        return energy, slope, curvature


def pair_points(at: Closest, touch: FloatArray, law: Softplus) -> Points:
    """Points of contact of pairs.

    Args:
        at: Closest points.
        touch: Distance at which they touch [m], shape (K,).
        law: The law.
    """
    distance = np.maximum(at.distance, np.finfo(float).tiny)
    return radial_points(at, distance, *law(distance - touch))


def floor_points(
    item: IntArray, height: FloatArray, ends: FloatArray, normal: FloatArray, law: Softplus
) -> Points:
    """Points of contact of nodes with a plane.

    Args:
        item: Number of each, shape (K,).
        height: Of the surfaces above it [m], shape (K,).
        ends: Weights of the two ends of a line of each, shape (2, K).
        normal: Of the plane, shape (3,).
        law: The law.
    """
    energy, slope, curvature = law(height)
    count = len(height)
    n, zero = np.broadcast_to(normal[:, None], (3, count)), np.zeros(count)
    nothing = np.zeros((2, 3, count))
    return Points(
        item=item,
        s=ends[1],
        weights=ends,
        spread=nothing,
        gap=n,
        normal=n,
        energy=energy,
        pull=slope,
        along=curvature,
        bend=zero,
        load=-slope,
        growth=-curvature,
        identity=zero,
        axis=zero,
        e=nothing[0],
        turn=zero,
    )
