"""The table of linear solvers, and the choice among them by structure."""

from __future__ import annotations

from collections.abc import Callable

from ..pattern import Sized, SparsityPattern
from .banded import BandedSolver
from .dense import DenseSolver
from .factors import LinearSolver
from .pardiso import PardisoSolver, pardiso_available
from .superlu import SuperLuSolver

LINEAR_SOLVERS: dict[str, Callable[[SparsityPattern], LinearSolver]] = {
    "dense": DenseSolver,
    "banded": BandedSolver,
    "pardiso": PardisoSolver,
    "superlu": SuperLuSolver,
}

# Measured (benchmarks/linear_solvers.py): a band wins up to this width wherever two joints make one, and
# a matrix below this order is full.
DENSE_LIMIT = 8
BAND_LIMIT = 40


def choose_solver(pattern: Sized, *, spreads: bool = False) -> str:
    """Name of the fastest solver for a pattern.

    Args:
        pattern: The pattern.
        spreads: Whether entries anywhere in the matrix may join it during a run, which no band can take.
    """
    if pattern.m <= DENSE_LIMIT:
        return "dense"
    if pattern.bandwidth <= BAND_LIMIT and not spreads:
        return "banded"
    return "pardiso" if pardiso_available() else "superlu"
