"""Entries of cliques and their merging into a pattern, one by one: what :mod:`.pattern` does in batches."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..geometry.hashed import hashed
from ..geometry.kernel import loop


@loop
def gather_pairs(
    dofs: IntArray, block: IntArray, start: IntArray, m: int, seen: IntArray, before: IntArray
) -> IntArray:
    """Pairs of blocks that cliques couple, after those of other cliques.

    Args:
        dofs: Of cliques that are alike, shape (S, D).
        block: Of each DOF, shape (n,).
        start: First free DOF of its block, m where all are fixed, shape (n,).
        m: Free DOFs.
        seen: Pairs seen last, changed: neighbours share most of theirs, which are then left out; as long as a
            power of two.
        before: Pairs of other cliques, shape (P, 2).

    Returns:
        The places where the two blocks of each pair begin, the lower one first; a few pairs come again.
    """
    cliques, size = dofs.shape
    n, found = 0, len(before)
    heads, places = np.empty(size, dtype=np.int64), np.empty(size, dtype=np.int64)
    for k in range(size if cliques else 0):
        here, last = dofs[0, k], dofs[0, max(k - 1, 0)]
        # a clique that visits a block twice in a row begins it anew
        if here <= last or block[here] != block[last]:
            heads[n] = k
            n += 1
    pairs = np.empty((found + cliques * n * (n + 1) // 2, 2), dtype=np.int64)
    pairs[:found] = before
    for s in range(cliques):
        for i in range(n):
            places[i] = start[dofs[s, heads[i]]]
            for j in range(i + 1):
                low, high = min(places[i], places[j]), max(places[i], places[j])
                kept = hashed(low, high, len(seen))
                if high < m and seen[kept] != low * m + high:
                    seen[kept] = low * m + high
                    pairs[found, 0], pairs[found, 1] = low, high
                    found += 1
    return pairs[:found]


@loop
def spread_pairs(pairs: IntArray, width: IntArray, both: bool) -> IntArray:
    """Keys of all entries of pairs of blocks, row times m plus column, each once, ascending.

    Args:
        pairs: See :func:`gather_pairs`.
        width: Free DOFs of the block that begins at each place, shape (m,).
        both: Whether both triangles are stored.
    """
    m = len(width)
    begin = np.zeros(m + 1, dtype=np.int64)
    for k in range(len(pairs)):
        low, high = pairs[k, 0], pairs[k, 1]
        begin[low + 1] += 1
        if both and high != low:
            begin[high + 1] += 1
    for row in range(m):
        begin[row + 1] += begin[row]
    end, columns = begin[:m].copy(), np.empty(begin[m], dtype=np.int64)
    for k in range(len(pairs)):
        low, high = pairs[k, 0], pairs[k, 1]
        columns[end[low]] = high
        end[low] += 1
        if both and high != low:
            columns[end[high]] = low
            end[high] += 1
    seen, count = np.full(m, -1), 0
    for row in range(m):
        # each column once, in order: few of them, so by insertion
        last = begin[row]
        for k in range(begin[row], end[row]):
            column = columns[k]
            if seen[column] != row:
                seen[column] = row
                place = last
                while place > begin[row] and columns[place - 1] > column:
                    columns[place] = columns[place - 1]
                    place -= 1
                columns[place] = column
                last += 1
                count += width[row] * width[column]
        end[row] = last
    keys, found = np.empty(count, dtype=np.int64), 0
    for row in range(m):
        for inner in range(width[row] if end[row] > begin[row] else 0):
            for k in range(begin[row], end[row]):
                column = columns[k]
                for other in range(inner if column == row and not both else 0, width[column]):
                    keys[found] = (row + inner) * m + column + other
                    found += 1
    return keys[:found]


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
            place = np.uint64(found + k - i)
            keys[place] = base[k]
            indices[place] = base[k] - first
            base_slots[k] = found + k - i
        found += end - i
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
