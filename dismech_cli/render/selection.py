"""Which frames are drawn, and how fast they are shown."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from ..arrays import FloatArray
from ..errors import ScenarioError
from .settings import Format

Times = Literal["first", "last"] | Sequence[float] | None


def select_frames(all_times: FloatArray, format: Format, times: Times) -> list[int]:
    """Frame numbers that the user asked for, in order and without repetition."""
    last = len(all_times) - 1
    if times is None:
        return [last] if format == "png" else list(range(last + 1))
    if isinstance(times, str):
        if times not in ("first", "last"):
            raise ScenarioError(f"no frames are called {times!r}; use 'first', 'last' or times in seconds")
        return [0] if times == "first" else [last]
    return sorted({int(np.abs(all_times - t).argmin()) for t in times})


def real_time_fps(all_times: FloatArray) -> float:
    """Frames per second at which the video runs as fast as the motion, within 10 and 60."""
    if len(all_times) < 2:
        return 30.0
    step = float(np.median(np.diff(all_times)))
    return float(np.clip(round(1.0 / step, 3), 10.0, 60.0)) if step > 0 else 30.0
