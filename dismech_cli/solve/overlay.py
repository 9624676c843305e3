"""Terms whose stencils come and go, on an extension of the pattern of all others."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np

from ..arrays import FloatArray, IntArray
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Linearization, RankOne
from ..model.configuration import Configuration
from ..model.term import BoundChanging, ChangingSet, ChangingTerm, Memory
from .extender import extender_of
from .pattern import Extension, SparsityPattern
from .watch import Watch

Adding: TypeAlias = Callable[[BoundChanging, Configuration, Linearization], None]
"""How a term adds its tangent."""


def exactly(term: BoundChanging, c: Configuration, into: Linearization) -> None:
    """Add a term with its tangent."""
    term.add_linearization(c, into)


def convexly(term: BoundChanging, c: Configuration, into: Linearization) -> None:
    """Add a term with its tangent made convex."""
    term.add_convex_linearization(c, into)


class Overlay:
    """The changing terms of a system with their place in the matrix.

    A step begins with the couplings that its first trial point has, no others: it depends on where it
    starts and on what the last step left in the state, as a resumed run must. Within the step the
    pattern grows when a coupling comes that it lacks, and what it had stays, so that a stencil on the brink
    does not change it at every iterate.

    Attributes:
        terms: All changing terms, bound.
        sets: What decides on their stencils.
        rubs: Whether any of them depends on velocity.
        watch: Time that they take: what is found and what is added.
    """

    def __init__(self, base: SparsityPattern, changing: Sequence[ChangingTerm], driver: Driver) -> None:
        self._extender, self.watch = extender_of(base, driver), Watch()
        self.sets: tuple[ChangingSet, ...] = tuple(term.start(driver) for term in changing)
        bound = [term for one in self.sets for term in one.terms]
        self._symmetric = [term for term in bound if term.symmetric]
        self._general = [term for term in bound if not term.symmetric]
        self.terms: tuple[BoundChanging, ...] = (*self._symmetric, *self._general)
        self.rubs = any(term.velocity_dependent for term in changing)
        self._moved, self._begins = False, True
        self._of_step: list[Coupling] = []
        self._extend(self._extender.entries(()))

    def recall(self, memory: Memory) -> None:
        """Take up what the last step left, and let go of what it had at the next trial point."""
        self._begins = True
        for one in self.sets:
            one.recall(memory)

    def begin(self, start: Configuration, dt: float) -> None:
        """Make ready for a step of ``dt`` [s]."""
        with self.watch:
            for one in self.sets:
                one.begin(start, dt)

    def detect(self, c: Configuration) -> None:
        """Find the stencils at a trial point."""
        with self.watch:
            for one in self.sets:
                self._moved |= one.detect(c)

    def follow(self) -> bool:
        """Give the stencils their places; True if that took another pattern."""
        with self.watch:
            return self._followed()

    def add(self, c: Configuration, add: Adding, residual: FloatArray, rank_ones: list[RankOne]) -> None:
        """Add the terms' residuals and tangents, in one way or another."""
        with self.watch:
            self._add(c, add, residual, rank_ones)

    def total(self, base: FloatArray, position: float, velocity: float) -> FloatArray:
        """Tangent values of all terms: those of the base pattern and, weighted, these; a buffer.

        Args:
            base: Values of the base pattern, shape (its slots,).
            position: Weight of the stiffness.
            velocity: Weight of the damping.
        """
        values = self._into.stiffness
        if position != 1.0:
            values *= position
        if self.rubs:
            values += velocity * self._into.damping
        self._extender.add_at(base, self._extension.base_slots, values)
        return values

    def longest_step(self, start: Configuration, end: Configuration) -> float:
        """Part of the way from ``start`` to ``end`` that all terms allow."""
        with self.watch:
            return min(one.longest_step(start, end) for one in self.sets)

    def reverses(self, start: Configuration, end: Configuration) -> bool:
        """Whether friction turns round on the way between two trial points."""
        with self.watch:
            return any(one.reverses(start, end) for one in self.sets)

    def settle(self, end: Configuration) -> bool:
        """Whether a step that ended here may stand."""
        with self.watch:
            return all([one.settle(end) for one in self.sets])

    def take_back(self) -> None:
        """Undo what the last :meth:`settle` changed."""
        for one in self.sets:
            one.take_back()

    def put_in(self, start: Configuration) -> float:
        """Energy that the changes of the step put in at its start [J]."""
        return sum(one.put_in(start) for one in self.sets)

    def memory(self) -> dict[str, FloatArray]:
        """What the next step depends on."""
        return {name: values for one in self.sets for name, values in one.memory().items()}

    @property
    def pattern(self) -> SparsityPattern:
        """See the class."""
        return self._extension.pattern

    def _followed(self) -> bool:
        if not (self._moved or self._begins):
            return False
        present = [coupling for one in self.sets for coupling in one.couplings]
        if not self._moved and _same(present, self._of_step):
            self._begins = False
            return False
        entries = self._extender.entries(present)
        if self._begins:
            fits = np.array_equal(entries, self._extension.entries)
            self._of_step = present
        else:
            fits = self._extension.pattern.holds(entries)
            self._of_step += present
            if not fits:
                entries = self._extender.entries(self._of_step)
        if not fits:
            self._extend(entries)
        elif self._moved:
            self._place()
        self._moved = self._begins = False
        return not fits

    def _add(self, c: Configuration, add: Adding, residual: FloatArray, rank_ones: list[RankOne]) -> None:
        into = self._into
        into.residual, into.rank_ones = residual, rank_ones
        into.stiffness[:] = 0.0
        if self.rubs:
            into.damping[:] = 0.0
        for term in self._symmetric:
            add(term, c, into)
        if self._mirror is not None:
            lower, upper = self._mirror
            into.stiffness[lower] = into.stiffness[upper]
            into.damping[lower] = into.damping[upper]
        for term in self._general:
            add(term, c, into)

    def _extend(self, entries: IntArray) -> None:
        self._extension: Extension = self._extender.extended(entries)
        pattern = self._extension.pattern
        self._into = Linearization(np.empty(0), np.zeros(pattern.slots), np.zeros(pattern.slots))
        self._mirror = None if pattern.symmetric else self._extension.mirror()
        self._place()

    def _place(self) -> None:
        for term in self.terms:
            term.place(self._extension.pattern)


def _same(one: Sequence[Coupling], other: Sequence[Coupling]) -> bool:
    """Whether two lists hold the same objects."""
    return len(one) == len(other) and all(a is b for a, b in zip(one, other, strict=True))
