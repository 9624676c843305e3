"""Number of negative eigenvalues of a tangent: buckling of static equilibria."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TypeAlias

import numpy as np

from ...arrays import FloatArray
from ..pattern import SparsityPattern
from .factors import FactorizationError
from .pardiso import InertiaCounter, pardiso_available

# Up to this order the full matrix is factorised within a millisecond; MKL takes half a second to load.
_DENSE_LIMIT = 500

# From stored entries, shape (slots,), to the number; raises FactorizationError where the matrix is singular
# or not finite.
CountNegative: TypeAlias = Callable[[FloatArray], int]


def negative_eigenvalues_on(pattern: SparsityPattern) -> CountNegative:
    """What counts negative eigenvalues on a symmetric pattern, by LDL^T factors (Sylvester's law).

    Keep it as long as the pattern: PARDISO analyses that once, at the first count.
    """
    if pattern.m <= _DENSE_LIMIT:
        return partial(_from_dense, pattern)
    if pardiso_available():
        return InertiaCounter(pattern).count
    return partial(_from_superlu, pattern)


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
