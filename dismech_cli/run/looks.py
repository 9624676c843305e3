"""When the states of a run are looked at: where steps end, or on times of their own."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ..arrays import union

# Parts of a step at whose ends watched values are read: a swing of eight steps is seen to within 0.1 %.
_PARTS = 4


class Looks(Protocol):
    """Chooses the times within a step at which to look."""

    def __call__(self, start: float, end: float, due: float, every: float) -> list[tuple[float, bool]]:
        """Times in (start, end], the last of them the end, and whether each is one of a frame.

        Args:
            start: Of the step [s]; the end itself before the first step.
            end: Of the step [s].
            due: Time of the next frame [s].
            every: Time between frames [s]; 0 for one per step.
        """


def at_ends(start: float, end: float, due: float, every: float) -> list[tuple[float, bool]]:
    """Only at the end, which is a frame if one has become due."""
    return [(end, end >= due_from(due))]


def due_from(due: float) -> float:
    """A time from which on a frame that is due at a time [s] is shown: rounding makes it no later."""
    return due * (1.0 - 1e-12)


def within(start: float, end: float, due: float, every: float) -> list[tuple[float, bool]]:
    """On the time of every frame, and at parts of the step for watched values."""
    if start == end or every == 0.0:
        return at_ends(start, end, due, every)
    close = 1e-9 * every
    frames = due + every * np.arange(max(int((end - due) / every) + 2, 0))
    frames = frames[(frames > start + close) & (frames < end - close)]
    parts = np.linspace(start, end, _PARTS + 1)[1:-1]
    inside = union(parts, frames)
    shown = np.isin(inside, frames).tolist()
    last = due + every * len(frames) <= end + close
    return [*zip(inside.tolist(), shown, strict=True), (end, last)]
