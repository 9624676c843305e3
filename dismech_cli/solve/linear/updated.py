"""Factors of a matrix with an update of low rank, A + columns rows^T (Woodbury)."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray
from ...frozen import frozen
from .factors import FactorizationError, Factors, Linear


@frozen
class UpdatedFactors:
    """Factors of A and an update of k columns, few.

    Attributes:
        factors: Those of A.
        columns: shape (m, k).
        rows: shape (m, k).
    """

    factors: Factors
    columns: FloatArray
    rows: FloatArray

    @property
    def indefinite(self) -> bool:
        """Never known: the update is not symmetric."""
        return False

    @property
    def price(self) -> float:
        """That of A."""
        return self.factors.price

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Solve (A + columns rows^T) x = rhs."""
        return _woodbury(self.factors.solve, self.columns, self.rows, rhs)

    def solve_transposed(self, rhs: FloatArray) -> FloatArray:
        """Solve (A^T + rows columns^T) x = rhs."""
        return _woodbury(self.factors.solve_transposed, self.rows, self.columns, rhs)


def _woodbury(solve: Linear, columns: FloatArray, rows: FloatArray, rhs: FloatArray) -> FloatArray:
    k = columns.shape[1]
    # one call for all: of small matrices it is the call that costs
    both = solve(np.column_stack((rhs, columns)))
    x, z = both[:, :-k].reshape(rhs.shape), both[:, -k:]
    try:
        weights = np.linalg.solve(np.eye(k) + rows.T @ z, rows.T @ x)
    except np.linalg.LinAlgError as error:
        raise FactorizationError(str(error)) from error
    return np.asarray(x - z @ weights)
