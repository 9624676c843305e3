"""Laws know where they jump and how soon they repeat."""

from __future__ import annotations

from math import inf, pi

import pytest
from numpy.testing import assert_allclose

from dismech_cli.laws.laws import Constant, Expression, Law, Ramp, Sawtooth, Sine, Table

_TIMES, _VALUES = (0.0, 0.5, 1.0, 3.0), (0.0, 1.0, 0.5, 2.0)


@pytest.mark.parametrize(
    ("law", "kinks"),
    [
        (Constant(1.0), []),
        (Table(times=_TIMES, values=_VALUES), [0.5, 1.0]),
        (Table(times=_TIMES, values=_VALUES, interpolation="step"), [0.5, 1.0]),
        (Table(times=(0.5, 1.0, 1.5), values=(0.0, 1.0, 0.0), interpolation="cubic"), [0.5, 1.5]),
        (Ramp(before=0.0, after=1.0, start=0.0, end=0.25), [0.25]),
        (Sine(amplitude=1.0, frequency=3.0), []),
        (Sawtooth(amplitude=1.0, frequency=1.0), [1.0]),
        (Sawtooth(amplitude=1.0, frequency=1.0, width=0.5), [0.5, 1.0, 1.5]),
        (Sawtooth(amplitude=1.0, frequency=1.0, phase=0.5 * pi), [0.75, 1.75]),
        (Sawtooth(amplitude=1.0, frequency=0.0), []),
        (Expression("t**2"), []),
    ],
)
def test_kinks_within_two_seconds(law: Law, kinks: list[float]) -> None:
    assert_allclose(law.kinks(2.0), kinks, rtol=1e-12)


def test_only_waves_repeat() -> None:
    assert Sine(amplitude=1.0, frequency=-4.0).cycle == Sawtooth(amplitude=1.0, frequency=4.0).cycle == 0.25
    assert (
        Sine(amplitude=1.0, frequency=0.0).cycle == Constant(2.0).cycle == Expression("sin(t)").cycle == inf
    )
