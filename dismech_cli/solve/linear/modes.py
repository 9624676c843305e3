"""The softest modes of a stiffness: K x = mu M x with the lowest eigenvalues mu."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray
from ..pattern import SparsityPattern
from .factors import FactorizationError, LinearSolver

# Up to this order all modes of the full matrix are found within a fraction of a second.
_DENSE_LIMIT = 600
# Shift below zero, in units of the typical ratio of stiffness to mass: rigid motions leave K singular.
_SHIFT = 1e-9
# Restarts of Lanczos' method; a few are usual, and modes that lie too close together are never told apart.
_RESTARTS = 50


def softest_modes(
    pattern: SparsityPattern, solver: LinearSolver, values: FloatArray, mass: FloatArray, count: int
) -> tuple[FloatArray, FloatArray]:
    """Eigenvalues (k,), rising, and eigenvectors (m, k) of unit mass; k is ``count`` or what there are.

    Args:
        pattern: A symmetric pattern of order m.
        solver: Factorises matrices on it.
        values: Stored entries of K, shape (slots,); changed.
        mass: Diagonal of M, all positive, shape (m,).
        count: How many are wanted.

    Raises:
        FactorizationError: They cannot be found.
    """
    if not np.isfinite(values).all():
        raise FactorizationError("the stiffness is not finite")
    if pattern.m <= _DENSE_LIMIT or count >= pattern.m - 1:
        return _dense(pattern, values, mass, count)
    from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

    shift = _SHIFT * float(np.median(values[pattern.diagonal] / mass))
    values[pattern.diagonal] += shift * mass
    factors, root = solver.factorize(values), np.sqrt(mass)
    inverse = LinearOperator(
        (pattern.m, pattern.m), matvec=lambda x: root * factors.solve(root * np.ravel(x)), dtype=np.float64
    )
    start = np.random.default_rng(0).standard_normal(pattern.m)
    try:
        largest, vectors = eigsh(inverse, k=count, which="LM", v0=start, maxiter=_RESTARTS)
    except ArpackError as error:
        raise FactorizationError(str(error)) from error
    sizes = 1.0 / largest - shift
    order = np.argsort(sizes)
    return sizes[order], vectors[:, order] / root[:, None]


def _dense(
    pattern: SparsityPattern, values: FloatArray, mass: FloatArray, count: int
) -> tuple[FloatArray, FloatArray]:
    root = np.sqrt(mass)
    full = np.zeros((pattern.m, pattern.m))
    full[pattern.rows, pattern.indices] = values[: pattern.nnz]
    full = np.triu(full) + np.triu(full, 1).T
    sizes, vectors = np.linalg.eigh(full / root / root[:, None])
    return sizes[:count], vectors[:, :count] / root[:, None]
