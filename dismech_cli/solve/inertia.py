"""Number of negative eigenvalues of a tangent: buckling of static equilibria."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from .linear import FactorizationError
from .pardiso import InertiaCounter, pardiso_available
from .pattern import SparsityPattern

# Up to this order the full matrix is factorised within a millisecond; MKL takes half a second to load.
_DENSE_LIMIT = 500


def negative_eigenvalues(pattern: SparsityPattern, values: FloatArray) -> int:
    """Count negative eigenvalues of a symmetric matrix by its LDL^T factors (Sylvester's law).

    Args:
        pattern: A symmetric pattern.
        values: Stored entries, shape (slots,).

    Raises:
        FactorizationError: The matrix is singular or not finite.
    """
    if pattern.m <= _DENSE_LIMIT:
        return _from_dense(pattern, values)
    if pardiso_available():
        return InertiaCounter(pattern).count(values)
    return _from_superlu(pattern, values)


def _from_dense(pattern: SparsityPattern, values: FloatArray) -> int:
    """Bunch-Kaufman pivots of the full matrix; a pivot block of two has one negative eigenvalue."""
    from scipy.linalg.lapack import dsytrf

    full = np.zeros((pattern.m, pattern.m), order="F")
    full[pattern.rows, pattern.indices] = values[: pattern.nnz]
    factors, pivots, info = dsytrf(full)
    if info != 0 or not np.isfinite(factors).all():
        raise FactorizationError("the matrix is singular or not finite")
    single = pivots > 0
    return int((factors.diagonal()[single] < 0.0).sum()) + int((~single).sum()) // 2


def _from_superlu(pattern: SparsityPattern, values: FloatArray) -> int:
    """Signs of U's diagonal: without row exchanges L U is L D L^T."""
    from scipy.sparse import triu
    from scipy.sparse.linalg import splu

    upper = pattern.csr(values)
    full = (upper + triu(upper, k=1).T).tocsc()
    try:
        factors = splu(
            full, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
    except RuntimeError as error:
        raise FactorizationError(str(error)) from error
    if not np.array_equal(factors.perm_r, factors.perm_c):
        raise FactorizationError("a zero pivot forced a row exchange")
    return int((factors.U.diagonal() < 0.0).sum())
