"""Sums to packed blocks of pairs of nodes, by compiled loops."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...kernels.driver import Driver
from ...kernels.linearization import Pattern
from ..points.filled import Loop
from . import packed_loops, piece_sums
from .stencils import Stencils
from .touching import Touching


@frozen
class PackedSums:
    """The loops; see :mod:`.packed_loops` and :mod:`.piece_sums`."""

    squares: Loop
    find: Loop
    spread: Loop

    @classmethod
    def of(cls, driver: Driver) -> PackedSums | None:
        """The loops of a driver; None where it does not compile."""
        names = (piece_sums.sum_squares, packed_loops.find_pairs, packed_loops.spread_blocks)
        loops: list[Loop] = [made for one in names if (made := driver.compiled(one)) is not None]
        return cls(*loops) if len(loops) == len(names) else None

    def at(self, stencils: Sequence[Stencils], pattern: Pattern) -> Packed:
        """Where the items of some kinds have their places: blocks that they share."""
        pairs = [one.nodes.shape[1] * (one.nodes.shape[1] + 1) // 2 for one in stencils]
        items = [len(one.nodes) for one in stencils]
        nnz = len(pattern.indices)
        numbers = np.zeros(nnz, dtype=np.int32)
        most = min(sum(count * size for count, size in zip(items, pairs, strict=True)), nnz)
        slots = np.empty((most + 1, 9), dtype=np.uint32)
        slots[0] = nnz
        found, blocks = 0, list[tuple[IntArray, IntArray]]()
        for one, size in zip(stencils, pairs, strict=True):
            own: IntArray = np.empty((len(one.nodes), size), dtype=np.uint32)
            place = (pattern.order, pattern.indptr, pattern.indices, one.axes, one.dofs)
            found = self.find(*place, numbers, found, own, slots)
            # half the memory of the usual integers, and no check for negative ones
            dofs: IntArray = one.dofs.astype(np.uint32)
            blocks.append((own, dofs))
        values = np.zeros((found + 1, 8))
        kinds = [PackedKind(self, one, *own, values) for one, own in zip(stencils, blocks, strict=True)]
        return Packed(self, kinds, slots[: found + 1].copy(), values)


@frozen
class PackedKind:
    """Sums to the blocks of items of a kind; implements :class:`.upper.Stiff`.

    Attributes:
        loops: What sums.
        stencils: The items.
        blocks: Numbers of their blocks, shape (S, n (n + 1) / 2).
        dofs: Of the nodes of each, shape (S, n d).
        packed: All blocks, shape (B, 8).
    """

    loops: PackedSums
    stencils: Stencils
    blocks: IntArray
    dofs: IntArray
    packed: FloatArray

    def add_squares(self, touching: Touching, r: FloatArray, values: FloatArray) -> None:
        """Add dE/dq, and to the blocks what the second derivatives have along the gaps."""
        items, t = self.stencils, touching.strips.table
        assert t is not None
        self.loops.squares(
            *(tuple(range(items.nodes.shape[1])), self.dofs, items.axes, self.blocks),
            *(t.rows, t.piece_item, t.pieces, t.reach, t.factor, r, self.packed),
        )

    add_hessians = add_squares


@frozen
class Packed:
    """Blocks that several kinds share.

    Attributes:
        loops: What sums.
        kinds: The kinds.
        slots: Of the entries of each block, shape (B, 9).
        values: Of the blocks, shape (B, 8).
    """

    loops: PackedSums
    kinds: Sequence[PackedKind]
    slots: IntArray
    values: FloatArray

    def spread(self, values: FloatArray) -> None:
        """Bring what was added to the blocks to stored values (slots,)."""
        self.loops.spread(self.values, self.slots, values)
