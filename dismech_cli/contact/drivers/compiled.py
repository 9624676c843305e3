"""Pairs and points of contact by compiled loops; implements :class:`.loops.Loops`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...kernels.driver import Driver
from ...kernels.linearization import Pattern
from ..gather import slot_loops, sum_loops
from ..gather.packed import PackedSums
from ..gather.stencils import GeneralPlaces, Stencils
from ..gather.touching import Touching
from ..gather.upper import Sums, finished
from ..gather.upper_sums import UpperLoops, UpperSums
from ..nearby import way_loops
from ..nearby.candidates import Boxes
from ..nearby.grid import Grid
from ..pieces import face_loops, line_loops, point_loops
from ..points.filled import Loop, StripsOf
from ..points.surface_compiled import Looked, SurfaceLoops


@frozen
class Compiled:
    """One after the other."""

    segment_strips: StripsOf
    vertex_strips: StripsOf
    surface: SurfaceLoops
    grid: Grid
    upper: UpperSums
    packed: PackedSums
    distances: Loop
    ways: Loop
    to_faces: Loop
    bounds: Loop
    boxes: Loop
    weighted: Loop
    blocks: Loop
    all_slots: Loop

    @classmethod
    def of(cls, driver: Driver) -> Compiled | None:
        """The loops of a driver; None where it does not compile."""
        fill = driver.compiled(point_loops.fill_points)
        surface, grid = SurfaceLoops.of(driver), Grid.of(driver)
        upper, packed = UpperSums.of(driver), PackedSums.of(driver)
        names = (
            line_loops.segment_pieces,
            line_loops.vertex_pieces,
            line_loops.segment_distances,
            way_loops.safe_way,
            face_loops.face_distances,
            face_loops.face_bounds,
            face_loops.boxes_apart,
            sum_loops.add_weighted,
            sum_loops.add_blocks,
            slot_loops.find_all,
        )
        loops = [made for one in names if (made := driver.compiled(one)) is not None]
        if fill is None or surface is None or grid is None or upper is None or packed is None:
            return None
        segments, vertices, *others = loops
        strips = StripsOf(segments, fill, 2), StripsOf(vertices, fill, 1)
        return cls(*strips, surface, grid, upper, packed, *others)

    def near_among(self, boxes: Boxes) -> IntArray:
        """Pairs of boxes that are nearer than both sizes."""
        return self.grid.near_among(boxes)

    def near_boxes(self, first: Boxes, second: Boxes) -> IntArray:
        """Pairs of two kinds of boxes that are nearer than both sizes."""
        return self.grid.near_boxes(first, second)

    def segment_distances(self, x: FloatArray, nodes: IntArray) -> FloatArray:
        """Distances of lines from segments."""
        out = np.empty(len(nodes))
        self.distances(x, nodes, out)
        return out

    def safe_way(
        self, x: FloatArray, way: FloatArray, nodes: IntArray, stop: FloatArray, nearest: FloatArray
    ) -> float:
        """Part of a way on which no gap of pairs falls below the least one."""
        return float(self.ways(x, way, nodes, stop, nearest))

    def boxes_apart(self, x: FloatArray, more: FloatArray, nodes: IntArray) -> FloatArray:
        """Distances of the boxes of lines and triangles at two places of the nodes."""
        out = np.empty(len(nodes))
        self.boxes(x, more, nodes, out)
        return out

    def look(self, x: FloatArray, nodes: IntArray, limit: FloatArray) -> Looked:
        """Lines and triangles that are nearer than a limit."""
        bound = np.empty(len(nodes))
        self.bounds(x, nodes, limit, bound)
        kept = np.flatnonzero(np.isfinite(bound))
        return Looked(x, nodes, kept, bound[kept], self.surface, self.face_distances)

    def face_distances(self, x: FloatArray, nodes: IntArray) -> FloatArray:
        """Distances of lines from triangles."""
        out = np.empty(len(nodes))
        self.to_faces(x, nodes, np.full(len(nodes), np.inf), out)
        return out

    def sums(self, stencils: Sequence[Stencils], pattern: Pattern) -> Sums:
        """Places of items of all kinds."""
        squares = [one for one in stencils if one.squares]
        if not squares:
            return Sums([self.upper.at(one, pattern) for one in stencils], finished)
        packed = self.packed.at(squares, pattern)
        some = iter(packed.kinds)
        kinds = [next(some) if one.squares else self.upper.at(one, pattern) for one in stencils]
        return Sums(kinds, packed.spread)

    def symmetric_places(self, stencils: Stencils, pattern: Pattern) -> UpperLoops:
        """Places of the upper triangles of items."""
        return self.upper.at(stencils, pattern)

    def general_places(self, stencils: Stencils, pattern: Pattern) -> GeneralPlaces:
        """Places of the whole matrices of items."""
        count, size = stencils.dofs.shape
        slots: IntArray = np.empty((count, size * size), dtype=np.uint32)
        self.all_slots(pattern.order, pattern.indptr, pattern.indices, stencils.dofs, slots)
        return GeneralPlaces(slots)

    def add_forces(self, touching: Touching, vector: FloatArray, r: FloatArray) -> None:
        """Add weights times a vector of each point."""
        points, stencils = touching.points, touching.stencils
        self.weighted(stencils.dofs, stencils.axes, points.item, points.weights, vector, r)

    def add_general(
        self, touching: Touching, places: GeneralPlaces, block: FloatArray, values: FloatArray
    ) -> None:
        """Add w_i w_j times a block of each point."""
        points, axes = touching.points, touching.stencils.axes
        self.blocks(places.slots, axes, points.item, points.weights, block.reshape(9, -1), values)
