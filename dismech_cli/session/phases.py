"""Wall time of a run by phase, of all processes that worked on it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

TOTAL: Final = "total"
# Before the steps and after them.
_AROUND: Final = ("load", "build", "draw")
_LOST: Final = "unrecorded"


def added(*parts: Mapping[str, float]) -> dict[str, float]:
    """Seconds by phase of several parts of a run, and their sum."""
    names = dict.fromkeys(name for part in parts for name in part if name != TOTAL)
    seconds = {name: sum(part.get(name, 0.0) for part in parts) for name in names}
    return {**seconds, TOTAL: sum(seconds.values())}


def lost(recorded: Mapping[str, float], wall: float) -> dict[str, float]:
    """What processes that were killed stepped up to their last checkpoint, if any was.

    Args:
        recorded: Seconds by phase of the processes before this one.
        wall: Time of all steps up to the checkpoint that the run goes on from [s].
    """
    stepped = sum(seconds for name, seconds in recorded.items() if name not in (*_AROUND, TOTAL))
    return {_LOST: wall - stepped} if wall > stepped else {}
