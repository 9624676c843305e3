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

    A step begins with the couplings that its first trial point has, no others: it depends on where it
    starts, not on what came before, as a resumed run must. Within the step the pattern grows when a coupling
    comes that it lacks, and what it had stays, so that a stencil on the brink does not change it at every
    iterate.

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
        self._moved, self._begins = False, True
        self._of_step: list[Coupling] = []
        self._extend()

    def start_step(self) -> None:
        """Let go of what the last step had, at the next trial point."""
        self._begins = True

    def detect(self, c: Configuration) -> None:
        """Find the stencils at a trial point."""
        for term in self.terms:
            self._moved |= term.detect(c)

    def follow(self) -> bool:
        """Give the stencils their places; True if that took another pattern."""
        if not (self._moved or self._begins):
            return False
        present = [coupling for term in self.terms for coupling in term.couplings]
        entries = self._base.entries(present)
        if self._begins:
            fits = np.array_equal(entries, self._extension.entries)
            self._of_step = present
        else:
            fits = self._extension.pattern.holds(entries)
            self._of_step += present
        if not fits:
            self._extend()
        elif self._moved:
            self._place()
        self._moved = self._begins = False
        return not fits

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
