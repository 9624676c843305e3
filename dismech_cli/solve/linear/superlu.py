"""SuperLU: always present, the fallback where MKL has no wheels."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from ...arrays import FloatArray
from ...frozen import frozen
from ..pattern import SparsityPattern
from .factors import FactorizationError, checked, price_of


class SuperLuSolver:
    """LU of the full matrix in compressed columns, in symmetric mode where the matrix is symmetric."""

    name: ClassVar[str] = "superlu"

    def __init__(self, pattern: SparsityPattern) -> None:
        from scipy.sparse import csc_matrix

        rows, columns = pattern.rows, pattern.indices
        source = np.arange(pattern.nnz)
        if pattern.symmetric:
            strict = np.flatnonzero(columns > rows)
            rows, columns = np.concatenate((rows, columns[strict])), np.concatenate((columns, rows[strict]))
            source = np.concatenate((source, strict))
        order = np.lexsort((rows, columns))
        self._source = source[order]
        indptr = np.searchsorted(columns[order], np.arange(pattern.m + 1))
        self._matrix = csc_matrix((np.zeros(len(order)), rows[order], indptr), shape=(pattern.m, pattern.m))
        self._symmetric = pattern.symmetric

    def factorize(self, values: FloatArray) -> SuperLuFactors:
        """Fill the matrix and factorise it."""
        from scipy.sparse.linalg import splu

        self._matrix.data[:] = values[self._source]
        options = (
            {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.001, "options": {"SymmetricMode": True}}
            if self._symmetric
            else {"permc_spec": "COLAMD"}
        )
        if not np.isfinite(self._matrix.data).all():
            raise FactorizationError("the matrix is not finite")
        try:
            return SuperLuFactors(self._matrix, splu(self._matrix, **options), self._symmetric)
        except RuntimeError as error:
            raise FactorizationError(str(error)) from error

    def nearly(self, values: FloatArray, cheap: float) -> None:
        """None: they would cost as much."""


@frozen
class SuperLuFactors:
    """P_r A P_c = L U."""

    matrix: Any
    factors: Any
    symmetric: bool

    @property
    def price(self) -> float:
        """At least, by the mean column of the factors."""
        entries = float(self.factors.nnz)
        return price_of(0.5 * entries * entries / self.matrix.shape[0], entries)

    @property
    def indefinite(self) -> bool:
        """A negative pivot, or one so small that rows were exchanged."""
        if not self.symmetric:
            return False
        exchanged = not np.array_equal(self.factors.perm_r, self.factors.perm_c)
        return exchanged or bool((self.factors.U.diagonal() < 0.0).any())

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Solve A x = rhs."""
        return checked(rhs, self.factors.solve, lambda x: np.asarray(self.matrix @ x))

    def solve_transposed(self, rhs: FloatArray) -> FloatArray:
        """Solve A^T x = rhs."""
        return checked(
            rhs, lambda b: np.asarray(self.factors.solve(b, "T")), lambda x: np.asarray(self.matrix.T @ x)
        )
