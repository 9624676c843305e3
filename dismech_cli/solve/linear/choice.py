"""The table of linear solvers, and the choice among them by structure."""

from __future__ import annotations

from collections.abc import Callable

from ..pattern import SparsityPattern
from .pardiso import PardisoSolver, pardiso_available
from .solver import BandedSolver, DenseSolver, LinearSolver, SuperLuSolver

LINEAR_SOLVERS: dict[str, Callable[[], LinearSolver]] = {
    "dense": DenseSolver,
    "banded": BandedSolver,
    "pardiso": PardisoSolver,
    "superlu": SuperLuSolver,
}

# Measured (benchmarks/linear_solvers.py): a band wins up to this width wherever two joints make one, and
# a matrix below this order is full.
DENSE_LIMIT = 8
BAND_LIMIT = 40


def choose_solver(pattern: SparsityPattern) -> str:
    """Name of the fastest solver for a pattern."""
    if pattern.m <= DENSE_LIMIT:
        return "dense"
    if pattern.bandwidth <= BAND_LIMIT:
        return "banded"
    return "pardiso" if pardiso_available() else "superlu"
