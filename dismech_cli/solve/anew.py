"""What comes and goes, found anew at every trial point: what it does there depends on that alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..arrays import FloatArray, IntArray
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Linearization
from ..kinematics.rod_frames import TrialFrames
from ..model.configuration import Configuration
from ..model.term import BoundChanging, ChangingSet, ChangingTerm
from ..model.touch import Touch
from .integrators import Integrator
from .pattern import SparsityPattern
from .solved import solved
from .tape import TapedStep


class Anew:
    """Sets of changing terms without a past."""

    def __init__(self, changing: Sequence[ChangingTerm], driver: Driver) -> None:
        """Start them.

        Args:
            changing: The terms; :meth:`~.term.ChangingTerm.untold` of none of them tells anything.
            driver: Runs their kernels.
        """
        self._sets: tuple[ChangingSet, ...] = tuple(term.start(driver) for term in changing)
        self._terms: tuple[BoundChanging, ...] = tuple(term for one in self._sets for term in one.terms)
        self._placed: tuple[Coupling, ...] | None = None

    def look(self, c: Configuration) -> tuple[Coupling, ...]:
        """Find what is there at a trial point; the couplings of its stencils."""
        for one in self._sets:
            one.recall({})
            one.detect(c)
        return tuple(coupling for one in self._sets for coupling in one.couplings)

    def place(self, c: Configuration, pattern: SparsityPattern) -> None:
        """Find what is there, and its places in a pattern that holds it."""
        found, last = self.look(c), self._placed
        if (
            last is None
            or len(found) != len(last)
            or any(a is not b for a, b in zip(found, last, strict=True))
        ):
            for term in self._terms:
                term.place(pattern)
            self._placed = found

    def add(self, c: Configuration, into: Linearization, *, symmetric: bool) -> None:
        """Add the terms that have symmetric tangents, or the others, where their places are."""
        for term in self._terms:
            if term.symmetric == symmetric:
                term.add_linearization(c, into)

    def residual(self, c: Configuration) -> FloatArray:
        """Of all terms, shape (n,)."""
        self.look(c)
        r = np.zeros_like(c.q)
        for term in self._terms:
            term.add_residual(c, r)
        return r

    def touch(self, c: Configuration) -> tuple[Touch, ...]:
        """What touches."""
        self.look(c)
        return tuple(one.touch(c) for one in self._sets)


def met(
    changing: Sequence[ChangingTerm], driver: Driver, integrator: Integrator, steps: Sequence[TapedStep]
) -> tuple[Coupling, ...]:
    """What comes to be coupled at the solutions of all stages of a run, and where its steps start.

    Args:
        changing: Terms that come and go.
        driver: Runs their kernels.
        integrator: Of the run.
        steps: What it did.
    """
    if not changing:
        return ()
    anew = Anew(changing, driver)
    rows: dict[int, list[IntArray]] = {}
    for step in steps:
        for c in _looks(step, integrator):
            for coupling in anew.look(c):
                size = coupling.dofs.shape[1]
                rows.setdefault(size, []).append(coupling.dofs)
                if len(rows[size]) > _MANY:
                    rows[size] = [_distinct(rows[size])]
    symmetric = all(term.symmetric for term in changing)
    return tuple(Coupling(_distinct(found), symmetric) for found in rows.values())


# Lists of cliques are thinned out when there are so many.
_MANY = 64


def _looks(step: TapedStep, integrator: Integrator) -> Iterator[Configuration]:
    """The start of a step, what friction made of that, and the trial points of its stages."""
    start = step.start
    frames = TrialFrames(start.frames, np.empty(0))
    yield Configuration(start.law_time, start.q, start.v, frames, start.inputs)
    v = start.v + step.dt * start.a
    yield Configuration(start.law_time + step.dt, start.q + step.dt * v, v, frames, start.inputs)
    balanced = solved(integrator, [step])
    for t, (q, v, _) in zip(balanced.times, balanced.points, strict=True):
        yield Configuration(t, q, v, frames, start.inputs)


def _distinct(dofs: Sequence[IntArray]) -> IntArray:
    return np.unique(np.concatenate(dofs), axis=0)
