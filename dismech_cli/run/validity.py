"""Whether a run stays within what its models mean: looked at with every frame, told once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import groupby
from typing import Protocol

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..model.saved import Arrays, Numbers
from .observables.snapshot import Snapshot


class Measure(Protocol):
    """How far a state is from what a model means, element by element."""

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (K,)."""


class Bound(Protocol):
    """Tells that no element has passed its limit by less work than measuring all takes."""

    def __call__(self, s: Snapshot) -> bool:
        """Whether that is sure."""


def unsure(s: Snapshot) -> bool:
    """Never."""
    return False


@frozen
class Check:
    """A limit of a model.

    Attributes:
        measure: Of each of K elements.
        limit: What it may be.
        nodes: A node of each element, shape (K,).
        told: What has happened, from the largest value.
        advice: What that means.
        bound: Asked first; checks in a row may share one.
    """

    measure: Measure
    limit: float
    nodes: IntArray
    told: Callable[[float], str]
    advice: str
    bound: Bound = unsure


class Validity:
    """When each check was first passed, and where and when by most.

    Implements :class:`~dismech_cli.model.saved.Saved`.
    """

    def __init__(self, checks: Sequence[Check]) -> None:
        self._checks = checks
        rows = groupby(enumerate(checks), key=lambda one: id(one[1].bound))
        self._groups = [(group[0][1].bound, group) for group in (list(one) for _, one in rows)]
        # first time, time of the largest value, its element and itself; one row per check
        self._passed = np.tile([np.nan, np.nan, -1.0, -np.inf], (len(checks), 1))

    def look(self, s: Snapshot) -> None:
        """Measure a state where it may have passed anything."""
        for bound, checks in self._groups:
            if not bound(s):
                for row, check in checks:
                    self._measure(s, check, self._passed[row])

    @staticmethod
    def _measure(s: Snapshot, check: Check, passed: FloatArray) -> None:
        values = check.measure(s)
        element = int(np.argmax(values))
        value = float(values[element])
        if not value > check.limit:
            return
        if np.isnan(passed[0]):
            passed[0] = s.state.t
        if value > passed[3]:
            passed[1:] = s.state.t, element, value

    def doubts(self, places: Sequence[str], unit: str) -> tuple[str, ...]:
        """A line for every check that was passed.

        Args:
            places: A word for where each visible node lies.
            unit: Of the time, after a blank.
        """
        return tuple(
            self._line(check, passed, places, unit)
            for check, passed in zip(self._checks, self._passed, strict=True)
            if not np.isnan(passed[0])
        )

    @staticmethod
    def _line(check: Check, passed: FloatArray, places: Sequence[str], unit: str) -> str:
        since, at, element, value = passed.tolist()
        since_then = "" if since == at else f", too far since t = {since:.4g}{unit}"
        where = places[int(check.nodes[int(element)])]
        return f"{check.told(value)} at t = {at:.4g}{unit} near {where}{since_then}: {check.advice}"

    def arrays(self) -> Arrays:
        """What was passed."""
        return {"passed": self._passed}

    def numbers(self) -> Numbers:
        """None."""
        return {}

    def restore(self, arrays: Arrays, numbers: Numbers) -> Validity:
        """Go on from what was passed."""
        self._passed = np.array(arrays["passed"])
        return self
