from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dismech_cli.run.observables.reduce import REDUCTIONS, reduce_series


def sine(samples_per_period: int, periods: float = 5.3, mean: float = 0.3, phase: float = 0.4):
    t = np.linspace(0.0, 2.0 * periods, round(samples_per_period * periods) + 1)
    return t, mean + 0.7 * np.sin(np.pi * t + phase)


@pytest.mark.parametrize("phase", [0.0, 0.4, 1.0, 2.5])
def test_period_of_a_sine(phase):
    # Over 5.3 periods the mean over time is off by up to 0.7 / (pi 5.3), which shifts every crossing alike.
    t, x = sine(40, phase=phase)
    assert_allclose(reduce_series(t, x, "period"), 2.0, rtol=1e-3)


def test_period_converges_with_the_square_of_the_interval():
    # Crossings off the inflection have curvature: linear interpolation errs by h^2 x'' / 8 x'.
    def signal(t):
        return np.sin(np.pi * t) + 0.8 * np.cos(2.0 * np.pi * t) + 0.3 * t

    errors = []
    exact = reduce_series(t := np.linspace(0, 9.7, 200_001), signal(t), "period")
    for count in (161, 321, 641, 1281):
        t = np.linspace(0, 9.7, count)
        errors.append(abs(reduce_series(t, signal(t), "period") - exact))
    assert errors[0] < 0.05
    assert errors[-1] < errors[0] / 16


def test_period_needs_two_crossings():
    t = np.linspace(0.0, 1.0, 50)
    assert np.isnan(reduce_series(t, t, "period"))
    assert np.isnan(reduce_series(t[:1], t[:1], "period"))
    assert np.isnan(reduce_series(t, np.ones(50), "period"))


def test_period_with_uneven_steps():
    rng = np.random.default_rng(3)
    t = np.sort(np.concatenate(([0.0, 10.6], rng.uniform(0.0, 10.6, 1500))))
    assert_allclose(reduce_series(t, np.sin(np.pi * t), "period"), 2.0, rtol=1e-3)


def test_simple_reductions():
    t = np.array([0.0, 1.0, 3.0])
    x = np.array([2.0, 5.0, -1.0])
    values = {how: reduce_series(t, x, how) for how in REDUCTIONS if how != "period"}
    # The mean is over time: (1 * 3.5 + 2 * 2) / 3.
    expected = {"last": -1, "first": 2, "min": -1, "max": 5, "mean": 2.5, "gain": -3, "span": 6}
    assert values == pytest.approx(expected, rel=1e-15)


def test_at_interpolates_and_forgives_rounding():
    t = np.arange(11) * 0.1
    assert reduce_series(t, t**2, "last", at=0.25) == pytest.approx((0.04 + 0.09) / 2)
    assert reduce_series(t[:4], t[:4], "last", at=0.3) == pytest.approx(0.3)
    assert np.isnan(reduce_series(t, t, "last", at=1.5))


def test_after_leaves_out_the_beginning():
    t = np.arange(11) * 0.1
    x = np.where(t < 0.45, 9.0, t)
    assert reduce_series(t, x, "max", after=0.5) == 1.0
    assert reduce_series(t, x, "first", after=0.3) == 9.0  # 3 * 0.1 > 0.3 by rounding
    assert np.isnan(reduce_series(t, x, "max", after=2.0))


def test_every_reduction_of_the_language_exists():
    from typing import get_args

    from dismech_cli.scenario.language.expect import Reduction

    assert set(get_args(Reduction)) == set(REDUCTIONS)
