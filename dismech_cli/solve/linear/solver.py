"""Direct linear solvers behind one protocol, chosen by structure.

Every solver analyses a pattern once, factorises values many times, and checks the residual of
every solve: PARDISO returns finite garbage for a singular matrix without an error.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from ...arrays import FloatArray
from ..pattern import SparsityPattern

# A residual above the first share of the right-hand side is refined once; what rounding leaves of a
# good solution of the stiffest slender rods reaches 1e-2, a singular matrix leaves as much as it got.
RESIDUAL_GOAL, RESIDUAL_LIMIT = 1e-6, 0.1


class FactorizationError(ArithmeticError):
    """The matrix is singular or not finite."""


class LinearSolver(Protocol):
    """Solves J x = b for a fixed sparsity pattern."""

    name: str

    @property
    def indefinite(self) -> bool:
        """Whether the last matrix is known to have a negative eigenvalue; no unsymmetric one is."""

    def analyze(self, pattern: SparsityPattern) -> None:
        """Prepare storage, ordering and symbolic factorisation; once per pattern."""

    def factorize(self, values: FloatArray) -> None:
        """Factorise; raise :class:`FactorizationError` if that is impossible.

        Args:
            values: Stored entries, shape (slots,).
        """

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Solve with the last factors; raise :class:`FactorizationError` on a bad residual."""


def solve_updated(solver: LinearSolver, columns: FloatArray, rows: FloatArray, rhs: FloatArray) -> FloatArray:
    """Solve with the last factors and an update of low rank, (A + columns rows^T) x = rhs (Woodbury).

    Args:
        solver: Keeps the factors of A.
        columns: shape (m, k), k small.
        rows: shape (m, k).
        rhs: shape (m,).

    Raises:
        FactorizationError: The updated matrix is singular.
    """
    x = solver.solve(rhs)
    if columns.shape[1] == 0:
        return x
    z = np.stack([solver.solve(column) for column in columns.T], axis=1)
    try:
        weights = np.linalg.solve(np.eye(columns.shape[1]) + rows.T @ z, rows.T @ x)
    except np.linalg.LinAlgError as error:
        raise FactorizationError(str(error)) from error
    return np.asarray(x - z @ weights)


def checked(
    rhs: FloatArray,
    x: FloatArray,
    product: Callable[[FloatArray], FloatArray],
    again: Callable[[FloatArray], FloatArray],
) -> FloatArray:
    """Return ``x``, refined once if its residual asks for it."""
    size = float(np.abs(rhs).max(initial=0.0))
    for limit in (RESIDUAL_GOAL, RESIDUAL_LIMIT):
        defect = rhs - product(x)
        error = float(np.abs(defect).max(initial=0.0))
        if error <= limit * size:
            return x
        if not np.isfinite(error):
            break
        x = x + again(defect)
    raise FactorizationError("the linear system is singular: some part is free to move")


