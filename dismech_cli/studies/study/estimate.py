"""Errors of refined solutions from their differences, with a safety factor.

After the grid convergence index (Roache 1994; ASME V&V 20): where three levels fall with an observed order
near the nominal one the difference is extrapolated and enlarged by 1.5, else by 2.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite, isnan, log, nan
from typing import Final

from ...frozen import frozen
from .gap import NONE, UNKNOWN, Gap

# Safety with and without an observed order, the least order that is believed, and the share of the
# nominal one from which on three levels are said to converge.
_SAFE, _UNSURE, _LEAST, _STEADY = 1.5, 2.0, 0.5, 0.5


@frozen
class Estimate:
    """Error of the finest of some levels.

    Attributes:
        gap: The error at every time.
        order: Observed; NaN with fewer than three levels.
        steady: Whether three levels fell as they should, or there are not three.
    """

    gap: Gap
    order: float = nan
    steady: bool = True

    @property
    def error(self) -> float:
        """The largest, as a share."""
        return self.gap.size


NO_ERROR: Final = Estimate(NONE)
"""Of what is not refined."""

LOST: Final = Estimate(UNKNOWN, steady=False)
"""Of what cannot be told."""


def estimate(differences: Sequence[Gap], ratio: float, nominal: float) -> Estimate:
    """The error from differences between successive levels, the coarsest first; the last two count.

    Args:
        differences: One, or more.
        ratio: Between the levels.
        nominal: Order that is to be expected.
    """
    fine = differences[-1]
    if not isfinite(fine.size):
        return LOST
    if len(differences) < 2:
        return Estimate(_UNSURE / (ratio**nominal - 1.0) * fine)
    coarse = differences[-2]
    if coarse.size == 0.0:
        return Estimate(_UNSURE / (ratio**_LEAST - 1.0) * fine, steady=fine.size == 0.0)
    order = log(coarse.size / fine.size) / log(ratio) if fine.size > 0.0 else inf
    if order < _LEAST:
        # hardly falling: the coarser difference may be the lucky one
        larger = max(fine, coarse, key=lambda gap: gap.size)
        return Estimate(_UNSURE / (ratio**_LEAST - 1.0) * larger, order, steady=False)
    # a difference that is small by chance is no smaller than the one before it says
    larger = max(fine, ratio**-nominal * coarse, key=lambda gap: gap.size)
    safety = _SAFE / (ratio ** believed(order, nominal) - 1.0)
    return Estimate(safety * larger, order, order >= _STEADY * nominal)


def believed(observed: float, nominal: float) -> float:
    """The order that errors go with: the observed one, if neither absurdly low nor above the nominal."""
    return nominal if isnan(observed) else min(max(observed, _LEAST), nominal)
