"""The sparsity pattern: built once per topology and set of free DOFs, then only filled.

Free DOFs are renumbered along the bodies (reverse Cuthill-McKee on the nodes, each angle between
its nodes), which makes chains of rods narrow bands. A symmetric pattern stores the upper triangle
only; any unsymmetric term makes the whole pattern store both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

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
        indptr: CSR row pointers, shape (m + 1,).
        indices: CSR columns, sorted in each row, shape (nnz,).
        diagonal: Slot of each diagonal entry, shape (m,).
        symmetric: Whether only the upper triangle is stored.
    """

    free: IntArray
    order: IntArray
    indptr: IntArray
    indices: IntArray
    diagonal: IntArray
    symmetric: bool

    @classmethod
    def build(cls, dofs: DofMap, free: BoolArray, couplings: Sequence[Coupling]) -> SparsityPattern:
        """Build from the DOF cliques of all terms; the diagonal is always present."""
        symmetric = all(c.symmetric for c in couplings)
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
        rows, columns = np.divmod(key, max(m, 1))
        indptr = np.searchsorted(rows, np.arange(m + 1))
        diagonal = np.searchsorted(key, np.arange(m) * (m + 1))
        return cls(listed, order, indptr.astype(np.int64), columns, diagonal, symmetric)

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
        keys = self.rows * self.m + self.indices
        fixed = (rows < 0) | (columns < 0)
        wanted = np.where(fixed, 0, rows * self.m + columns)
        found = np.searchsorted(keys, wanted)
        return np.where(fixed, self.nnz, found)

    def csr(self, values: FloatArray) -> csr_matrix:
        """Matrix of the stored entries; a view of ``values`` without the spare slot."""
        return csr_matrix((values[: self.nnz], self.indices, self.indptr), shape=(self.m, self.m))


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
