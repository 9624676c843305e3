"""Commands in the balance of a stage: what follows them, differentiated along changes of the inputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from ..arrays import FloatArray
from ..model.configuration import Configuration
from ..model.state import State
from ..model.term import BoundTerm
from .neighbours import CENTRAL, Variation, residual_of

# A step along a change of the inputs, of the largest of them: they are commands and times.
_STEP = 1e-3


class Acting(Protocol):
    """What acts on the states of a run between its steps, differentiated."""

    def __call__(self, before: State, d: Variation, until: float) -> Variation:
        """The derivative with what is put in and remembered for a step to a time.

        Args:
            before: The state on which it acted.
            d: Its derivative.
            until: End of the step that follows [s].
        """


def nothing_acts(before: State, d: Variation, until: float) -> Variation:
    """That of a run without controllers."""
    return d


class Commanded:
    """The residual of what follows commands."""

    def __init__(self, terms: Sequence[BoundTerm]) -> None:
        self._terms = [term for term in terms if (e := term.potential) is not None and not e.steady]

    def slope(self, c: Configuration, change: FloatArray) -> FloatArray:
        """Derivative along changes of the inputs (I, P), shape (n, P)."""
        found = np.zeros((len(c.q), change.shape[1]))
        for k, column in enumerate(change.T):
            size = float(np.abs(column).max(initial=0.0))
            if size == 0.0:
                continue
            step = _STEP * (float(np.abs(c.inputs).max(initial=0.0)) or 1.0) / size
            there = [replace(c, inputs=c.inputs + offset * step * column) for offset in CENTRAL.offsets]
            for term in self._terms:
                found[:, k] += CENTRAL([residual_of(term, one) for one in there], step)
        return found
