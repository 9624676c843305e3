"""What a linear solver is, and what every one of them does with a solution.

A solver is made from a sparsity pattern, factorises values many times, and checks the residual of every
solve: PARDISO returns finite garbage for a singular matrix without an error.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from ...arrays import FloatArray

# A residual above the first share of the right-hand side is refined once; what rounding leaves of a
# good solution of the stiffest slender rods reaches 1e-2, a singular matrix leaves as much as it got.
RESIDUAL_GOAL, RESIDUAL_LIMIT = 1e-6, 0.1

# A factorisation does so many operations in the time of one of a solution, which waits for memory: measured
# on shells of 1 000 to 50 000 triangles, where a factorisation takes 4 to 19 solutions.
_FASTER = 8.0

# Shares of columns in a sum that no chance makes vanish.
_MIX = 0.5 + np.modf(np.arange(1, 65) * 0.6180339887498949)[0]

Linear = Callable[[FloatArray], FloatArray]


class FactorizationError(ArithmeticError):
    """The matrix is singular or not finite."""


class Factors(Protocol):
    """A factorised matrix A; good until its solver factorises again."""

    @property
    def indefinite(self) -> bool:
        """Whether A is known to have a negative eigenvalue; no unsymmetric matrix is."""

    @property
    def price(self) -> float:
        """How many solutions take as long as the factorisation, at least, by the count of entries."""

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Solve A x = rhs, shape (m,) or (m, k); raise :class:`FactorizationError` on a bad residual."""

    def solve_transposed(self, rhs: FloatArray) -> FloatArray:
        """Solve A^T x = rhs likewise."""


class LinearSolver(Protocol):
    """Factorises matrices of the pattern it was made from: storage, ordering and symbolic work are done."""

    @property
    def name(self) -> str:
        """Its key in the table of solvers."""

    def factorize(self, values: FloatArray) -> Factors:
        """Factorise; raise :class:`FactorizationError` if that is impossible.

        Args:
            values: Stored entries, shape (slots,).
        """

    def nearly(self, values: FloatArray, cheap: float) -> Factors | None:
        """Factors in single precision, to iterate on; None where there are none.

        Args:
            values: Stored entries, shape (slots,).
            cheap: Price of factors below which they are not worth it.
        """


def price_of(operations: float, entries: float) -> float:
    """How many solutions a factorisation takes the time of.

    Args:
        operations: Of the factorisation.
        entries: Of the factors; a solution does four operations with each, counted for a symmetric matrix.
    """
    return operations / (_FASTER * 4.0 * entries)


def checked(rhs: FloatArray, solve: Linear, product: Linear) -> FloatArray:
    """Return the solution, refined once if its residual asks for it.

    Args:
        rhs: Right-hand sides, shape (m,) or (m, k).
        solve: Solves as many.
        product: The matrix times one vector.
    """
    x = solve(rhs)
    if x.ndim == 2:
        # a bad solution of any column shows in a sum of all: which one it is, one by one
        size = np.abs(rhs).max(axis=0, initial=0.0)
        mix = _MIX[: len(size)] / np.where(size > 0.0, size, 1.0) if len(size) <= len(_MIX) else None
        if mix is not None and np.abs(rhs @ mix - product(x @ mix)).max(initial=0.0) <= RESIDUAL_GOAL:
            return x
        return np.stack([checked(column, solve, product) for column in rhs.T], axis=1)
    size = float(np.abs(rhs).max(initial=0.0))
    for limit in (RESIDUAL_GOAL, RESIDUAL_LIMIT):
        defect = rhs - product(x)
        error = float(np.abs(defect).max(initial=0.0))
        if error <= limit * size:
            return x
        if not np.isfinite(error):
            break
        x = x + solve(defect)
    raise FactorizationError("the linear system is singular: some part is free to move")
