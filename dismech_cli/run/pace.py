"""What adaptive steps must not step over: times at which something jumps, and laws that change fast.

Error estimates see what a step has felt. A pulse between its ends it has not: so no step is longer than
an eighth of the period of a law that repeats, nor goes over more than a quarter of the range of one that
does not. Jumps that are known end a step.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np

from ..arrays import FloatArray, distinct, union
from ..errors import LawError
from ..frozen import frozen
from ..laws.laws import Law

# A law with more jumps than this is a signal, such as one that was measured.
_SIGNAL = 1000
# Looks at a law over the run; two more on both sides of every jump.
_LOOKS = 2000
# Parts of a period and of a range that a step may go over.
_CYCLE, _RANGE = 0.125, 0.25
# Where a law is looked at: along a rod, and in space.
_PLACES = np.array([0.0, 0.37, 1.0])


@frozen
class Pace:
    """How a run is driven.

    Attributes:
        events: Times at which a step has to end [s], increasing; the last is the end of the run.
        times: Times at which laws were looked at [s], increasing, shape (K,).
        change: Sum of all changes up to them, in units of the range of the law that changes most, (K,).
        longest: Step that laws which repeat allow [s].
    """

    events: FloatArray
    times: FloatArray
    change: FloatArray
    longest: float

    def next_event(self, t: float) -> float:
        """The first event after ``t`` [s]."""
        return float(self.events[np.searchsorted(self.events, t, side="right")])

    def limit(self, t: float) -> float:
        """How far a step from ``t`` may go if laws are to be resolved [s]."""
        far = t + self.longest
        if self.change[-1] > 0.0:
            gone = float(np.interp(t, self.times, self.change)) + _RANGE
            if gone < self.change[-1]:
                far = min(far, float(np.interp(gone, self.change, self.times)))
        return far


def find_pace(laws: Sequence[Law], more: Sequence[float], end: float) -> Pace:
    """How laws and other events drive a run of a duration.

    Args:
        laws: Whatever changes in time.
        more: Further times at which steps have to end [s].
        end: End of the run [s].
    """
    laws = [law for law in laws if not law.constant]
    events = distinct(np.array([*(t for t in more if 0.0 < t < end), end]))
    for law in laws:
        kinks = law.kinks(end)
        if kinks.size <= _SIGNAL:
            # jumps a rounding apart are one
            apart = (np.abs(kinks[:, None] - events) > 1e-9 * end).all(axis=1)
            events = union(events, kinks[apart])
    close = 1e-6 * end
    beside = np.concatenate([events - close, events + close])
    times = distinct(np.clip(np.concatenate([np.linspace(0.0, end, _LOOKS), beside]), 0.0, end))
    steps = np.zeros(len(times) - 1)
    for law in laws:
        steps = np.maximum(steps, _changes(law, times))
    # what happens in a jump is no reason for short steps on both sides of it
    middle = 0.5 * (times[1:] + times[:-1])
    steps[(np.abs(middle[:, None] - events) <= close).any(axis=1)] = 0.0
    change = np.append(0.0, np.cumsum(steps))
    # strictly increasing, so that it can be inverted
    change += np.arange(len(change)) * 1e-9
    return Pace(events, times, change, _CYCLE * min((law.cycle for law in laws), default=inf))


def _changes(law: Law, times: FloatArray) -> FloatArray:
    """By how much a law changes between times, in units of its range, shape (K - 1,)."""
    values = np.full((len(times), len(_PLACES)), np.nan)
    for i, t in enumerate(times.tolist()):
        try:
            values[i] = law(t, _PLACES)
        except LawError:
            continue
    with np.errstate(all="ignore"):
        steps = np.nan_to_num(np.abs(np.diff(values, axis=0)).max(axis=1))
        extent = float(np.nan_to_num(np.nanmax(values) - np.nanmin(values)))
    shares: FloatArray = steps / extent if extent > 0.0 else 0.0 * steps
    return shares
