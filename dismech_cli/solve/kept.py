"""Factors that are kept within a step: where they cost much, the next solves are iterations on them.

Tangents of one step differ little, and factors of one of them nearly solve with another: conjugate
gradients, or generalised conjugate residuals where the matrix is not symmetric, take two to four solutions.
A step begins with factors of its own: it depends on the state that it starts from and on nothing else, and
whether its tangent is indefinite is seen in every step.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..arrays import FloatArray
from .assembly import Linearized
from .linear.factors import FactorizationError, Factors, LinearSolver
from .linear.iterations import conjugate_gradients, conjugate_residuals
from .pattern import SparsityPattern

# What is left of a right-hand side, as a share: less changes no digit that Newton's next iterate keeps
# (kept factors in docs/performance.md).
_LEFT = 1e-3
# Factors cheaper than this many solutions are made anew.
_CHEAP = 5.0


@dataclass(slots=True)
class Kept:
    """What one step keeps.

    Attributes:
        solver: Whose factors they are, which another factorisation overwrites; None where there are none.
        factors: The last ones.
    """

    solver: LinearSolver | None = None
    factors: Factors | None = None

    def keep(self, solver: LinearSolver, factors: Factors) -> None:
        """Keep factors that were made just now, if they are worth it."""
        self.solver, self.factors = (
            (None, None) if factors.indefinite or factors.price < _CHEAP else (solver, factors)
        )

    def begin(self, solver: LinearSolver, values: FloatArray) -> bool:
        """Keep factors of a tangent in single precision; whether there are any worth it."""
        self.drop()
        rough = solver.nearly(values, _CHEAP)
        if rough is not None:
            self.solver, self.factors = solver, rough
        return rough is not None

    def drop(self) -> None:
        """Keep none: others are about to be made."""
        self.solver = self.factors = None

    def solve(
        self, solver: LinearSolver, pattern: SparsityPattern, now: Linearized, rhs: FloatArray
    ) -> FloatArray | None:
        """Solve with a tangent near the factorised one; None where it is too far, or nothing is kept.

        Args:
            solver: That of the tangent's pattern.
            pattern: Places of the tangent.
            now: Residual and tangent.
            rhs: Right-hand side, shape (m,).
        """
        factors = self.factors
        if factors is None or solver is not self.solver:
            return None

        def product(x: FloatArray) -> FloatArray:
            outside: FloatArray = now.columns @ (now.rows.T @ x)
            return pattern.product(now.values, x) + outside

        symmetric = pattern.symmetric and not now.columns.shape[1]
        iterate = conjugate_gradients if symmetric else conjugate_residuals
        try:
            return iterate(factors.solve, product, rhs, _LEFT, int(factors.price))
        except FactorizationError:
            return None
