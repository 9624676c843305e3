"""Probes as readings of a controller: those of where things are and how they move."""

from __future__ import annotations

from typing import Any, ClassVar, NoReturn

import numpy as np

from ...arrays import FloatArray
from ...frozen import frozen
from ...model.model import Model
from ...model.state import State
from .probes import Probe
from .snapshot import Snapshot


@frozen
class ProbeReading:
    """A probe that a state alone tells.

    Attributes:
        probe: The probe.
        model: The system; its terms are not asked.
    """

    probe: Probe
    model: Model
    size: ClassVar[int] = 1

    def __call__(self, state: State) -> FloatArray:
        """The value, shape (1,)."""
        nothing = np.zeros_like(state.q)
        s = Snapshot(self.model, state, nothing, _untold, _untold, _untold, _untold, _untold)
        return np.array([self.probe(s)])


def _untold(*asked: Any) -> NoReturn:
    """Forces and energies are those of a step, which a reading between steps does not know."""
    raise AssertionError
