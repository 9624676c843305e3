"""By how much a step may be longer than the last one, from the errors of both.

PI control of the step (Gustafsson 1991; Hairer and Wanner 1996, IV.8), restarted where something jumps.
"""

from __future__ import annotations

from typing import Final

# Safety, and exponents of this and of the last error, over the order of the error.
_SAFE, _NOW, _LAST = 0.9, 0.7, 0.4
# By how much a step may be shorter than the last one.
_LEAST = 0.2
# Steps that the last error alone would change by less stay: a change costs generalised-alpha accuracy. What
# could be longer than that grows at least by a power of it: where errors stay small, PI control hardly grows.
_KEPT, _EAGER = (0.9, 1.5), 0.35

NONE: Final = 1e-8
"""An error that counts as none, in units of the tolerance."""

MOST: Final = 2.0
"""By how much a step may be longer than the last one."""

STANDS: Final = 1.5
"""Error up to which a step stands, in units of the tolerance: the next one is shorter, which costs less than
to make this one again. Of the iterations of a jellyfish a sixth went into steps that were barely too long."""


def grown(error: float, last: float, order: int, most: float) -> float:
    """Length of the next step over that of one that may stand.

    Args:
        error: Of the step, in units of the tolerance.
        last: Of the step before.
        order: Power of the step that errors go with.
        most: By how much it may be longer.
    """
    return min(max(_change(error, last, order), _LEAST), most)


def shrunk(error: float, order: int) -> float:
    """Length of a step over that of one whose error was too large."""
    return max(_SAFE * float(error ** (-1.0 / order)), _LEAST)


def _change(error: float, last: float, order: int) -> float:
    alone = float(_SAFE * error ** (-1.0 / order))
    if _KEPT[0] <= alone <= _KEPT[1]:
        return 1.0
    smooth = float(_SAFE * error ** (-_NOW / order) * last ** (_LAST / order))
    return max(smooth, float(alone**_EAGER)) if alone > 1.0 else smooth
