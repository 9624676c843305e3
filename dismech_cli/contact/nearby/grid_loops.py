"""Pairs of boxes near each other on a grid, one by one: what :mod:`.candidates` does with trees."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...arrays import FloatArray, IntArray
from ...geometry.kernel import kernel, loop


@kernel
def _cell(x: Any, cell: Any) -> Any:
    return np.int64(np.floor(x / cell))


@kernel
def _packed(i: Any, j: Any, k: Any) -> Any:
    """One number for a cell, 21 bits for each of its places."""
    return ((i & 0x1FFFFF) << 42) | ((j & 0x1FFFFF) << 21) | (k & 0x1FFFFF)


@kernel
def _bucket(packed: Any, mask: Any) -> Any:
    return (packed ^ ((packed >> 21) * 73856093) ^ ((packed >> 42) * 19349663)) & mask


@loop
def count_cells(low: FloatArray, high: FloatArray, sizes: FloatArray, cell: float) -> int:
    """Cells that boxes lie in, all together.

    Args:
        low: Lower corners [m], shape (B, 3).
        high: Upper corners [m], shape (B, 3).
        sizes: By how much they are larger on all sides [m], shape (B,).
        cell: Side of the cells [m].
    """
    count = 0
    for b in range(len(low)):
        cells = 1
        for a in range(3):
            cells *= 1 + _cell(high[b, a] + sizes[b], cell) - _cell(low[b, a] - sizes[b], cell)
        count += cells
    return count


@loop
def fill_cells(
    low: FloatArray,
    high: FloatArray,
    sizes: FloatArray,
    cell: float,
    begin: IntArray,
    boxes: IntArray,
    cells: IntArray,
) -> None:
    """Put boxes into the buckets of their cells.

    Args:
        low: See :func:`count_cells`.
        high: See there.
        sizes: See there.
        cell: See there.
        begin: Where each bucket begins, written, shape (a power of two + 1,).
        boxes: Box of each entry of the buckets, written, shape (as counted,).
        cells: Cell of each, likewise.
    """
    mask = len(begin) - 2
    for step in range(2):
        for b in range(len(low)):
            i0, i1 = _cell(low[b, 0] - sizes[b], cell), _cell(high[b, 0] + sizes[b], cell)
            j0, j1 = _cell(low[b, 1] - sizes[b], cell), _cell(high[b, 1] + sizes[b], cell)
            k0, k1 = _cell(low[b, 2] - sizes[b], cell), _cell(high[b, 2] + sizes[b], cell)
            for i in range(i0, i1 + 1):
                for j in range(j0, j1 + 1):
                    for k in range(k0, k1 + 1):
                        packed = _packed(i, j, k)
                        bucket = _bucket(packed, mask)
                        if step == 0:
                            begin[bucket + 1] += 1
                        else:
                            # from the back, so that in the end each begins where the one before it ends
                            begin[bucket + 1] -= 1
                            boxes[begin[bucket + 1]] = b
                            cells[begin[bucket + 1]] = packed
        if step == 0:
            for bucket in range(mask + 1):
                begin[bucket + 1] += begin[bucket]
    for bucket in range(mask + 1):
        begin[bucket] = begin[bucket + 1]
    begin[mask + 1] = len(boxes)


@loop
def near_boxes(
    low: FloatArray,
    high: FloatArray,
    sizes: FloatArray,
    other_low: FloatArray,
    other_high: FloatArray,
    other_sizes: FloatArray,
    above: int,
    cell: float,
    begin: IntArray,
    boxes: IntArray,
    cells: IntArray,
    pairs: IntArray,
) -> int:
    """Pairs of boxes and of others, in cells, that are nearer than both sizes; ascending.

    Args:
        low: See :func:`count_cells`.
        high: See there.
        sizes: See there.
        other_low: The same of the boxes in the cells.
        other_high: See above.
        other_sizes: See above.
        above: 0, or 1 to find others of higher number only.
        cell: Side of the cells [m].
        begin: See :func:`fill_cells`.
        boxes: See there.
        cells: See there.
        pairs: Written, as many as there is room for, shape (capacity, 2).

    Returns:
        Number of pairs.
    """
    mask = len(begin) - 2
    found = 0
    for one in range(len(low)):
        first = found
        i0, i1 = _cell(low[one, 0] - sizes[one], cell), _cell(high[one, 0] + sizes[one], cell)
        j0, j1 = _cell(low[one, 1] - sizes[one], cell), _cell(high[one, 1] + sizes[one], cell)
        k0, k1 = _cell(low[one, 2] - sizes[one], cell), _cell(high[one, 2] + sizes[one], cell)
        for i in range(i0, i1 + 1):
            for j in range(j0, j1 + 1):
                for k in range(k0, k1 + 1):
                    packed = _packed(i, j, k)
                    bucket = _bucket(packed, mask)
                    for entry in range(begin[bucket], begin[bucket + 1]):
                        other = boxes[entry]
                        if cells[entry] != packed or (above == 1 and other <= one):
                            continue
                        # in the first cell that they share only
                        size = other_sizes[other]
                        if (
                            (i > i0 and i > _cell(other_low[other, 0] - size, cell))
                            or (j > j0 and j > _cell(other_low[other, 1] - size, cell))
                            or (k > k0 and k > _cell(other_low[other, 2] - size, cell))
                        ):
                            continue
                        square, reach = 0.0, sizes[one] + size
                        for a in range(3):
                            gap = max(
                                low[one, a] - other_high[other, a], other_low[other, a] - high[one, a], 0.0
                            )
                            square += gap * gap
                        if square < reach * reach:
                            if found < len(pairs):
                                place = found
                                while place > first and pairs[place - 1, 1] > other:
                                    pairs[place, 1] = pairs[place - 1, 1]
                                    place -= 1
                                pairs[place, 1] = other
                                pairs[found, 0] = one
                            found += 1
    return found
