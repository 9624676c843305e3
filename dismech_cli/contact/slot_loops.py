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
def find_upper(order: IntArray, indptr: IntArray, indices: IntArray, dofs: IntArray, slots: IntArray) -> None:
    """Slots of the upper triangles of items.

    Args:
        order: Matrix index of each DOF, -1 if fixed, shape (n,).
        indptr: Row pointers, shape (m + 1,).
        indices: Columns, shape (nnz,).
        dofs: Of each item, shape (S, D).
        slots: Written, shape (S, D (D + 1) / 2).
    """
    size = dofs.shape[1]
    for s in range(len(dofs)):
        k = 0
        for i in range(size):
            slot, a = -2, order[dofs[s, i]]
            for j in range(i, size):
                b = order[dofs[s, j]]
                if a < 0 or b < 0:
                    slots[s, k] = len(indices)
                else:
                    slot = _found(indptr, indices, min(a, b), max(a, b), slot + 1)
                    slots[s, k] = slot
                k += 1


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
