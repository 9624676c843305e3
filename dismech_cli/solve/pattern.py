"""The sparsity pattern: built once per topology and set of free DOFs, then only filled.

Free DOFs are renumbered along the bodies (reverse Cuthill-McKee on the nodes, each angle between
its nodes), which makes chains of rods narrow bands. A symmetric pattern stores the upper triangle only.
What comes to touch during a run joins the pattern as an extension, in the same numbering.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import reverse_cuthill_mckee

from ..arrays import BoolArray, FloatArray, IntArray, distinct
from ..frozen import frozen
from ..kernels.linearization import Coupling
from ..kinematics.dofs import DofMap


@frozen
class SparsityPattern:
    """Compressed rows over the free DOFs.

    Attributes:
        free: Global index of each free DOF in matrix order, shape (m,).
        order: Matrix index of each global DOF, -1 if fixed, shape (n,).
        block: Block of each global DOF, shape (n,): the DOFs of a node are one, each angle is its own.
        keys: Row times m plus column of each stored entry, ascending, shape (nnz,).
        indptr: CSR row pointers, shape (m + 1,).
        indices: CSR columns, sorted in each row, shape (nnz,).
        diagonal: Slot of each diagonal entry, shape (m,).
        symmetric: Whether only the upper triangle is stored.
    """

    free: IntArray
    order: IntArray
    block: IntArray
    keys: IntArray
    indptr: IntArray
    indices: IntArray
    diagonal: IntArray
    symmetric: bool

    @classmethod
    def build(
        cls, dofs: DofMap, free: BoolArray, couplings: Sequence[Coupling], *, symmetric: bool
    ) -> SparsityPattern:
        """Build from the DOF cliques of all terms; the diagonal is always present.

        Args:
            dofs: Numbering.
            free: Mask of the free DOFs, shape (n,).
            couplings: DOFs that terms couple, all of a node together.
            symmetric: Whether to store the upper triangle only.
        """
        alone = _diagonal(dofs, free, couplings, symmetric=symmetric)
        return alone.extended(alone.entries(couplings)).pattern

    @classmethod
    def outline(
        cls, dofs: DofMap, free: BoolArray, couplings: Sequence[Coupling], *, symmetric: bool
    ) -> Outline:
        """Sizes of what :meth:`build` would make, for a part of its price."""
        alone = _diagonal(dofs, free, couplings, symmetric=symmetric)
        width = alone.blocks().width
        a, b = _pairs_of_blocks(alone, couplings)
        sizes = np.where(a == b, width[a] * (width[a] + 1) // 2, width[a] * width[b])
        # what nothing couples has its diagonal
        upper = int(sizes.sum()) + alone.m - int(width[a[a == b]].sum())
        return Outline(
            alone.m,
            upper if symmetric else 2 * upper - alone.m,
            int((b + width[b] - 1 - a).max(initial=0)),
        )

    @property
    def m(self) -> int:
        """Free DOFs."""
        return len(self.free)

    @property
    def nnz(self) -> int:
        """Stored entries."""
        return len(self.indices)

    @property
    def slots(self) -> int:
        """Length of value arrays: stored entries and one spare for fixed DOFs."""
        return len(self.indices) + 1

    @property
    def rows(self) -> IntArray:
        """Row of each stored entry, shape (nnz,)."""
        return np.repeat(np.arange(self.m), np.diff(self.indptr))

    @property
    def bandwidth(self) -> int:
        """Largest |column - row| of a stored entry."""
        return int(np.abs(self.indices - self.rows).max(initial=0))

    def symmetric_slots(self, i: IntArray, j: IntArray) -> IntArray:
        """Slot of the upper-triangle entry of each unordered pair."""
        a, b = self.order[i], self.order[j]
        return self._find(np.minimum(a, b), np.maximum(a, b))

    def slots_of(self, row: IntArray, column: IntArray) -> IntArray:
        """Slot of each (row, column) of a pattern that stores both triangles."""
        return self._find(self.order[row], self.order[column])

    def mirror(self) -> tuple[IntArray, IntArray]:
        """Slots (lower, upper) of every strictly lower entry and its transpose."""
        rows = self.rows
        lower = np.flatnonzero(self.indices < rows)
        return lower, self._find(self.indices[lower], rows[lower])

    def _find(self, rows: IntArray, columns: IntArray) -> IntArray:
        fixed = (rows < 0) | (columns < 0)
        wanted = np.where(fixed, 0, rows * self.m + columns)
        found = np.searchsorted(self.keys, wanted)
        return np.where(fixed, self.nnz, found)

    def csr(self, values: FloatArray) -> csr_matrix:
        """Matrix of the stored entries; a view of ``values`` without the spare slot."""
        return csr_matrix((values[: self.nnz], self.indices, self.indptr), shape=(self.m, self.m))

    def product(self, values: FloatArray, x: FloatArray) -> FloatArray:
        """The matrix of these values times x, shape (m,)."""
        matrix = self.csr(values)
        y: FloatArray = matrix @ x
        if self.symmetric:
            y += matrix.T @ x - values[self.diagonal] * x
        return y

    def holds(self, entries: IntArray) -> bool:
        """Whether every one of some entries, given by their keys, is stored."""
        return bool((np.append(self.keys, -1)[np.searchsorted(self.keys, entries)] == entries).all())

    def entries(self, couplings: Iterable[Coupling]) -> IntArray:
        """Keys of all entries of cliques, each once, ascending."""
        return _entries(self, couplings)

    def extended(self, entries: IntArray) -> Extension:
        """The pattern with more entries, given by their keys, in the same order of DOFs."""
        both = np.concatenate((self.keys, entries))
        # two ascending pieces: a stable sort merges them; of equal keys that of the base comes first
        merged = np.argsort(both, kind="stable")
        ordered = both[merged]
        new = np.ones(len(both), dtype=np.bool_)
        np.not_equal(ordered[1:], ordered[:-1], out=new[1:])
        slots = np.empty(len(both), dtype=np.int64)
        slots[merged] = np.cumsum(new) - 1
        keys = ordered[new]
        indptr, indices, diagonal = _compressed(keys, self.m)
        pattern = replace(self, keys=keys, indptr=indptr, indices=indices, diagonal=diagonal)
        return Extension(pattern, np.append(slots[: self.nnz], pattern.nnz), slots[self.nnz :], entries)

    def add_at(self, base: FloatArray, slots: IntArray, values: FloatArray) -> None:
        """Add values of this pattern to those of an extension, at its ``base_slots``."""
        values[slots] += base

    def blocks(self) -> Blocks:
        """Blocks of free DOFs in matrix order."""
        m = max(self.m, 1)
        # a block is known by the place of its first free DOF; the DOFs of a block follow each other
        order = np.where(self.order < 0, m, self.order)
        begin = np.flatnonzero(np.diff(self.block, prepend=-1))
        start = np.minimum.reduceat(order, begin)[self.block] if len(order) else order
        return Blocks(self.block, start, np.bincount(start[self.free], minlength=m))


@frozen
class Outline:
    """Sizes of a pattern.

    Attributes:
        m: Free DOFs.
        nnz: Stored entries.
        bandwidth: Largest |column - row| of a stored entry.
    """

    m: int
    nnz: int
    bandwidth: int


class Sized(Protocol):
    """What has the sizes of a pattern."""

    @property
    def m(self) -> int:
        """Free DOFs."""

    @property
    def bandwidth(self) -> int:
        """Largest |column - row| of a stored entry."""


@frozen
class Blocks:
    """Blocks of free DOFs.

    Attributes:
        of: Block of each global DOF, shape (n,).
        start: Place of the first free DOF of its block in matrix order, m if it has none, shape (n,).
        width: Free DOFs of the block that begins at a place, shape (m,).
    """

    of: IntArray
    start: IntArray
    width: IntArray

    def places(self, coupling: Coupling) -> IntArray:
        """Starts of the blocks of each clique, shape (S, blocks)."""
        # DOFs of a block ascend: where they do not, a clique visits it twice in a row
        first = coupling.dofs[:1]
        new = (np.diff(self.of[first], prepend=-1) != 0) | (np.diff(first, prepend=-1) <= 0)
        one_each = np.flatnonzero(new.any(axis=0))
        return self.start[coupling.dofs[:, one_each]]


@frozen
class Extension:
    """A pattern that holds another.

    Attributes:
        pattern: The larger one.
        base_slots: Slot in it of each slot of the smaller one, the spare one included.
        entry_slots: Slot in it of each entry that the extension was made for.
        entries: Keys of these entries, ascending.
    """

    pattern: SparsityPattern
    base_slots: IntArray
    entry_slots: IntArray
    entries: IntArray

    def mirror(self) -> tuple[IntArray, IntArray]:
        """Slots (lower, upper) of the strictly lower ones of these entries and of their transposes."""
        m = max(self.pattern.m, 1)
        rows, columns = np.divmod(self.entries, m)
        lower = rows > columns
        transposed = columns[lower] * m + rows[lower]
        return self.entry_slots[lower], np.searchsorted(self.pattern.keys, transposed)


def _entries(pattern: SparsityPattern, couplings: Iterable[Coupling]) -> IntArray:
    """Keys of all entries of cliques, ascending: pairs of blocks first, which are far fewer."""
    m, width = max(pattern.m, 1), pattern.blocks().width
    a, b = _pairs_of_blocks(pattern, couplings)
    columns = np.arange(width.max(initial=1))
    upper = []
    for row in columns.tolist():
        # ascending for each row of the blocks: what follows merges a few sorted pieces
        there = (row < width[a])[:, None] & (columns < width[b][:, None])
        there &= (a != b)[:, None] | (columns >= row)
        upper.append((((a + row) * m + b)[:, None] + columns)[there])
    entries = np.sort(np.concatenate(upper), kind="stable")
    if pattern.symmetric:
        return entries
    a, b = np.divmod(entries, m)
    return distinct(np.concatenate((entries, b * m + a)))


def _pairs_of_blocks(pattern: SparsityPattern, couplings: Iterable[Coupling]) -> tuple[IntArray, IntArray]:
    """Starts of blocks that cliques couple, the lower one first, each pair once, ascending."""
    m, blocks = max(pattern.m, 1), pattern.blocks()
    found = [np.empty(0, dtype=np.int64)]
    for coupling in couplings:
        places = blocks.places(coupling)
        i, j = np.triu_indices(places.shape[1])
        low, high = np.minimum(places[:, i], places[:, j]), np.maximum(places[:, i], places[:, j])
        found.append((low * m + high)[high < m])
    a, b = np.divmod(distinct(np.concatenate(found)), m)
    return a, b


def _diagonal(
    dofs: DofMap, free: BoolArray, couplings: Sequence[Coupling], *, symmetric: bool
) -> SparsityPattern:
    """The pattern of a diagonal matrix, in the order that suits couplings."""
    listed = _matrix_order(dofs, free, couplings)
    order = np.full(dofs.n, -1, dtype=np.int64)
    order[listed] = np.arange(len(listed))
    m = len(listed)
    nodes, angles = dofs.n_nodes, dofs.n - dofs.n_positions
    block = np.concatenate((np.repeat(np.arange(nodes), dofs.dimension), nodes + np.arange(angles)))
    diagonal = np.arange(m) * (m + 1)
    return SparsityPattern(listed, order, block, diagonal, *_compressed(diagonal, m), symmetric)


def _compressed(keys: IntArray, m: int) -> tuple[IntArray, IntArray, IntArray]:
    """Row pointers, columns and slots of the diagonal of sorted keys."""
    starts = np.searchsorted(keys, np.arange(m + 1) * m)
    diagonal = np.searchsorted(keys, np.arange(m) * (m + 1))
    columns = keys - np.repeat(np.arange(m) * m, np.diff(starts))
    return starts.astype(np.int64), columns, diagonal


def _matrix_order(dofs: DofMap, free: BoolArray, couplings: Sequence[Coupling]) -> IntArray:
    """Free DOFs listed along the bodies."""
    n_nodes, d = dofs.n_nodes, dofs.dimension
    pairs = [np.empty((0, 2), dtype=np.int64)]
    angle_of: list[tuple[IntArray, IntArray]] = []
    for coupling in couplings:
        if not len(coupling.dofs):  # a rod of one edge has no joints
            continue
        positions = coupling.dofs < dofs.n_positions
        width = int(positions[0].sum())
        nodes = coupling.dofs[:, :width:d] // d
        for k in range(nodes.shape[1] - 1):
            pairs.append(nodes[:, k : k + 2])
        angles = coupling.dofs[:, width:] - dofs.n_positions
        for k in range(angles.shape[1]):
            angle_of.append((angles[:, k], nodes[:, k : k + 2]))
    edges = np.concatenate(pairs)
    graph = csr_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(n_nodes, n_nodes))
    place = np.empty(n_nodes)
    place[reverse_cuthill_mckee((graph + graph.T).tocsr(), symmetric_mode=True)] = np.arange(n_nodes)
    key = np.empty(dofs.n)
    key[: dofs.n_positions] = np.repeat(place, d)
    key[dofs.n_positions :] = n_nodes
    for angles, ends in angle_of:
        key[dofs.n_positions + angles] = place[ends].mean(axis=1)
    listed = np.lexsort((np.arange(dofs.n), key))
    return np.asarray(listed[free[listed]], dtype=np.int64)
