"""Places of items in the matrix, looked up one by one: what :mod:`.stencils` does in batches."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from ...arrays import BoolArray, IntArray
from ...geometry.hashed import hashed
from ...geometry.kernel import kernel, loop

SKIPPED: Final = 0xFFFFFFFF
"""In place of a slot where a node is fixed."""

# Pairs of nodes that are remembered, a power of two.
_KEPT: Final = 512


@kernel
def slot_of(indptr: IntArray, indices: IntArray, row: Any, column: Any, guess: Any) -> Any:
    """Slot of an entry that is stored; the guess is looked at first."""
    low, high = indptr[row], indptr[row + 1]
    if low <= guess < high and indices[guess] == column:
        return guess
    while high - low > 1:
        middle = (low + high) // 2
        if indices[middle] <= column:
            low = middle
        else:
            high = middle
    return low


@loop
def find_upper(
    order: IntArray, indptr: IntArray, indices: IntArray, d: int, dofs: IntArray, slots: IntArray
) -> None:
    """Slots of the upper triangles of items.

    The rows of a node are alike but for their first entries: what was found in one tells where to look in the
    next.

    Args:
        order: Matrix index of each DOF, -1 if fixed, shape (n,).
        indptr: Row pointers, shape (m + 1,).
        indices: Columns, shape (nnz,).
        d: DOFs of a node.
        dofs: Of each item, node by node, shape (S, D).
        slots: Written, shape (S, D (D + 1) / 2).
    """
    size = dofs.shape[1]
    for s in range(len(dofs)):
        for p in range(0, size, d):
            for q in range(p, size, d):
                swapped = order[dofs[s, p + d - 1]] > order[dofs[s, q + d - 1]]
                first, second = (q, p) if swapped else (p, q)
                guess = -1
                for i in range(first, first + d):
                    a = order[dofs[s, i]]
                    begin, found = guess, False
                    for j in range(i if p == q else second, second + d):
                        b = order[dofs[s, j]]
                        low, high = min(i, j), max(i, j)
                        k = low * size - low * (low - 1) // 2 + high - low
                        if a < 0 or b < 0:
                            slots[s, k] = len(indices)
                        else:
                            row = min(a, b)
                            slot = slot_of(indptr, indices, row, max(a, b), begin)
                            slots[s, k] = slot
                            begin = slot + 1
                            if not found:
                                found = True
                                guess = slot - indptr[row] - (0 if p == q else 1) + indptr[row + 1]


@loop
def find_blocks(
    order: IntArray,
    indptr: IntArray,
    indices: IntArray,
    d: int,
    dofs: IntArray,
    slots: IntArray,
    flipped: BoolArray,
    odd: IntArray,
) -> int:
    """Slots at which the rows of the blocks of pairs of nodes begin.

    The DOFs of a node that is free follow each other in the matrix, so that its entries in a row do.

    Args:
        order: See :func:`find_upper`.
        indptr: See there.
        indices: See there.
        d: See there.
        dofs: See there.
        slots: Written, shape (S, n (n + 1) / 2 d): of each row of the block that is in the upper triangle.
        flipped: Whether that is the transpose, written, shape (S, n (n + 1) / 2).
        odd: Number of each item among those of which a node is fixed in part or comes twice, -1 of all
            others, written, shape (S,).

    Returns:
        Number of such items.
    """
    n, count = dofs.shape[1] // d, 0
    places = np.empty(n, dtype=np.int64)
    # neighbours share most of their pairs of nodes: where those found last begin among all slots
    seen, begin, flat = np.full(_KEPT, -1), np.empty(_KEPT, dtype=np.int64), slots.reshape(-1)
    for s in range(len(dofs)):
        strange = False
        for i in range(n):
            first = order[dofs[s, i * d]]
            places[i] = first
            for a in range(1, d):
                strange |= order[dofs[s, i * d + a]] != (first if first < 0 else first + a)
            for j in range(i):
                strange |= dofs[s, i * d] == dofs[s, j * d]
        odd[s] = -1
        if strange:
            odd[s] = count
            count += 1
            continue
        m, k = 0, s * slots.shape[1]
        for i in range(n):
            for j in range(i, n):
                low, high = min(places[i], places[j]), max(places[i], places[j])
                flipped[s, m] = places[i] > places[j]
                m += 1
                key, kept = low * len(order) + high, hashed(low, high, _KEPT)
                if low >= 0 and seen[kept] == key:
                    for a in range(d):
                        flat[np.uint64(k + a)] = flat[np.uint64(begin[kept] + a)]
                    k += d
                    continue
                seen[kept], begin[kept] = key, k
                # the diagonal is the first of its row where one triangle is stored
                off = 0 if i == j else 1
                guess = indptr[low] if i == j and low >= 0 else -1
                for row in range(low, low + d):
                    if low < 0:
                        flat[k] = SKIPPED
                    else:
                        slot = slot_of(indptr, indices, row, max(row, high), guess)
                        flat[k] = slot
                        guess = slot - indptr[row] - off + indptr[row + 1]
                    k += 1
    return count


@loop
def find_all(order: IntArray, indptr: IntArray, indices: IntArray, dofs: IntArray, slots: IntArray) -> None:
    """Slots of the whole matrices of items, shape (S, D^2), in a pattern that stores both triangles."""
    size = dofs.shape[1]
    for s in range(len(dofs)):
        k = 0
        for i in range(size):
            slot, a = -2, order[dofs[s, i]]
            for j in range(size):
                b = order[dofs[s, j]]
                if a < 0 or b < 0:
                    slots[s, k] = len(indices)
                else:
                    slot = slot_of(indptr, indices, a, b, slot + 1)
                    slots[s, k] = slot
                k += 1
