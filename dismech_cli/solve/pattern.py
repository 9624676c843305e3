"""The sparsity pattern: built once per topology and set of free DOFs, then only filled.

Free DOFs are renumbered along the bodies (reverse Cuthill-McKee on the nodes, each angle between
its nodes), which makes chains of rods narrow bands. A symmetric pattern stores the upper triangle only.
What comes to touch during a run joins the pattern as an extension, in the same numbering.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import reverse_cuthill_mckee

from ..arrays import BoolArray, FloatArray, IntArray
from ..kernels.linearization import Coupling
from ..kinematics.dofs import DofMap


@dataclass(frozen=True, slots=True)
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
            couplings: DOFs that terms couple.
            symmetric: Whether to store the upper triangle only.
        """
        listed = _matrix_order(dofs, free, couplings)
        order = np.full(dofs.n, -1, dtype=np.int64)
        order[listed] = np.arange(len(listed))
        m = len(listed)
        keys = [np.arange(m) * (m + 1)]
        for coupling in couplings:
            local = order[coupling.dofs]
            rows = np.repeat(local, local.shape[1], axis=1).reshape(-1)
            columns = np.tile(local, (1, local.shape[1])).reshape(-1)
            keep = (rows >= 0) & (columns >= 0)
            if symmetric:
                keep &= rows <= columns
            keys.append(_distinct(rows[keep] * m + columns[keep]))
        key = _distinct(np.concatenate(keys))
        nodes, angles = dofs.n_nodes, dofs.n - dofs.n_positions
        block = np.concatenate((np.repeat(np.arange(nodes), dofs.dimension), nodes + np.arange(angles)))
        return cls(listed, order, block, key, *_compressed(key, m), symmetric)

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

    def holds(self, couplings: Iterable[Coupling]) -> bool:
        """Whether every entry of these couplings is stored."""
        wanted = self._entries(couplings)
        return bool((np.append(self.keys, -1)[np.searchsorted(self.keys, wanted)] == wanted).all())

    def extended(self, couplings: Iterable[Coupling]) -> Extension:
        """The pattern with more couplings, in the same order of DOFs."""
        wanted = self._entries(couplings)
        place = np.searchsorted(self.keys, wanted)
        known = np.append(self.keys, -1)[place] == wanted
        new, before = wanted[~known], place[~known]
        slots = np.arange(self.nnz) + np.cumsum(np.bincount(before, minlength=self.nnz + 1))[:-1]
        key = np.empty(self.nnz + len(new), dtype=np.int64)
        key[slots] = self.keys
        key[before + np.arange(len(new))] = new
        indptr, indices, diagonal = _compressed(key, self.m)
        pattern = replace(self, keys=key, indptr=indptr, indices=indices, diagonal=diagonal)
        return Extension(pattern, np.append(slots, pattern.nnz), wanted)

    def _entries(self, couplings: Iterable[Coupling]) -> IntArray:
        """Keys of all entries of cliques, ascending: pairs of blocks first, which are far fewer."""
        count = int(self.block[-1]) + 1 if len(self.block) else 0
        pairs = [np.empty(0, dtype=np.int64)]
        for coupling in couplings:
            blocks = self.block[coupling.dofs]
            blocks = blocks[:, np.append(True, (np.diff(blocks, axis=1) != 0).any(axis=0))]
            i, j = np.triu_indices(blocks.shape[1])
            low, high = np.minimum(blocks[:, i], blocks[:, j]), np.maximum(blocks[:, i], blocks[:, j])
            pairs.append(_distinct((low * count + high).reshape(-1)))
        one, other = np.divmod(_distinct(np.concatenate(pairs)), max(count, 1))
        # matrix indices of the free DOFs of each block, -1 where there are no more
        width = int(np.bincount(self.block).max(initial=1))
        members = np.full((count, width), -1, dtype=np.int64)
        first = np.searchsorted(self.block, np.arange(count))
        members[self.block, np.arange(len(self.block)) - first[self.block]] = self.order
        a, b = np.broadcast_arrays(members[one][:, :, None], members[other][:, None, :])
        a, b = a.reshape(-1), b.reshape(-1)
        keep = (a >= 0) & (b >= 0)
        a, b = a[keep], b[keep]
        upper = _distinct(np.minimum(a, b) * self.m + np.maximum(a, b))
        if self.symmetric:
            return upper
        a, b = np.divmod(upper, max(self.m, 1))
        return _distinct(np.concatenate((upper, b * self.m + a)))


@dataclass(frozen=True, slots=True)
class Extension:
    """A pattern that holds another.

    Attributes:
        pattern: The larger one.
        base_slots: Slot in it of each slot of the smaller one, the spare one included.
        entries: Keys of all entries that the extension was made for, ascending.
    """

    pattern: SparsityPattern
    base_slots: IntArray
    entries: IntArray

    def mirror(self) -> tuple[IntArray, IntArray]:
        """Slots (lower, upper) of the strictly lower ones of these entries and of their transposes."""
        m = max(self.pattern.m, 1)
        rows, columns = np.divmod(self.entries, m)
        lower = rows > columns
        keys = self.pattern.keys
        transposed = columns[lower] * m + rows[lower]
        return np.searchsorted(keys, self.entries[lower]), np.searchsorted(keys, transposed)


def _compressed(keys: IntArray, m: int) -> tuple[IntArray, IntArray, IntArray]:
    """Row pointers, columns and slots of the diagonal of sorted keys."""
    starts = np.searchsorted(keys, np.arange(m + 1) * m)
    diagonal = np.searchsorted(keys, np.arange(m) * (m + 1))
    columns = keys - np.repeat(np.arange(m) * m, np.diff(starts))
    return starts.astype(np.int64), columns, diagonal


def _distinct(keys: IntArray) -> IntArray:
    """Sorted, each once; np.unique of NumPy 2.4 hashes, which takes many times longer here."""
    ordered = np.sort(keys)
    new = np.ones(len(ordered), dtype=np.bool_)
    new[1:] = ordered[1:] != ordered[:-1]
    distinct: IntArray = ordered[new]
    return distinct


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
