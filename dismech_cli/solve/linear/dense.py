"""LAPACK LU of the full matrix, for a handful of free DOFs."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from scipy.linalg.lapack import dgetrf, dgetrs

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ..pattern import SparsityPattern
from .factors import FactorizationError, checked


class DenseSolver:
    """LU with partial pivoting."""

    name: ClassVar[str] = "dense"

    def __init__(self, pattern: SparsityPattern) -> None:
        self._pattern = pattern
        self._matrix = np.zeros((pattern.m, pattern.m), order="F")
        self._rows = pattern.rows

    def factorize(self, values: FloatArray) -> DenseFactors | NoFactors:
        """Fill the matrix and factorise it."""
        p = self._pattern
        if not p.m:
            # LAPACK takes none, and says so on the terminal
            return NoFactors()
        self._matrix[self._rows, p.indices] = values[: p.nnz]
        if p.symmetric:
            self._matrix[p.indices, self._rows] = values[: p.nnz]
        lu, pivots, info = dgetrf(self._matrix)
        if info != 0 or not np.isfinite(lu).all():
            raise FactorizationError("the matrix is singular or not finite")
        return DenseFactors(self._matrix, lu, pivots, p.symmetric)

    def nearly(self, values: FloatArray, cheap: float) -> None:
        """None: they would cost as much."""


@frozen
class NoFactors:
    """Of the matrix without rows, where everything is held."""

    indefinite: ClassVar[bool] = False
    price: ClassVar[float] = 1.0

    def solve(self, rhs: FloatArray) -> FloatArray:
        """The solution, which is empty."""
        return rhs.copy()

    def solve_transposed(self, rhs: FloatArray) -> FloatArray:
        """The solution, which is empty."""
        return rhs.copy()


@frozen
class DenseFactors:
    """P A = L U."""

    matrix: FloatArray
    lu: FloatArray
    pivots: IntArray
    symmetric: bool
    price: ClassVar[float] = 1.0

    @property
    def indefinite(self) -> bool:
        """By the eigenvalues: the matrix is tiny."""
        return self.symmetric and float(np.linalg.eigvalsh(self.matrix)[0]) < 0.0

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Solve A x = rhs."""
        return checked(rhs, lambda b: self._solve(b, 0), lambda x: self.matrix @ x)

    def solve_transposed(self, rhs: FloatArray) -> FloatArray:
        """Solve A^T x = rhs."""
        return checked(rhs, lambda b: self._solve(b, 1), lambda x: self.matrix.T @ x)

    def _solve(self, rhs: FloatArray, trans: int) -> FloatArray:
        x: FloatArray = dgetrs(self.lu, self.pivots, rhs, trans=trans)[0]
        return x
