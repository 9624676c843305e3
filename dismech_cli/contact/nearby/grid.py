"""Pairs of boxes near each other on a uniform grid, by compiled loops."""

from __future__ import annotations

from typing import Final

import numpy as np

from ...arrays import IntArray
from ...frozen import frozen
from ...kernels.driver import Driver
from ..points.filled import Loop
from . import grid_loops
from .candidates import Boxes

# Cells grow until boxes lie in so many on the average at most: a few large ones among many small.
_CELLS: Final = 8
# Room for so many pairs per box at first.
_PAIRS: Final = 8


@frozen
class Grid:
    """A grid whose cells are as large as boxes mostly are; see :mod:`.grid_loops`."""

    count: Loop
    fill: Loop
    near: Loop

    @classmethod
    def of(cls, driver: Driver) -> Grid | None:
        """The loops of a driver; None where it does not compile."""
        names = (grid_loops.count_cells, grid_loops.fill_cells, grid_loops.near_boxes)
        loops: list[Loop] = [made for one in names if (made := driver.compiled(one)) is not None]
        return cls(*loops) if len(loops) == len(names) else None

    def near_among(self, boxes: Boxes) -> IntArray:
        """Pairs of boxes that are nearer than both sizes."""
        return self._pairs(boxes, boxes, 1)

    def near_boxes(self, first: Boxes, second: Boxes) -> IntArray:
        """Pairs of two kinds of boxes that are nearer than both sizes."""
        return self._pairs(first, second, 0)

    def _pairs(self, first: Boxes, second: Boxes, above: int) -> IntArray:
        """Pairs of boxes; with those of higher number only if ``above`` is 1."""
        if not len(first.low) or not len(second.low):
            return np.empty((0, 2), dtype=np.int64)
        ones, others = (first.low, first.high, first.sizes), (second.low, second.high, second.sizes)
        extent = (second.high - second.low).max(axis=1) + 2.0 * second.sizes
        # no smaller than 21 bits of places let it be
        whole = max(float(np.abs(edge).max()) for edge in (*ones[:2], *others[:2]))
        cell = max(float(np.median(extent)), 1e-5 * whole)
        while self.count(*ones, cell) > _CELLS * len(first.low):
            cell *= 2.0
        while (entries := self.count(*others, cell)) > _CELLS * len(second.low):
            cell *= 2.0
        begin = np.zeros((1 << int(entries).bit_length()) + 1, dtype=np.int64)
        boxes, cells = np.empty((2, entries), dtype=np.int64)
        self.fill(*others, cell, begin, boxes, cells)
        pairs = np.empty((_PAIRS * len(first.low), 2), dtype=np.int64)
        asked = (*ones, *others, above, cell, begin, boxes, cells)
        found = self.near(*asked, pairs)
        if found > len(pairs):
            pairs = np.empty((found, 2), dtype=np.int64)
            self.near(*asked, pairs)
        return pairs[:found]
