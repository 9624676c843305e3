"""Points of contact that compiled loops find, in buffers that are kept."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np

from ...arrays import FloatArray, IntArray
from ..pieces import line_loops, point_loops
from .points import Points
from .strips import Strips, Table

Loop: TypeAlias = Callable[..., Any]
"""A compiled loop."""


class Filler:
    """Points on pieces, in a buffer that is kept."""

    def __init__(self, fill: Loop, faced: int, slopes: int) -> None:
        """Begin with no buffer.

        Args:
            fill: See :func:`.point_loops.fill_points`.
            faced: Nodes that are faced.
            slopes: Nodes whose weights have slopes: all, or none where curvature is left out and stiffness is
                that of the secant.
        """
        self._fill, self._faced, self._slopes = fill, faced, slopes
        self._numbers = np.empty(0)

    @property
    def curved(self) -> bool:
        """Whether weights have slopes."""
        return self._slopes > 0

    def __call__(self, table: Table) -> Points:
        """See :func:`.point_loops.fill_points`."""
        count, n = 3 * len(table.piece_item), 2 + self._faced
        scalars = len(point_loops.SCALARS)
        height = scalars + 9 + n + 3 * self._slopes
        if height * count > len(self._numbers):
            self._numbers = np.empty(2 * height * count)
        every = self._numbers[: height * count].reshape(height, count)
        numbers, vectors = every[:scalars], every[scalars : scalars + 9].reshape(3, 3, count)
        weights = every[scalars + 9 : scalars + 9 + n]
        spread = every[scalars + 9 + n :].reshape(self._slopes, 3, count)
        item = np.empty(count, dtype=np.int64)
        t = table
        self._fill(
            *(t.rows, t.piece_item, t.pieces, t.reach, t.factor, item, numbers, vectors, weights, spread)
        )
        s, energy, pull, along, load, growth, identity, axis, turn = numbers
        gap, normal, e = vectors
        return Points(
            item=item,
            s=s,
            weights=weights,
            spread=spread if self._slopes else np.broadcast_to(0.0, (n, 3, count)),
            gap=gap,
            normal=normal,
            energy=energy,
            pull=pull,
            along=along,
            bend=pull if self._slopes else np.broadcast_to(0.0, count),
            load=load,
            growth=growth,
            identity=identity,
            axis=axis,
            e=e,
            turn=turn,
        )


class Laid:
    """Pieces in a table, and points on them once they are asked for; implements :class:`.strips.Strips`.

    Both are in buffers that are kept: they are good until their maker lays others.
    """

    def __init__(self, table: Table, filler: Filler) -> None:
        self.table, self._filler = table, filler
        self._points: Points | None = None

    @property
    def points(self) -> Points:
        """The points."""
        if self._points is None:
            self._points = self._filler(self.table)
        return self._points

    @property
    def curved(self) -> bool:
        """Whether their stiffness is more than that along the gaps."""
        return self._filler.curved


class StripsOf:
    """Parts of lines that touch one kind of feature."""

    def __init__(self, pieces: Loop, fill: Loop, faced: int) -> None:
        self._pieces, self._fill = pieces, Filler(fill, faced, 2 + faced)
        self._item = np.empty(0, dtype=np.int64)
        self._table = np.empty((0, line_loops.spread_columns(faced)))

    def __call__(
        self, x: FloatArray, nodes: IntArray, rows: IntArray, reach: FloatArray, factor: FloatArray
    ) -> Strips:
        """See :meth:`.loops.Loops.segment_strips`."""
        found = self._pieces(x, nodes, rows, reach, self._item, self._table)
        if found > len(self._item):
            self._item = np.empty(2 * found, dtype=np.int64)
            self._table = np.empty((2 * found, self._table.shape[1]))
            self._pieces(x, nodes, rows, reach, self._item, self._table)
        return Laid(Table(rows, self._item[:found], self._table[:found], reach, factor), self._fill)
