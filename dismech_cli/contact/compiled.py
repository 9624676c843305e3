"""Pairs and points of contact by compiled loops; implements :class:`.loops.Loops`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from ..arrays import FloatArray, IntArray
from ..kernels.driver import Driver
from ..kernels.linearization import Pattern
from . import face_loops, line_loops, point_loops, slot_loops, sum_loops
from .points import Points
from .stencils import GeneralPlaces, Stencils, SymmetricPlaces
from .touching import Touching

_Loop: TypeAlias = Callable[..., Any]


class _PointsOf:
    """Points of contact of lines with one kind of feature, in buffers that are kept."""

    def __init__(self, pieces: _Loop, fill: _Loop, faced: int) -> None:
        self._pieces, self._fill, self._faced = pieces, fill, faced
        self._item = np.empty(0, dtype=np.int64)
        self._table = np.empty((0, line_loops.piece_columns(faced)))
        self._numbers = np.empty(0)

    def __call__(
        self, x: FloatArray, nodes: IntArray, rows: IntArray, reach: FloatArray, factor: FloatArray
    ) -> Points:
        """See :meth:`.loops.Loops.segment_points`."""
        found = self._pieces(x, nodes, rows, reach, self._item, self._table)
        if found > len(self._item):
            self._item = np.empty(2 * found, dtype=np.int64)
            self._table = np.empty((2 * found, self._table.shape[1]))
            self._pieces(x, nodes, rows, reach, self._item, self._table)
        return self._filled(found, rows, reach, factor)

    def _filled(self, pieces: int, rows: IntArray, reach: FloatArray, factor: FloatArray) -> Points:
        count, n = 3 * pieces, 2 + self._faced
        scalars = len(point_loops.SCALARS)
        sizes = np.cumsum([scalars, 9, n, 3 * n]) * count
        if sizes[-1] > len(self._numbers):
            self._numbers = np.empty(2 * sizes[-1])
        numbers, vectors, weights, spread = np.split(self._numbers[: sizes[-1]], sizes[:-1])
        numbers, vectors = numbers.reshape(scalars, count), vectors.reshape(3, 3, count)
        weights, spread = weights.reshape(n, count), spread.reshape(n, 3, count)
        item = np.empty(count, dtype=np.int64)
        self._fill(rows, self._item, self._table, reach, factor, item, numbers, vectors, weights, spread)
        s, energy, pull, along, load, growth, identity, axis, turn = numbers
        gap, normal, e = vectors
        return Points(
            item=item,
            s=s,
            weights=weights,
            spread=spread,
            gap=gap,
            normal=normal,
            energy=energy,
            pull=pull,
            along=along,
            bend=pull,
            load=load,
            growth=growth,
            identity=identity,
            axis=axis,
            e=e,
            turn=turn,
        )


@dataclass(frozen=True, slots=True)
class Measured:
    """Lines and triangles whose distance is known; implements :class:`.loops.Near`.

    Attributes:
        x: The nodes [m], shape (N, 3).
        kept: Which of the pairs these are, shape (K,).
        distance: Of these [m], shape (K,).
        find: Finds their points of contact.
    """

    x: FloatArray
    kept: IntArray
    distance: FloatArray
    find: _PointsOf

    def points(
        self, which: IntArray, nodes: IntArray, rows: IntArray, reach: FloatArray, factor: FloatArray
    ) -> Points:
        """Points of contact of some of them."""
        return self.find(self.x, nodes, rows, reach, factor)


@dataclass(frozen=True, slots=True)
class Compiled:
    """One after the other."""

    segment_points: _PointsOf
    vertex_points: _PointsOf
    face_points: _PointsOf
    distances: _Loop
    to_faces: _Loop
    boxes: _Loop
    weighted: _Loop
    squares: _Loop
    hessians: _Loop
    upper_blocks: _Loop
    blocks: _Loop
    upper_slots: _Loop
    all_slots: _Loop

    @classmethod
    def of(cls, driver: Driver) -> Compiled | None:
        """The loops of a driver; None where it does not compile."""
        fill = driver.compiled(point_loops.fill_points)
        names = (
            line_loops.segment_pieces,
            line_loops.vertex_pieces,
            face_loops.face_pieces,
            line_loops.segment_distances,
            face_loops.face_distances,
            face_loops.boxes_apart,
            sum_loops.add_weighted,
            sum_loops.add_squares,
            sum_loops.add_hessians,
            sum_loops.add_upper_blocks,
            sum_loops.add_blocks,
            slot_loops.find_upper,
            slot_loops.find_all,
        )
        loops = [made for one in names if (made := driver.compiled(one)) is not None]
        if fill is None or len(loops) < len(names):
            return None
        segments, vertices, faces, *others = loops
        return cls(
            _PointsOf(segments, fill, 2), _PointsOf(vertices, fill, 1), _PointsOf(faces, fill, 3), *others
        )

    def segment_distances(self, x: FloatArray, nodes: IntArray) -> FloatArray:
        """Distances of lines from segments."""
        out = np.empty(len(nodes))
        self.distances(x, nodes, out)
        return out

    def boxes_apart(self, x: FloatArray, more: FloatArray, nodes: IntArray) -> FloatArray:
        """Distances of the boxes of lines and triangles at two places of the nodes."""
        out = np.empty(len(nodes))
        self.boxes(x, more, nodes, out)
        return out

    def look(self, x: FloatArray, nodes: IntArray, limit: FloatArray) -> Measured:
        """Lines and triangles that are nearer than a limit, by their boxes at least."""
        out = np.empty(len(nodes))
        self.to_faces(x, nodes, limit, out)
        kept = np.flatnonzero(np.isfinite(out))
        return Measured(x, kept, out[kept], self.face_points)

    def face_distances(self, x: FloatArray, nodes: IntArray) -> FloatArray:
        """Distances of lines from triangles."""
        out = np.empty(len(nodes))
        self.to_faces(x, nodes, np.full(len(nodes), np.inf), out)
        return out

    def symmetric_places(self, stencils: Stencils, pattern: Pattern) -> SymmetricPlaces:
        """Places of the upper triangles of items."""
        i, j = np.triu_indices(stencils.dofs.shape[1])
        return SymmetricPlaces(self._slots(self.upper_slots, len(i), stencils, pattern), i, j)

    def general_places(self, stencils: Stencils, pattern: Pattern) -> GeneralPlaces:
        """Places of the whole matrices of items."""
        return GeneralPlaces(self._slots(self.all_slots, stencils.dofs.shape[1] ** 2, stencils, pattern))

    def _slots(self, find: _Loop, entries: int, stencils: Stencils, pattern: Pattern) -> IntArray:
        slots: IntArray = np.empty((len(stencils.dofs), entries), dtype=np.uint32)
        find(pattern.order, pattern.indptr, pattern.indices, stencils.dofs, slots)
        return slots

    def add_forces(self, touching: Touching, vector: FloatArray, r: FloatArray) -> None:
        """Add weights times a vector of each point."""
        points, stencils = touching.points, touching.stencils
        self.weighted(stencils.dofs, stencils.axes, points.item, points.weights, vector, r)

    def add_squares(self, touching: Touching, places: SymmetricPlaces, values: FloatArray) -> None:
        """Add what the second derivatives have along the gaps."""
        points, axes = touching.points, touching.stencils.axes
        self.squares(places.slots, axes, points.item, points.weights, points.gap, points.along, values)

    def add_hessians(self, touching: Touching, places: SymmetricPlaces, values: FloatArray) -> None:
        """Add the second derivatives."""
        p = touching.points
        self.hessians(
            places.slots,
            touching.stencils.axes,
            p.item,
            p.weights,
            p.spread,
            p.gap,
            p.e,
            p.along,
            p.bend,
            p.identity,
            p.axis,
            values,
        )

    def add_symmetric(
        self, touching: Touching, places: SymmetricPlaces, block: FloatArray, values: FloatArray
    ) -> None:
        """Add w_i w_j times a symmetric block of each point."""
        self._add(self.upper_blocks, touching, places.slots, block, values)

    def add_general(
        self, touching: Touching, places: GeneralPlaces, block: FloatArray, values: FloatArray
    ) -> None:
        """Add w_i w_j times a block of each point."""
        self._add(self.blocks, touching, places.slots, block, values)

    def _add(
        self, loop: _Loop, touching: Touching, slots: IntArray, block: FloatArray, values: FloatArray
    ) -> None:
        points = touching.points
        flat = block.reshape(9, -1)
        loop(slots, touching.stencils.axes, points.item, points.weights, flat, values)
