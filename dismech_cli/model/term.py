"""Protocols of the semi-discrete system M a + r(q, v, t) = 0.

A term is three things: which DOFs it couples, its share of the residual, its tangent blocks. It
is bound once to a sparsity pattern and then only adds numbers into arrays. One sign convention:
the residual share is +dE/dq of an energy and -f of a force.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

from ..arrays import FloatArray, IntArray

if TYPE_CHECKING:
    from .configuration import Configuration
    from .driver import Driver


@dataclass(frozen=True, slots=True)
class Coupling:
    """DOFs that a term couples pairwise.

    Attributes:
        dofs: Global DOF indices, shape (S, D): each row is a clique of the sparsity pattern.
        symmetric: Whether the tangent is symmetric.
    """

    dofs: IntArray
    symmetric: bool = True


class Pattern(Protocol):
    """Where the tangent entries of free DOFs live; fixed DOFs share one spare slot at the end."""

    @property
    def slots(self) -> int:
        """Length of the value arrays: stored entries plus the spare slot."""

    def symmetric_slots(self, i: IntArray, j: IntArray) -> IntArray:
        """Slot of the unordered pair {i, j}: the entry in the upper triangle."""

    def slots_of(self, row: IntArray, column: IntArray) -> IntArray:
        """Slot of entry (row, column) of a pattern that stores both triangles."""


@dataclass(frozen=True, slots=True)
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


class BoundTerm(Protocol):
    """A term that knows its place in the matrix."""

    @property
    def name(self) -> str:
        """Unique name, e.g. ``"beam.stretch"``; it labels, it never chooses behaviour."""

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        """Add the residual share to ``r``, shape (n,) [N, N m]."""

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Add residual and tangent values."""


@runtime_checkable
class BoundEnergy(BoundTerm, Protocol):
    """A bound term whose residual is the gradient of an energy at fixed time."""

    @property
    def shares(self) -> tuple[str, ...]:
        """Names of the parts of the energy in the account."""

    def energy(self, c: Configuration) -> FloatArray:
        """Energies [J], shape (shares, S): a row per part, a column per stencil."""


class Term(Protocol):
    """A physical contribution, before it is bound to a matrix."""

    @property
    def name(self) -> str:
        """Unique name."""

    @property
    def dissipative(self) -> bool:
        """Whether the residual depends on velocity."""

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """DOF cliques of the tangent; empty for loads that add to the residual only."""

    def bind(self, pattern: Pattern, driver: Driver) -> BoundTerm:
        """Look the matrix positions up once and choose the compiled or the NumPy text."""
