"""What adaptive steps have to keep."""

from __future__ import annotations

from typing import Final

from ..frozen import frozen

LENGTHS: Final = (1e-3, 1e-7, 0.1)
"""First, shortest and longest step by default, as shares of the run: measured on 24 scenes."""

RTOL: Final = 5e-4
"""Error of a step as a share of the motion, by default: ends of swings are then right to about 1 %."""


@frozen
class Tolerance:
    """What a user asks of adaptive steps.

    Attributes:
        rtol: Error of a step as a share of the motion.
        first: Step at the start and after events [s].
        shortest: Step below which none is cut [s].
        longest: Step beyond which none grows [s].
    """

    rtol: float
    first: float
    shortest: float
    longest: float
