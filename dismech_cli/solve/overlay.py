"""Terms whose stencils come and go, on an extension of the pattern of all others."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..arrays import FloatArray
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Linearization, RankOne
from ..model.configuration import Configuration
from ..model.term import BoundChanging, ChangingTerm
from .pattern import Extension, SparsityPattern


class Overlay:
    """The changing terms of a system with their place in the matrix.

    The pattern grows when a coupling comes that it lacks. What it had of the present step stays in it, so
    that a stencil on the brink does not change it at every iterate; what is older goes at the next growth.

    Attributes:
        terms: All changing terms, bound.
        pattern: The base pattern with the couplings of these terms.
    """

    def __init__(self, base: SparsityPattern, changing: Sequence[ChangingTerm], driver: Driver) -> None:
        self._base = base
        bound = [(term.symmetric, term.start(driver)) for term in changing]
        self._symmetric = [term for symmetric, term in bound if symmetric]
        self._general = [term for symmetric, term in bound if not symmetric]
        self.terms: tuple[BoundChanging, ...] = (*self._symmetric, *self._general)
        self._moved = False
        self._of_step: list[Coupling] = []
        self._extend()

    def start_step(self) -> None:
        """Forget the couplings of the last step; the pattern keeps them until it grows."""
        self._of_step = []

    def detect(self, c: Configuration) -> None:
        """Find the stencils at a trial point."""
        for term in self.terms:
            self._moved |= term.detect(c)

    def follow(self) -> bool:
        """Give the stencils their places; True if the pattern had to grow."""
        if not self._moved:
            return False
        self._moved = False
        present = [coupling for term in self.terms for coupling in term.couplings]
        self._of_step += present
        grown = not self._extension.pattern.holds(present)
        if grown:
            self._extend()
        else:
            self._place()
        return grown

    def add(self, c: Configuration, residual: FloatArray, rank_ones: list[RankOne]) -> Iterator[None]:
        """Add the terms' residuals and tangents, pausing after each of them."""
        into = self._into
        into.residual, into.rank_ones = residual, rank_ones
        into.stiffness[:] = 0.0
        into.damping[:] = 0.0
        for term in self._symmetric:
            term.add_linearization(c, into)
            yield
        if self._mirror is not None:
            lower, upper = self._mirror
            into.stiffness[lower] = into.stiffness[upper]
            into.damping[lower] = into.damping[upper]
        for term in self._general:
            term.add_linearization(c, into)
            yield

    def total(self, base: FloatArray, position: float, velocity: float) -> FloatArray:
        """Tangent values of all terms: those of the base pattern and, weighted, these; a buffer.

        Args:
            base: Values of the base pattern, shape (its slots,).
            position: Weight of the stiffness.
            velocity: Weight of the damping.
        """
        values = self._into.stiffness
        values *= position
        values += velocity * self._into.damping
        values[self._extension.base_slots] += base
        return values

    def longest_step(self, start: Configuration, end: Configuration) -> float:
        """Part of the way from ``start`` to ``end`` that all terms allow."""
        return min(term.longest_step(start, end) for term in self.terms)

    @property
    def pattern(self) -> SparsityPattern:
        """See the class."""
        return self._extension.pattern

    def _extend(self) -> None:
        self._extension: Extension = self._base.extended(self._of_step)
        pattern = self._extension.pattern
        self._into = Linearization(np.empty(0), np.zeros(pattern.slots), np.zeros(pattern.slots))
        self._mirror = None if pattern.symmetric else self._extension.mirror()
        self._place()

    def _place(self) -> None:
        for term in self.terms:
            term.place(self._extension.pattern)
