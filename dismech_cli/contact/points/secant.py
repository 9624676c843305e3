"""Stiffness of points of contact with surfaces: that of the secant."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...arrays import FloatArray
from ..law.quadrature import secant
from .points import Points


def with_secant(points: Points, reach: FloatArray) -> Points:
    """The same with the stiffness of the secant from where nothing touches, reach [m] of each point.

    From deep inside a tangent overshoots to where nothing touches, and Newton's method goes to and fro.
    Curvature across the gap is left out: what is taken off again would make matrices indefinite (Gauss and
    Newton).
    """
    square = (points.gap * points.gap).sum(axis=0)
    along = secant(points.along, square, reach)
    return replace(points, along=along, bend=np.zeros_like(points.bend))
