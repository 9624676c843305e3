"""Pairs and points of contact by NumPy; implements :class:`.loops.Loops`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...kernels.linearization import Pattern
from ..gather.stencils import GeneralPlaces, Stencils, SymmetricPlaces
from ..gather.touching import Touching
from ..gather.upper import Sums, finished
from ..nearby.advance import longest_way
from ..nearby.candidates import Boxes, near_among, near_boxes
from ..nearby.faces import boxes_apart, face_distances, face_pieces
from ..nearby.neighbours import distances
from ..pieces.cores import beside, facing_node
from ..pieces.pieces import Pieces
from ..pieces.surface import Faced
from ..points.points import Points, round_points
from ..points.surface_points import surface_points


@frozen
class Cut:
    """Lines cut into pieces; implements :class:`.loops.Near`.

    Attributes:
        x: The nodes [m], shape (N, 3).
        kept: Which of the pairs these are, shape (K,).
        distance: Of these [m], shape (K,).
        pieces: Of the lines of these.
        feature: What each piece faces: 0 the inside, 1 to 3 a side, 4 to 6 a corner.
    """

    x: FloatArray
    kept: IntArray
    distance: FloatArray
    pieces: Pieces
    feature: IntArray

    @property
    def bound(self) -> FloatArray:
        """The distances."""
        return self.distance

    def distances(self, which: IntArray) -> FloatArray:
        """Of some of them."""
        return self.distance[which]

    def strips(self, faced: Faced) -> tuple[Points, Points, Points]:
        """Points of contact with triangles, and with the sides and corners that these share."""
        some = np.flatnonzero(np.isin(self.pieces.item, faced.which))
        pieces = self.pieces.some(some)
        pieces = replace(pieces, item=np.searchsorted(faced.which, pieces.item))
        return surface_points(self.x, pieces, self.feature[some], faced)


@frozen
class UpperBatches:
    """Sums to upper triangles; implements :class:`.upper.Upper`.

    Attributes:
        stencils: The items.
        places: Of their entries.
    """

    stencils: Stencils
    places: SymmetricPlaces

    def add_squares(self, touching: Touching, r: FloatArray, values: FloatArray) -> None:
        """Add dE/dq and what the second derivatives have along the gaps."""
        points = touching.points
        _add_weighted(touching, points.pull * points.gap, r)
        u = self.stencils.flat(points.directions())
        self.places.add_squares(points.item, points.along, u, values)

    def add_hessians(self, touching: Touching, r: FloatArray, values: FloatArray) -> None:
        """Add dE/dq and the second derivatives."""
        points = touching.points
        _add_weighted(touching, points.pull * points.gap, r)
        self.places.add(points.item, self.stencils.local(points.hessians()), values)

    def add_symmetric(self, touching: Touching, block: FloatArray, values: FloatArray) -> None:
        """Add w_i w_j times a symmetric block of each point."""
        self.places.add(touching.points.item, _spread(touching, block), values)


class Batches:
    """Many at once."""

    def near_among(self, boxes: Boxes) -> IntArray:
        """Pairs of boxes that are nearer than both sizes."""
        return near_among(boxes)

    def near_boxes(self, first: Boxes, second: Boxes) -> IntArray:
        """Pairs of two kinds of boxes that are nearer than both sizes."""
        return near_boxes(first, second)

    def segment_distances(self, x: FloatArray, nodes: IntArray) -> FloatArray:
        """Distances of lines from segments."""
        return distances(np.ascontiguousarray(x[nodes].transpose(1, 2, 0)))

    def segment_strips(
        self, x: FloatArray, nodes: IntArray, rows: IntArray, reach: FloatArray, factor: FloatArray
    ) -> Points:
        """Points of contact of lines with segments."""
        start, end, first, second = x[nodes[rows]].transpose(1, 2, 0)
        points = round_points(beside(start, end - start, first, second), reach, factor)
        return replace(points, item=rows[points.item])

    def vertex_strips(
        self, x: FloatArray, nodes: IntArray, rows: IntArray, reach: FloatArray, factor: FloatArray
    ) -> Points:
        """Points of contact of lines with vertices."""
        start, end, vertex = x[nodes[rows]].transpose(1, 2, 0)
        points = round_points(facing_node(start, end - start, vertex), reach, factor)
        return replace(points, item=rows[points.item])

    def safe_way(
        self, x: FloatArray, way: FloatArray, nodes: IntArray, stop: FloatArray, nearest: FloatArray
    ) -> float:
        """Part of a way on which no gap of pairs falls below the least one."""
        start, ways = (np.ascontiguousarray(every[nodes].transpose(1, 2, 0)) for every in (x, way))
        apart = ways[:2, None] - ways[None, 2:]
        measured = distances if nodes.shape[1] == 4 else face_distances

        def gap_at(part: FloatArray, which: IntArray) -> FloatArray:
            return measured(start[..., which] + part * ways[..., which]) - stop[which]

        return longest_way(gap_at, np.sqrt((apart * apart).sum(axis=2)).max(axis=(0, 1)), nearest)

    def boxes_apart(self, x: FloatArray, more: FloatArray, nodes: IntArray) -> FloatArray:
        """Distances of the boxes of lines and triangles at two places of the nodes."""
        return boxes_apart(x, more, nodes)

    def look(self, x: FloatArray, nodes: IntArray, limit: FloatArray) -> Cut:
        """Lines and triangles that are nearer than a limit."""
        kept = np.flatnonzero(boxes_apart(x, x, nodes) < limit)
        pieces, feature = face_pieces(x, nodes[kept])
        distance = pieces.nearest(len(kept))
        near = distance < limit[kept]
        some = np.flatnonzero(near[pieces.item])
        pieces = pieces.some(some)
        pieces = replace(pieces, item=(np.cumsum(near) - 1)[pieces.item])
        return Cut(x, kept[near], distance[near], pieces, feature[some])

    def face_distances(self, x: FloatArray, nodes: IntArray) -> FloatArray:
        """Distances of lines from triangles."""
        return face_distances(np.ascontiguousarray(x[nodes].transpose(1, 2, 0)))

    def sums(self, stencils: Sequence[Stencils], pattern: Pattern) -> Sums:
        """Places of items of all kinds."""
        return Sums([self.symmetric_places(one, pattern) for one in stencils], finished)

    def symmetric_places(self, stencils: Stencils, pattern: Pattern) -> UpperBatches:
        """Places of the upper triangles of items."""
        return UpperBatches(stencils, SymmetricPlaces.of(stencils, pattern))

    def general_places(self, stencils: Stencils, pattern: Pattern) -> GeneralPlaces:
        """Places of the whole matrices of items."""
        return GeneralPlaces.of(stencils, pattern)

    def add_forces(self, touching: Touching, vector: FloatArray, r: FloatArray) -> None:
        """Add weights times a vector of each point."""
        _add_weighted(touching, vector, r)

    def add_general(
        self, touching: Touching, places: GeneralPlaces, block: FloatArray, values: FloatArray
    ) -> None:
        """Add w_i w_j times a block of each point."""
        places.add(touching.points.item, _spread(touching, block), values)


def _spread(touching: Touching, block: FloatArray) -> FloatArray:
    """Blocks (3, 3, K) of points as matrices of the DOFs of their items."""
    w = touching.points.weights
    return touching.stencils.local(w[:, None, None, None] * w[None, :, None, None] * block)


def _add_weighted(touching: Touching, vector: FloatArray, r: FloatArray) -> None:
    """Add weights times a vector (3, K) of each point."""
    points = touching.points
    touching.stencils.add(points.item, points.weights[:, None] * vector, r)
