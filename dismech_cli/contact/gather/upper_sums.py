"""Sums over points of contact to upper triangles, by compiled loops."""

from __future__ import annotations

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ...frozen import frozen
from ...kernels.driver import Driver
from ...kernels.linearization import Pattern
from ..points.filled import Loop
from ..points.points import Points
from . import piece_sums, slot_loops, sum_loops
from .stencils import BlockPlaces, Stencils
from .touching import Touching


@frozen
class UpperSums:
    """The loops; see :mod:`.sum_loops` and :mod:`.slot_loops`."""

    squares: Loop
    hessians: Loop
    piece_hessians: Loop
    blocks: Loop
    find_blocks: Loop
    find_upper: Loop

    @classmethod
    def of(cls, driver: Driver) -> UpperSums | None:
        """The loops of a driver; None where it does not compile."""
        names = (
            sum_loops.add_squares,
            sum_loops.add_hessians,
            piece_sums.sum_hessians,
            sum_loops.add_upper_blocks,
            slot_loops.find_blocks,
            slot_loops.find_upper,
        )
        loops: list[Loop] = [made for one in names if (made := driver.compiled(one)) is not None]
        return cls(*loops) if len(loops) == len(names) else None

    def at(self, stencils: Stencils, pattern: Pattern) -> UpperLoops:
        """Where the items of a kind have their places."""
        count, n = stencils.nodes.shape
        d, p, pairs = len(stencils.axes), pattern, n * (n + 1) // 2
        slots: IntArray = np.empty((count, pairs * d), dtype=np.uint32)
        flipped: BoolArray = np.empty((count, pairs), dtype=np.bool_)
        odd = np.empty(count, dtype=np.int64)
        found = self.find_blocks(p.order, p.indptr, p.indices, d, stencils.dofs, slots, flipped, odd)
        entries: IntArray = np.empty((found, n * d * (n * d + 1) // 2), dtype=np.uint32)
        if found:
            self.find_upper(p.order, p.indptr, p.indices, d, stencils.dofs[odd >= 0], entries)
        return UpperLoops(self, stencils, BlockPlaces(slots, flipped, odd, entries))


@frozen
class UpperLoops:
    """Sums to the places of a kind of items; implements :class:`.upper.Upper`.

    Attributes:
        loops: What sums.
        stencils: The items.
        places: Of their blocks.
    """

    loops: UpperSums
    stencils: Stencils
    places: BlockPlaces

    def add_squares(self, touching: Touching, r: FloatArray, values: FloatArray) -> None:
        """Add dE/dq and what the second derivatives have along the gaps."""
        self._add(self.loops.squares, touching.points, (), r, values)

    def add_hessians(self, touching: Touching, r: FloatArray, values: FloatArray) -> None:
        """Add dE/dq and the second derivatives."""
        table = touching.strips.table
        if table is not None:
            t = table
            strips = (t.rows, t.piece_item, t.pieces, t.reach, t.factor)
            self.loops.piece_hessians(*self._places, *strips, r, values)
            return
        p = touching.points
        self._add(self.loops.hessians, p, (p.identity, p.spread, p.bend), r, values)

    def add_symmetric(self, touching: Touching, block: FloatArray, values: FloatArray) -> None:
        """Add w_i w_j times a symmetric block of each point."""
        p, at = touching.points, self.places
        flat = block.reshape(9, -1)
        self.loops.blocks(
            self.stencils.axes, at.slots, at.flipped, at.odd, at.entries, p.item, p.weights, flat, values
        )

    def _add(
        self, loop: Loop, p: Points, more: tuple[FloatArray, ...], r: FloatArray, values: FloatArray
    ) -> None:
        """Add by a loop that takes places, points and more of them."""
        points = (p.item, p.weights, p.gap, p.pull, p.along, p.axis, p.e)
        loop(*self._places, *points, *more, r, values)

    @property
    def _places(self) -> tuple[FloatArray | IntArray | BoolArray, ...]:
        at, items = self.places, self.stencils
        return (items.dofs, items.axes, at.slots, at.flipped, at.odd, at.entries)
