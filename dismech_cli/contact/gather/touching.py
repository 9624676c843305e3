"""What touches at a trial point, and the sums over it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ..law.between import Between
from ..points.points import Points
from ..points.strips import Strips
from .stencils import Stencils

Remake: TypeAlias = Callable[[FloatArray, FloatArray], tuple[Points, FloatArray]]
"""Points of R items that share no nodes, and relative velocities there (3, K), from the places and
velocities of their nodes, each of shape (R, n, 3)."""

Again: TypeAlias = Callable[[IntArray], Remake]
"""Makes that of some items, which it numbers anew."""


def at_points(points: Points, values: FloatArray) -> FloatArray:
    """Vectors of the nodes of items (R, n, 3) as those of the lines against what they face, shape (3, K)."""
    nodal = values[points.item].transpose(1, 2, 0)
    out: FloatArray = (points.weights[:, None] * nodal).sum(axis=0)
    return out


@frozen
class Touching:
    """What touches of one kind of items.

    Attributes:
        kind: Number of the kind among those of its source.
        stencils: Nodes of its items.
        strips: Parts of lines that touch, with points of contact on them.
        between: What the bodies of the items are to each other.
        moving: Gives the relative velocity at each point [m/s], shape (3, K): smooth contact never asks.
        lagged: Normal force that friction goes by [N], shape (K,); None for that of the points.
        again: Finds the points of some items at other places; None where nothing asks for that.
    """

    kind: int
    stencils: Stencils
    strips: Strips
    between: Between
    moving: Callable[[], FloatArray]
    lagged: FloatArray | None = None
    again: Again | None = None

    @property
    def points(self) -> Points:
        """The points of contact."""
        return self.strips.points

    @property
    def friction(self) -> FloatArray:
        """Coefficient at each point, shape (K,)."""
        return self.between.friction[self.points.item]

    @property
    def label(self) -> IntArray:
        """Number of the pair of bodies at each point, shape (K,)."""
        return self.between.labels[self.points.item]

    @property
    def sign(self) -> FloatArray:
        """1 where the line is of the first of that pair, else -1, shape (K,)."""
        return self.between.signs[self.points.item]

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
