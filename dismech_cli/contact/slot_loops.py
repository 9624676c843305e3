"""Places of items in the matrix, looked up one by one: what :mod:`.stencils` does in batches."""

from __future__ import annotations

from typing import Any

from ..arrays import IntArray
from ..geometry.kernel import kernel, loop


@kernel
def _found(indptr: IntArray, indices: IntArray, row: Any, column: Any, guess: Any) -> Any:
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
                            slot = _found(indptr, indices, row, max(a, b), begin)
                            slots[s, k] = slot
                            begin = slot + 1
                            if not found:
                                found = True
                                guess = slot - indptr[row] - (0 if p == q else 1) + indptr[row + 1]


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
                    slot = _found(indptr, indices, a, b, slot + 1)
                    slots[s, k] = slot
                k += 1
