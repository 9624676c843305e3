"""Times at which adaptive steps have to end, and what brings one there."""

from __future__ import annotations

from dataclasses import field
from math import floor, inf
from typing import Final

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from .pace import Pace

# A step that ends this share of itself before a stop goes on to it.
_STRETCH: Final = 1.1


@frozen
class Stops:
    """Where steps end whatever their error.

    Attributes:
        pace: What they must not step over.
        every: Time between marks [s]: frames of runs that have none in between; infinite without.
        samples: Times at which controllers sample, or expectations ask, ascending [s].
    """

    pace: Pace
    every: float = inf
    samples: FloatArray = field(default_factory=lambda: np.empty(0))

    @property
    def last(self) -> float:
        """End of the run [s]."""
        return float(self.pace.events[-1])

    def after(self, t: float) -> float:
        """The first one after ``t`` [s]."""
        return min(self.pace.next_event(t), self._next_mark(t), self._next_sample(t))

    def target(self, t: float, step: float) -> float:
        """Where a step from ``t`` ends that may be ``step`` long [s]."""
        stop, step = self.after(t), min(step, self.pace.limit(t) - t)
        if stop - t <= _STRETCH * step:
            return stop
        # two equal steps rather than a long one and the rest
        return t + min(step, 0.5 * (stop - t))

    def _next_mark(self, t: float) -> float:
        if self.every == inf:
            return inf
        return self.every * (floor(t / self.every * (1.0 + 1e-12)) + 1)

    def _next_sample(self, t: float) -> float:
        place = int(np.searchsorted(self.samples, t, side="right"))
        return float(self.samples[place]) if place < len(self.samples) else inf
