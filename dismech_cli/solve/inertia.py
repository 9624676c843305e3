"""Number of negative eigenvalues of a tangent: buckling of static equilibria."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from .linear import FactorizationError
from .pardiso import InertiaCounter, pardiso_available
from .pattern import SparsityPattern


def negative_eigenvalues(pattern: SparsityPattern, values: FloatArray) -> int:
    """Count negative eigenvalues of a symmetric matrix by its LDL^T factors (Sylvester's law).

    Args:
        pattern: A symmetric pattern.
        values: Stored entries, shape (slots,).

    Raises:
        FactorizationError: The matrix is singular.
    """
    if pardiso_available():
        return InertiaCounter(pattern).count(values)
    return _from_superlu(pattern, values)


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
