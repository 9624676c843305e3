"""Points of contact of lines with surfaces: triangles, less what they count too often where they meet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import FloatArray, IntArray
from .cores import beside, facing_node
from .faces import Faces
from .pieces import Pieces
from .points import Points, round_points
from .surface import Junctions, owners

# The secant is that of so much of the reach where a line passes through what it faces.
_NEAR = 1e-3


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
        line, triangle = faces.lines.nodes[pairs[:, 0]], faces.surface.nodes[pairs[:, 1]]
        junctions = Junctions.of(pairs[:, 0], line, triangle)
        return cls(faces, keys, pairs, np.concatenate((line, triangle), axis=1), junctions)

    def points(
        self, x: FloatArray, rows: IntArray, pieces: Pieces, reach: FloatArray, factor: FloatArray
    ) -> Iterator[tuple[int, Points, IntArray]]:
        """Points of contact by kind: with triangles, sides and corners; and a pair that each belongs to.

        Args:
            x: Nodes [m], shape (N, 3).
            rows: Pairs within reach, ascending, shape (K,).
            pieces: Of these, item k that of row k.
            reach: Of these [m], shape (K,).
            factor: Stiffness times rest length of these [N/m], shape (K,).
        """
        if not len(rows):
            return
        points = round_points(pieces, reach, factor)
        points = _stiff(points, reach[points.item])
        item = rows[points.item]
        yield 0, replace(points, item=item), item
        full_reach, full_factor = np.zeros((2, len(self.keys)))
        full_reach[rows], full_factor[rows] = reach, factor
        j = self.junctions
        side_weight, corner_weight = j.coefficients(rows)
        side = np.flatnonzero(side_weight)
        owner = owners(j.sides_of, rows, len(j.sides))
        if len(side):
            start, end, first, second = _gathered(x, j.sides[side])
            own = owner[side]
            points = round_points(
                beside(start, end - start, first, second),
                full_reach[own],
                side_weight[side] * full_factor[own],
            )
            item = side[points.item]
            points = _stiff(points, full_reach[owner[item]])
            yield 1, replace(points, item=item), owner[item]
        corner = np.flatnonzero(corner_weight)
        owner = owners(j.corners_of, rows, len(j.corners))
        if len(corner):
            start, end, vertex = _gathered(x, j.corners[corner])
            own = owner[corner]
            points = round_points(
                facing_node(start, end - start, vertex),
                full_reach[own],
                corner_weight[corner] * full_factor[own],
            )
            item = corner[points.item]
            points = _stiff(points, full_reach[owner[item]])
            yield 2, replace(points, item=item), owner[item]


def _gathered(x: FloatArray, nodes: IntArray) -> FloatArray:
    """Places of nodes (K, n) [m], shape (n, 3, K)."""
    return np.ascontiguousarray(x[nodes].transpose(1, 2, 0))


def _stiff(points: Points, reach: FloatArray) -> Points:
    """The same with the stiffness of the secant from where nothing touches, reach [m] of each point.

    From deep inside a tangent overshoots to where nothing touches, and Newton's method goes to and fro.
    Curvature across the gap is left out: what is taken off again would make matrices indefinite (Gauss and
    Newton).
    """
    distance = np.maximum(np.sqrt((points.gap * points.gap).sum(axis=0)), _NEAR * reach)
    along = points.along * 0.5 * (reach + distance) / distance
    return replace(points, along=along, bend=np.zeros_like(points.bend))
