"""Where the time of steps goes: the clock is read wherever one part of an iteration hands over to another."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf
from typing import ParamSpec, TypeVar

from dismech_cli.arrays import FloatArray
from dismech_cli.kernels.driver import Driver
from dismech_cli.kernels.linearization import Coupling, Linearization, Pattern
from dismech_cli.model.configuration import Configuration
from dismech_cli.model.state import State
from dismech_cli.model.term import BoundEnergy, BoundTerm, Term
from dismech_cli.run.simulation import Simulation
from dismech_cli.solve.linear.factors import Factors, LinearSolver
from dismech_cli.solve.step import Stepper

from .scenes import stepper_of

_P = ParamSpec("_P")
_R = TypeVar("_R")

PARTS = ("configuration", "terms", "assembly", "factorise", "solve", "rest")


class Split:
    """CPU time by part, each without the parts that it calls: together they are the whole.

    Attributes:
        least: Time of each part [s] in the lap that took least.
    """

    def __init__(self) -> None:
        self.least = dict.fromkeys(PARTS, inf)

    def lap(self, action: Callable[[], object]) -> None:
        """Run an action that calls timed functions."""
        self._spent = dict.fromkeys(PARTS, 0.0)
        self._part, self._since = "rest", time.process_time()
        action()
        self._enter("rest")
        if sum(self._spent.values()) < sum(self.least.values()):
            self.least = self._spent

    def timed(self, part: str, function: Callable[_P, _R]) -> Callable[_P, _R]:
        """The function, its time booked on a part."""

        def call(*arguments: _P.args, **named: _P.kwargs) -> _R:
            before = self._enter(part)
            result = function(*arguments, **named)
            self._enter(before)
            return result

        return call

    def _enter(self, part: str) -> str:
        """Book the time since the last reading; return the part that it was spent in."""
        now, before = time.process_time(), self._part
        self._spent[before] += now - self._since
        self._part, self._since = part, now
        return before


@dataclass(frozen=True)
class _TimedTerm:
    """A term that is bound to one whose linearisation is booked."""

    term: Term
    split: Split

    @property
    def name(self) -> str:
        return self.term.name

    @property
    def velocity_dependent(self) -> bool:
        return self.term.velocity_dependent

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        return self.term.couplings

    def bind(self, pattern: Pattern, driver: Driver) -> _TimedBound:
        return _TimedBound(self.term.bind(pattern, driver), self.split)


@dataclass(frozen=True)
class _TimedBound:
    """A bound term whose linearisation is booked on the terms."""

    term: BoundTerm
    split: Split

    @property
    def name(self) -> str:
        return self.term.name

    @property
    def potential(self) -> BoundEnergy | None:
        return self.term.potential

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        self.term.add_residual(c, r)

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        self.split.timed("terms", self.term.add_linearization)(c, into)


@dataclass(frozen=True)
class _TimedSolver:
    """A solver that books its factorisations, and the solutions with its factors."""

    solver: LinearSolver
    split: Split

    @property
    def name(self) -> str:
        return self.solver.name

    def factorize(self, values: FloatArray) -> _TimedFactors:
        return _TimedFactors(self.split.timed("factorise", self.solver.factorize)(values), self.split)

    def nearly(self, values: FloatArray, cheap: float) -> _TimedFactors | None:
        made = self.split.timed("factorise", self.solver.nearly)(values, cheap)
        return None if made is None else _TimedFactors(made, self.split)


@dataclass(frozen=True)
class _TimedFactors:
    """Factors whose solutions are booked."""

    factors: Factors
    split: Split

    @property
    def indefinite(self) -> bool:
        return self.factors.indefinite

    @property
    def price(self) -> float:
        return self.factors.price

    def solve(self, rhs: FloatArray) -> FloatArray:
        return self.split.timed("solve", self.factors.solve)(rhs)

    def solve_transposed(self, rhs: FloatArray) -> FloatArray:
        return self.split.timed("solve", self.factors.solve_transposed)(rhs)


def timed_stepper(simulation: Simulation, state: State, split: Split) -> Stepper:
    """A stepper bound at a state that books its time.

    It steps in Python: what runs within one compiled function cannot be told apart.
    """
    terms = tuple(_TimedTerm(term, split) for term in simulation.model.terms)
    stepper = stepper_of(replace(simulation, model=replace(simulation.model, terms=terms)))
    stepper.prepare(state)
    stepper.system._looked, stepper.system._woven = True, None
    for owner, method, part in (
        (stepper.system, "configuration", "configuration"),
        (stepper.system, "linearize", "assembly"),
    ):
        setattr(owner, method, split.timed(part, getattr(owner, method)))
    stepper.system.solver = _TimedSolver(stepper.system.solver, split)
    return stepper
