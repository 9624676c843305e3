"""Blocks of pairs of nodes that are symmetric, six numbers each: where they are, and their way to the matrix.

Rows of a block lie far apart in the matrix, and what many items add to a block would go there again and
again. So blocks are summed packed, side by side, and go to the matrix once.
"""

from __future__ import annotations

from ...arrays import FloatArray, IntArray
from ...geometry.kernel import loop
from .slot_loops import slot_of


@loop
def _first_free(order: IntArray, dofs: IntArray, s: int, begin: int, d: int) -> int:
    """Matrix index of the first free DOF of a node of an item, -1 if there is none."""
    for a in range(d):
        if order[dofs[s, begin + a]] >= 0:
            return int(order[dofs[s, begin + a]])
    return -1


@loop
def find_pairs(
    order: IntArray,
    indptr: IntArray,
    indices: IntArray,
    axes: IntArray,
    dofs: IntArray,
    numbers: IntArray,
    found: int,
    blocks: IntArray,
    slots: IntArray,
) -> int:
    """Number the blocks of pairs of nodes of items, and find where each goes.

    Args:
        order: Matrix index of each DOF, -1 if fixed, shape (n,).
        indptr: Row pointers, shape (m + 1,).
        indices: Columns, shape (nnz,).
        axes: The d axes that the model has.
        dofs: Of each item, node by node, shape (S, D).
        numbers: Of the block that begins at a slot, 0 if it has none yet, shape (nnz,).
        found: Blocks that are known already; block 0 takes what goes nowhere.
        blocks: Numbers of the blocks of each item, written, shape (S, n (n + 1) / 2).
        slots: Of the entries of each block, row by row, written, shape (B, 9).

    Returns:
        Number of blocks.
    """
    d = len(axes)
    for s in range(len(dofs)):
        m = 0
        for i in range(0, dofs.shape[1], d):
            one = _first_free(order, dofs, s, i, d)
            for j in range(i, dofs.shape[1], d):
                other = _first_free(order, dofs, s, j, d)
                block = 0
                if one >= 0 and other >= 0:
                    # where one triangle is stored, the diagonal is the first of its row
                    guess = indptr[one] if i == j else -1
                    first = slot_of(indptr, indices, min(one, other), max(one, other), guess)
                    block = numbers[first]
                    if block == 0:
                        found += 1
                        numbers[first] = block = found
                        for c in range(9):
                            slots[block, c] = len(indices)
                        for a in range(d):
                            slot = -2
                            for b in range(a if i == j else 0, d):
                                row, column = order[dofs[s, i + a]], order[dofs[s, j + b]]
                                if row >= 0 and column >= 0:
                                    low, high = min(row, column), max(row, column)
                                    slot = slot_of(indptr, indices, low, high, slot + 1)
                                    slots[block, 3 * axes[a] + axes[b]] = slot
                blocks[s, m] = block
                m += 1
    return found


@loop
def spread_blocks(packed: FloatArray, slots: IntArray, values: FloatArray) -> None:
    """Add packed blocks (B, 8), six numbers of each, to the matrix, and clear them."""
    for k in range(len(packed)):
        xx, xy, xz = packed[k, 0], packed[k, 1], packed[k, 2]
        yy, yz, zz = packed[k, 3], packed[k, 4], packed[k, 5]
        values[slots[k, 0]] += xx
        values[slots[k, 1]] += xy
        values[slots[k, 2]] += xz
        values[slots[k, 3]] += xy
        values[slots[k, 4]] += yy
        values[slots[k, 5]] += yz
        values[slots[k, 6]] += xz
        values[slots[k, 7]] += yz
        values[slots[k, 8]] += zz
        for c in range(6):
            packed[k, c] = 0.0
