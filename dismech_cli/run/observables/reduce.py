"""A course over time reduced to one number."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ...arrays import FloatArray

Reduction = Callable[[FloatArray, FloatArray], float]


def period(times: FloatArray, values: FloatArray) -> float:
    """Mean time [s] between upward crossings of the mean, NaN with fewer than two of them.

    The mean is that over time, and crossings are interpolated: the error falls with the square of
    the sampling interval.
    """
    if len(times) < 3:
        return float("nan")
    mean = time_mean(times, values)
    below = values < mean
    up = np.flatnonzero(below[:-1] & ~below[1:])
    if len(up) < 2:
        return float("nan")
    share = (mean - values[up]) / (values[up + 1] - values[up])
    crossings = times[up] + share * (times[up + 1] - times[up])
    return float((crossings[-1] - crossings[0]) / (len(crossings) - 1))


def time_mean(times: FloatArray, values: FloatArray) -> float:
    """Mean over time; steps of different lengths count by their lengths."""
    if len(times) == 1:
        return float(values[0])
    return float(np.trapezoid(values, times) / (times[-1] - times[0]))


REDUCTIONS: Mapping[str, Reduction] = {
    "last": lambda t, x: float(x[-1]),
    "first": lambda t, x: float(x[0]),
    "min": lambda t, x: float(x.min()),
    "max": lambda t, x: float(x.max()),
    "mean": time_mean,
    "gain": lambda t, x: float(x[-1] - x[0]),
    "span": lambda t, x: float(np.ptp(x)),
    "period": period,
}


def reduce_series(
    times: FloatArray, values: FloatArray, how: str, *, at: float | None = None, after: float | None = None
) -> float:
    """Reduce a series to a number.

    Args:
        times: Times [s], ascending, shape (K,).
        values: Values, shape (K,).
        how: Key of :data:`REDUCTIONS`.
        at: The value at this time [s] instead, interpolated linearly.
        after: Leaves out what was before this time [s].

    Returns:
        The number; NaN if the series does not reach ``at`` or ``after``, or has no period.
    """
    # Times that the user writes in decimals and sums of steps differ by rounding.
    slack = 1e-9 * float(np.abs(times).max(initial=0.0))
    if at is not None:
        if not len(times) or not times[0] - slack <= at <= times[-1] + slack:
            return float("nan")
        return float(np.interp(at, times, values))
    if after is not None:
        kept = times >= after - slack
        times, values = times[kept], values[kept]
    return REDUCTIONS[how](times, values) if len(times) else float("nan")
