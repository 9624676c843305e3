"""Points of contact of lines with surfaces: triangles, less what they count too often where they meet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import FloatArray, IntArray
from .faces import Faces
from .loops import Loops, Near
from .points import Points
from .surface import Junctions, owners

# The secant is that of so much of the reach where a line passes through what it faces.
_NEAR = 1e-3


@dataclass(frozen=True, slots=True)
class Rows:
    """Pairs within reach.

    Attributes:
        rows: Which of those that may face each other, ascending, shape (K,).
        which: Which of those that were measured, shape (K,).
        reach: Of these [m], shape (K,).
    """

    rows: IntArray
    which: IntArray
    reach: FloatArray


@dataclass(frozen=True, slots=True)
class Facing:
    """Lines and the triangles that they may face, with the junctions of these.

    Attributes:
        faces: Who may touch.
        keys: Of the pairs, ascending, shape (P,).
        pairs: Line and triangle, shape (P, 2).
        nodes: Of line and triangle, shape (P, 5).
        junctions: Sides and corners that are shared.
    """

    faces: Faces
    keys: IntArray
    pairs: IntArray
    nodes: IntArray
    junctions: Junctions

    @classmethod
    def of(cls, faces: Faces, keys: IntArray) -> Facing:
        """Of some pairs."""
        pairs = faces.pairs(keys)
        nodes = faces.nodes(pairs)
        junctions = Junctions.of(pairs[:, 0], nodes[:, :2], nodes[:, 2:])
        return cls(faces, keys, pairs, nodes, junctions)

    def points(
        self, loops: Loops, x: FloatArray, near: Near, at: Rows, factor: FloatArray
    ) -> Iterator[tuple[int, Points, IntArray]]:
        """Points of contact by kind: with triangles, sides and corners; and a pair that each belongs to.

        Args:
            loops: What finds points.
            x: Nodes [m], shape (N, 3).
            near: Lines and triangles that were measured there.
            at: Those within reach, K of them.
            factor: Stiffness times rest length of these [N/m], shape (K,).
        """
        rows, reach = at.rows, at.reach
        if not len(rows):
            return
        points = near.points(at.which, self.nodes, rows, reach, factor)
        full_reach, full_factor = np.zeros((2, len(self.keys)))
        full_reach[rows], full_factor[rows] = reach, factor
        yield 0, _stiff(points, full_reach[points.item]), points.item
        j = self.junctions
        side_weight, corner_weight = j.coefficients(rows)
        side = np.flatnonzero(side_weight)
        owner = owners(j.sides_of, rows, len(j.sides))
        if len(side):
            own = owner[side]
            scale = side_weight[side] * full_factor[own]
            points = loops.segment_points(x, j.sides, side, full_reach[own], scale)
            of = owner[points.item]
            yield 1, _stiff(points, full_reach[of]), of
        corner = np.flatnonzero(corner_weight)
        owner = owners(j.corners_of, rows, len(j.corners))
        if len(corner):
            own = owner[corner]
            scale = corner_weight[corner] * full_factor[own]
            points = loops.vertex_points(x, j.corners, corner, full_reach[own], scale)
            of = owner[points.item]
            yield 2, _stiff(points, full_reach[of]), of


def _stiff(points: Points, reach: FloatArray) -> Points:
    """The same with the stiffness of the secant from where nothing touches, reach [m] of each point.

    From deep inside a tangent overshoots to where nothing touches, and Newton's method goes to and fro.
    Curvature across the gap is left out: what is taken off again would make matrices indefinite (Gauss and
    Newton).
    """
    distance = np.maximum(np.sqrt((points.gap * points.gap).sum(axis=0)), _NEAR * reach)
    along = points.along * 0.5 * (reach + distance) / distance
    return replace(points, along=along, bend=np.zeros_like(points.bend))
