"""LAPACK banded Cholesky, with banded LU where the matrix is indefinite or unsymmetric.

Chains of rods are narrow bands in the pattern's numbering; nothing is faster on them.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from scipy.linalg.blas import dgbmv, dsbmv
from scipy.linalg.lapack import dgbtrf, dgbtrs, dpbtrf, dpbtrs

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ..pattern import SparsityPattern
from .factors import FactorizationError, Factors, checked


class BandedSolver:
    """Cholesky's method first where the matrix is symmetric, LU otherwise."""

    name: ClassVar[str] = "banded"

    def __init__(self, pattern: SparsityPattern) -> None:
        self._pattern = pattern
        u = self._width = pattern.bandwidth
        rows, columns, m = pattern.rows, pattern.indices, pattern.m
        # Fortran storage: entry (i, j), j >= i, of the pattern is entry (j, i) of the lower triangle at
        # [j - i, i] of a (u + 1, m) array: in the order of the pattern, and twice as fast to factorise
        # as the upper triangle.
        if pattern.symmetric:
            self._lower = np.zeros((u + 1) * m)
            self._band = self._lower.reshape(u + 1, m, order="F")
            self._lower_place = rows * (u + 1) + (columns - rows)
        height = 3 * u + 1
        self._full_place = columns * height + (2 * u + rows - columns)
        self._full_transposed = rows * height + (2 * u + columns - rows)
        self._full: FloatArray | None = None

    def factorize(self, values: FloatArray) -> Factors:
        """Fill the band and factorise it."""
        p = self._pattern
        if p.symmetric:
            self._lower[self._lower_place] = values[: p.nnz]
            factor, info = dpbtrf(self._band, lower=1)
            if info == 0:
                return CholeskyFactors(self._width, self._band, factor)
        return self._factorize_lu(values)

    def nearly(self, values: FloatArray, cheap: float) -> None:
        """None: they would cost as much."""

    def _factorize_lu(self, values: FloatArray) -> Factors:
        p, u = self._pattern, self._width
        if self._full is None:
            self._full = np.zeros((3 * u + 1) * p.m)
        self._full[self._full_place] = values[: p.nnz]
        if p.symmetric:
            self._full[self._full_transposed] = values[: p.nnz]
        full = self._full.reshape(3 * u + 1, p.m, order="F")
        lu, pivots, info = dgbtrf(full, u, u)
        if info != 0 or not np.isfinite(lu).all():
            raise FactorizationError("the matrix is singular or not finite")
        return BandedFactors(u, full, self._band if p.symmetric else None, lu, pivots)


@frozen
class CholeskyFactors:
    """A = L L^T, positive definite."""

    width: int
    band: FloatArray
    factor: FloatArray
    indefinite: ClassVar[bool] = False
    price: ClassVar[float] = 1.0

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Solve A x = rhs."""
        return checked(rhs, self._solve, self._product)

    solve_transposed = solve

    def _solve(self, rhs: FloatArray) -> FloatArray:
        x: FloatArray = dpbtrs(self.factor, rhs, lower=1)[0]
        return x

    def _product(self, x: FloatArray) -> FloatArray:
        y: FloatArray = dsbmv(self.width, 1.0, self.band, x, lower=1)
        return y


@frozen
class BandedFactors:
    """P A = L U of a matrix that is unsymmetric, or symmetric and not positive definite.

    Attributes:
        width: Sub- and superdiagonals.
        full: The band with LAPACK's room above it, shape (3 width + 1, m).
        band: Lower triangle of a symmetric matrix, shape (width + 1, m), else None.
        lu: Its factors.
        pivots: Its row exchanges.
    """

    width: int
    full: FloatArray
    band: FloatArray | None
    lu: FloatArray
    pivots: IntArray
    price: ClassVar[float] = 1.0

    @property
    def indefinite(self) -> bool:
        """Cholesky's method failed."""
        return self.band is not None

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Solve A x = rhs."""
        return checked(rhs, lambda b: self._solve(b, 0), self._product)

    def solve_transposed(self, rhs: FloatArray) -> FloatArray:
        """Solve A^T x = rhs."""
        return checked(rhs, lambda b: self._solve(b, 1), lambda x: self._product(x, 1))

    def _solve(self, rhs: FloatArray, trans: int) -> FloatArray:
        x: FloatArray = dgbtrs(self.lu, self.width, self.width, rhs, self.pivots, trans=trans)[0]
        return x

    def _product(self, x: FloatArray, trans: int = 0) -> FloatArray:
        m, u = len(x), self.width
        y: FloatArray
        if self.band is not None:
            y = dsbmv(u, 1.0, self.band, x, lower=1)
        else:
            # The room that dgbtrf wants above the band counts as u more diagonals of zeros, for SciPy would
            # copy a part of the columns; and it refuses fewer rows than diagonals: more of zeros, then.
            rows = max(m, 3 * u + 1)
            if trans:
                x = np.concatenate((x, np.zeros(rows - m)))
            y = dgbmv(rows, m, u, 2 * u, 1.0, self.full, x, trans=trans)[:m]
        return y
