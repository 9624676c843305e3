"""Observed orders: the slope of an error against its step, in logarithms."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dismech_cli.arrays import FloatArray


def observed_order(steps: FloatArray, errors: FloatArray) -> float:
    """Regressed slope of log(error) over log(step)."""
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


def assert_remainder(
    remainder: Callable[[float], float], steps: FloatArray, order: float, floor: float
) -> None:
    """Check that a Taylor remainder falls with the step at least like ``step**order``.

    Remainders below ``floor``, the round-off of the function, carry no information. Where hardly
    one lies above it, the function is a polynomial of lower degree: a wrong derivative would leave
    a remainder of first or second order, far above.
    """
    errors = np.array([remainder(h) for h in steps])
    assert np.isfinite(errors).all()
    # The four smallest steps: the asymptotic range lies there.
    seen = np.flatnonzero(errors > floor)[-4:]
    if len(seen) >= 3:
        slope = observed_order(steps[seen], errors[seen])
        assert slope > order - 0.15, f"order {slope:.3f} instead of {order}: remainders {errors}"
    else:
        assert errors[-5:].max() <= floor, f"remainders {errors} do not vanish"
