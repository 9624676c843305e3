"""Entries of cliques and their merging into a pattern, one by one: what :mod:`.pattern` does in batches."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..geometry.kernel import loop


@loop
def count_pairs(
    dofs: IntArray,
    block: IntArray,
    start: IntArray,
    m: int,
    both: bool,
    places: IntArray,
    counts: IntArray,
) -> int:
    """Find where the blocks of cliques begin, and count pairs of them by the row that they lie in.

    Args:
        dofs: Of cliques that are alike, shape (S, D).
        block: Of each DOF, shape (n,).
        start: First free DOF of its block, m where all are fixed, shape (n,).
        m: Free DOFs.
        both: Whether both triangles are stored.
        places: First free DOF of each block of each clique, clique by clique, written, shape (S D,).
        counts: Added to at the row after each, shape (m + 1,).

    Returns:
        Blocks of a clique.
    """
    cliques, size = dofs.shape
    n = 0
    heads = np.empty(size, dtype=np.int64)
    for k in range(size if cliques else 0):
        here, last = dofs[0, k], dofs[0, max(k - 1, 0)]
        # a clique that visits a block twice in a row begins it anew
        if here <= last or block[here] != block[last]:
            heads[n] = k
            n += 1
    for s in range(cliques):
        first = s * n
        for i in range(n):
            places[first + i] = start[dofs[s, heads[i]]]
        for i in range(n):
            for j in range(i, n):
                one, other = places[first + i], places[first + j]
                low, high = min(one, other), max(one, other)
                if high < m:
                    counts[low + 1] += 1
                    if both and high != low:
                        counts[high + 1] += 1
    return n


@loop
def fill_pairs(places: IntArray, m: int, both: bool, at: IntArray, columns: IntArray) -> None:
    """Write the columns of pairs of blocks (S, n) row by row; ``at`` is where each row goes on, (m + 1,)."""
    for s in range(len(places)):
        for i in range(places.shape[1]):
            for j in range(i, places.shape[1]):
                low, high = min(places[s, i], places[s, j]), max(places[s, i], places[s, j])
                if high < m:
                    columns[at[low]] = high
                    at[low] += 1
                    if both and high != low:
                        columns[at[high]] = low
                        at[high] += 1


@loop
def spread_pairs(begin: IntArray, columns: IntArray, width: IntArray, both: bool, keys: IntArray) -> int:
    """Write the keys of all entries of blocks, each once, ascending.

    Args:
        begin: Where the pairs of each row begin, shape (m + 1,).
        columns: Their columns; each row is put in order.
        width: Free DOFs of the block that begins at each place, shape (m,).
        both: Whether both triangles are stored.
        keys: Row times m plus column, written as far as it reaches.

    Returns:
        Number of keys.
    """
    m = len(width)
    seen = np.full(m, -1, dtype=np.int64)
    found = 0
    for row in range(m):
        # each column once, in order: few of them, so by insertion
        last = begin[row]
        for k in range(begin[row], begin[row + 1]):
            column = columns[k]
            if seen[column] != row:
                seen[column] = row
                place = last
                while place > begin[row] and columns[place - 1] > column:
                    columns[place] = columns[place - 1]
                    place -= 1
                columns[place] = column
                last += 1
        if last > begin[row]:
            for inner in range(width[row]):
                for k in range(begin[row], last):
                    column = columns[k]
                    first = inner if column == row and not both else 0
                    for other in range(first, width[column]):
                        if found < len(keys):
                            keys[found] = (row + inner) * m + column + other
                        found += 1
    return found


@loop
def merge(
    base: IntArray,
    begin: IntArray,
    wanted: IntArray,
    keys: IntArray,
    base_slots: IntArray,
    wanted_slots: IntArray,
    indptr: IntArray,
    indices: IntArray,
    diagonal: IntArray,
) -> int:
    """Merge ascending keys into compressed rows.

    Args:
        base: Keys.
        begin: Where each row begins among these, shape (m + 1,).
        wanted: Keys.
        keys: Both, each once, written, as long as both together.
        base_slots: Where those of the base are among them, written.
        wanted_slots: Where the wanted ones are, written.
        indptr: Row pointers, written, shape (m + 1,).
        indices: Columns, written, as long as ``keys``.
        diagonal: Slots of the diagonal, written, shape (m,).

    Returns:
        Number of distinct keys.
    """
    m = len(diagonal)
    j, found = 0, 0
    for row in range(m):
        indptr[row] = found
        first, i, end = row * m, begin[row], begin[row + 1]
        while j < len(wanted) and wanted[j] < first + m:
            key = wanted[j]
            while i < end and base[i] < key:
                keys[found] = base[i]
                indices[found] = base[i] - first
                base_slots[i] = found
                found += 1
                i += 1
            if i < end and base[i] == key:
                base_slots[i] = found
                i += 1
            keys[found] = key
            indices[found] = key - first
            wanted_slots[j] = found
            found += 1
            j += 1
        # most rows have nothing new
        for k in range(i, end):
            keys[found] = base[k]
            indices[found] = base[k] - first
            base_slots[k] = found
            found += 1
        for k in range(indptr[row], found):
            if indices[k] == row:
                diagonal[row] = k
                break
    indptr[m] = found
    return found


@loop
def add_at(base: FloatArray, slots: IntArray, values: FloatArray) -> None:
    """Add the values of a pattern to those of its extension.

    Args:
        base: Its values, shape (its slots,).
        slots: Where they are in the extension, each once.
        values: Added to.
    """
    for k in range(len(base)):
        values[slots[k]] += base[k]
