"""Small frames that are held back for a moment, so that files take many in one go."""

from __future__ import annotations

import time

from .frame import Frame

# What a frame costs beside its bytes, a millisecond or two, is shared by the frames of this time [s] ...
_TIME = 0.25
# ... or by as many as have these bytes: larger ones are written as fast alone.
_BYTES = 1 << 20


class Held:
    """Frames on their way to the files."""

    def __init__(self) -> None:
        self._frames: list[Frame] = []
        self._bytes = 0
        # The first frame is due at once: who waits for a run to begin sees it.
        self._taken = float("-inf")

    def add(self, frame: Frame) -> None:
        """Hold one more."""
        self._frames.append(frame)
        self._bytes += _size(frame)

    @property
    def due(self) -> bool:
        """Whether they must be written now."""
        if not self._frames:
            return False
        return self._bytes >= _BYTES or time.monotonic() - self._taken >= _TIME

    def take(self) -> tuple[Frame, ...]:
        """All of them, in order; none is held afterwards."""
        frames = tuple(self._frames)
        self._frames.clear()
        self._bytes, self._taken = 0, time.monotonic()
        return frames


def _size(frame: Frame) -> int:
    arrays = (frame.positions, *frame.fields.values(), *frame.state.values())
    return sum(array.nbytes for array in arrays)
