"""What a term adds to the matrix: which DOFs it couples, and the buffers that take its numbers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen


@frozen
class Coupling:
    """DOFs that a term couples pairwise.

    Attributes:
        dofs: Global DOF indices, shape (S, D): each row is a clique of the sparsity pattern.
        symmetric: Whether the tangent is symmetric.
    """

    dofs: IntArray
    symmetric: bool = True


def all_symmetric(couplings: Iterable[Coupling]) -> bool:
    """Whether all tangents are symmetric: one triangle is stored then."""
    return all(coupling.symmetric for coupling in couplings)


class Pattern(Protocol):
    """Where the tangent entries of free DOFs live; fixed DOFs share one spare slot at the end."""

    @property
    def slots(self) -> int:
        """Length of the value arrays: stored entries plus the spare slot."""

    @property
    def order(self) -> IntArray:
        """Matrix index of each DOF, -1 if fixed, shape (n,)."""

    @property
    def indptr(self) -> IntArray:
        """Where each row begins among the stored entries, shape (m + 1,)."""

    @property
    def indices(self) -> IntArray:
        """Column of each stored entry, ascending in a row, shape (slots - 1,)."""

    def symmetric_slots(self, i: IntArray, j: IntArray) -> IntArray:
        """Slot of the unordered pair {i, j}: the entry in the upper triangle."""

    def slots_of(self, row: IntArray, column: IntArray) -> IntArray:
        """Slot of entry (row, column) of a pattern that stores both triangles."""


@frozen
class RankOne:
    """A tangent that couples all with all, as an outer product: too full for a sparse pattern.

    Attributes:
        column: shape (n,).
        by_q: dr/dq is ``column by_q^T``, shape (n,).
        by_v: dr/dv is ``column by_v^T``, shape (n,).
    """

    column: FloatArray
    by_q: FloatArray
    by_v: FloatArray


@dataclass(slots=True)
class Linearization:
    """Buffers that terms add into; made once per pattern, cleared before every assembly.

    Attributes:
        residual: r [N, N m], shape (n,), fixed DOFs included: there it is the reaction.
        stiffness: Values of dr/dq, shape (slots,).
        damping: Values of dr/dv, shape (slots,).
        rank_ones: Tangents outside the pattern.
    """

    residual: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    rank_ones: list[RankOne] = field(default_factory=list)

    @classmethod
    def of(cls, n: int, slots: int) -> Linearization:
        """Allocate for ``n`` DOFs and ``slots`` values."""
        return cls(np.zeros(n), np.zeros(slots), np.zeros(slots))
