"""What touches at a trial point, and the sums over it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ...arrays import FloatArray, IntArray
from ..points.points import Points
from .stencils import Stencils


@dataclass(frozen=True, slots=True)
class Touching:
    """Points of contact of one kind of items.

    Attributes:
        kind: Number of the kind among those of its source.
        stencils: Nodes of its items.
        points: The points.
        friction: Coefficient at each point, shape (K,).
        moving: Gives the relative velocity at each point [m/s], shape (3, K): smooth contact never asks.
        label: Number of the pair of bodies at each point, shape (K,).
        sign: 1 where the line is of the first of that pair, else -1, shape (K,).
        lagged: Normal force that friction goes by [N], shape (K,); None for that of the points.
    """

    kind: int
    stencils: Stencils
    points: Points
    friction: FloatArray
    moving: Callable[[], FloatArray]
    label: IntArray
    sign: FloatArray
    lagged: FloatArray | None = None

    @property
    def velocity(self) -> FloatArray:
        """Relative velocity at each point [m/s], shape (3, K)."""
        return self.moving()

    @property
    def rubbing(self) -> Points:
        """The points with the normal force that friction goes by."""
        if self.lagged is None:
            return self.points
        return replace(self.points, load=self.lagged, growth=np.zeros_like(self.lagged))
