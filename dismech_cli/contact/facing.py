"""Points of contact of lines with surfaces: triangles, less what they count too often where they meet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import FloatArray, IntArray
from .faces import Faces
from .loops import Near
from .points import Points
from .surface import Faced, Junctions, owners

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
        nodes = faces.nodes(pairs)
        junctions = Junctions.of(pairs[:, 0], nodes[:, :2], nodes[:, 2:])
        return cls(faces, keys, pairs, nodes, junctions)

    def points(
        self, near: Near, which: IntArray, rows: IntArray, reach: FloatArray, factor: FloatArray
    ) -> Iterator[tuple[int, Points, IntArray]]:
        """Points of contact by kind: with triangles, sides and corners; and a pair that each belongs to.

        Args:
            near: Lines and triangles that were measured.
            which: Those of them within reach, shape (K,).
            rows: Where these pairs are among all, ascending, shape (K,).
            reach: Of these [m], shape (K,).
            factor: Stiffness times rest length of these [N/m], shape (K,).
        """
        if not len(rows):
            return
        j = self.junctions
        side_times, corner_times = j.coefficients(rows)
        side_owner, corner_owner = (
            owners(j.sides_of, rows, len(j.sides)),
            owners(j.corners_of, rows, len(j.corners)),
        )
        faced = Faced(
            which, rows, self.nodes, reach, factor, j, side_times, corner_times, side_owner, corner_owner
        )
        own = np.arange(len(self.keys))
        for kind, (points, of) in enumerate(
            zip(near.points(faced), (own, side_owner, corner_owner), strict=True)
        ):
            owner = of[points.item]
            yield kind, _stiff(points, faced.owned(owner)[0]), owner


def _stiff(points: Points, reach: FloatArray) -> Points:
    """The same with the stiffness of the secant from where nothing touches, reach [m] of each point.

    From deep inside a tangent overshoots to where nothing touches, and Newton's method goes to and fro.
    Curvature across the gap is left out: what is taken off again would make matrices indefinite (Gauss and
    Newton).
    """
    distance = np.maximum(np.sqrt((points.gap * points.gap).sum(axis=0)), _NEAR * reach)
    along = points.along * 0.5 * (reach + distance) / distance
    return replace(points, along=along, bend=np.zeros_like(points.bend))