class DenseSolver:
    """LAPACK LU of the full matrix, for a handful of free DOFs."""

    name = "dense"

    def analyze(self, pattern: SparsityPattern) -> None:
        """Allocate the matrix."""
        self._pattern = pattern
        self._matrix = np.zeros((pattern.m, pattern.m), order="F")
        self._rows = pattern.rows

    def factorize(self, values: FloatArray) -> None:
        """Factorise by LU with partial pivoting."""
        from scipy.linalg.lapack import dgetrf

        p = self._pattern
        self._matrix[self._rows, p.indices] = values[: p.nnz]
        if p.symmetric:
            self._matrix[p.indices, self._rows] = values[: p.nnz]
        self._lu, self._pivots, info = dgetrf(self._matrix)
        if info != 0 or not np.isfinite(self._lu).all():
            raise FactorizationError("the matrix is singular or not finite")

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Solve with the last factors."""
        return checked(rhs, self._solve(rhs), lambda x: self._matrix @ x, self._solve)

    @property
    def indefinite(self) -> bool:
        """By the eigenvalues: the matrix is tiny."""
        return self._pattern.symmetric and float(np.linalg.eigvalsh(self._matrix)[0]) < 0.0

    def _solve(self, rhs: FloatArray) -> FloatArray:
        from scipy.linalg.lapack import dgetrs

        x: FloatArray = dgetrs(self._lu, self._pivots, rhs)[0]
        return x


class BandedSolver:
    """LAPACK banded Cholesky, with banded LU where the matrix is indefinite or unsymmetric.

    Chains of rods are narrow bands in the pattern's numbering; nothing is faster on them.
    """

    name = "banded"

    def analyze(self, pattern: SparsityPattern) -> None:
        """Allocate the bands and tabulate where each entry goes."""
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

    def factorize(self, values: FloatArray) -> None:
        """Cholesky first where the matrix is symmetric, LU otherwise."""
        from scipy.linalg.lapack import dpbtrf

        p = self._pattern
        if p.symmetric:
            self._lower[self._lower_place] = values[: p.nnz]
            factor, info = dpbtrf(self._band, lower=1)
            if info == 0:
                self._cholesky, self._lu = factor, None
                return
        self._factorize_lu(values)

    def _factorize_lu(self, values: FloatArray) -> None:
        from scipy.linalg.lapack import dgbtrf

        p, u = self._pattern, self._width
        if self._full is None:
            self._full = np.zeros((3 * u + 1) * p.m)
        self._full[self._full_place] = values[: p.nnz]
        if p.symmetric:
            self._full[self._full_transposed] = values[: p.nnz]
        lu, pivots, info = dgbtrf(self._full.reshape(3 * u + 1, p.m, order="F"), u, u)
        if info != 0 or not np.isfinite(lu).all():
            raise FactorizationError("the matrix is singular or not finite")
        self._lu, self._pivots = lu, pivots

    @property
    def indefinite(self) -> bool:
        """Cholesky's method failed."""
        return self._pattern.symmetric and self._lu is not None

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Solve with the last factors."""
        return checked(rhs, self._solve(rhs), self._product, self._solve)

    def _solve(self, rhs: FloatArray) -> FloatArray:
        from scipy.linalg.lapack import dgbtrs, dpbtrs

        x: FloatArray
        if self._lu is None:
            x = dpbtrs(self._cholesky, rhs, lower=1)[0]
        else:
            x = dgbtrs(self._lu, self._width, self._width, rhs, self._pivots)[0]
        return x

    def _product(self, x: FloatArray) -> FloatArray:
        from scipy.linalg.blas import dgbmv, dsbmv

        p, u = self._pattern, self._width
        y: FloatArray
        if p.symmetric:
            y = dsbmv(u, 1.0, self._band, x, lower=1)
        else:
            assert self._full is not None
            # The room that dgbtrf wants above the band counts as u more diagonals of zeros, for SciPy would
            # copy a part of the columns; and it refuses fewer rows than diagonals: more of zeros, then.
            full = self._full.reshape(3 * u + 1, p.m, order="F")
            y = dgbmv(max(p.m, 3 * u + 1), p.m, u, 2 * u, 1.0, full, x)[: p.m]
        return y


class SuperLuSolver:
    """SuperLU: always present, the fallback where MKL has no wheels."""

    name = "superlu"

    def analyze(self, pattern: SparsityPattern) -> None:
        """Tabulate the compressed columns of the full matrix."""
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

    def factorize(self, values: FloatArray) -> None:
        """Factorise, in symmetric mode where the matrix is symmetric."""
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
            self._factors = splu(self._matrix, **options)
        except RuntimeError as error:
            raise FactorizationError(str(error)) from error

    @property
    def indefinite(self) -> bool:
        """A negative pivot, or one so small that rows were exchanged."""
        if not self._symmetric:
            return False
        exchanged = not np.array_equal(self._factors.perm_r, self._factors.perm_c)
        return exchanged or bool((self._factors.U.diagonal() < 0.0).any())

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Solve with the last factors."""
        return checked(rhs, self._factors.solve(rhs), self._product, self._factors.solve)

    def _product(self, x: FloatArray) -> FloatArray:
        return np.asarray(self._matrix @ x)
