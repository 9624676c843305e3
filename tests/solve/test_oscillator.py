"""The response of integrators to linear oscillations against their textbook formulas."""

from __future__ import annotations

from math import atan, pi, sqrt

import numpy as np
import pytest

from dismech_cli.solve.integrators import (
    GeneralizedAlpha,
    ImplicitEuler,
    ImplicitMidpoint,
    Integrator,
    Newmark,
    TrBdf2,
)
from dismech_cli.solve.oscillator import respond


@pytest.mark.parametrize("angle", [0.1, 1.0, 10.0])
def test_euler_and_the_trapezoidal_rule(angle: float) -> None:
    euler = respond(ImplicitEuler(), angle)
    assert euler.kept == pytest.approx(1.0 / sqrt(1.0 + angle**2), rel=1e-10)
    assert euler.turned == pytest.approx(atan(angle), rel=1e-10)
    for scheme in (ImplicitMidpoint(), Newmark()):
        found = respond(scheme, angle)
        assert found.kept == pytest.approx(1.0, abs=1e-10)
        assert found.turned == pytest.approx(2.0 * atan(0.5 * angle), rel=1e-9)


@pytest.mark.parametrize("radius", [0.0, 0.5, 0.8, 1.0])
def test_generalised_alpha_keeps_its_radius_of_fast_swings(radius: float) -> None:
    # the three eigenvalues meet in the limit: near it they are apart by the root of the distance
    assert respond(GeneralizedAlpha(radius), 1e5).kept == pytest.approx(radius, abs=0.02)


def test_tr_bdf2_damps_fast_swings_wholly_and_slow_ones_hardly() -> None:
    assert respond(TrBdf2(), 1e6).kept < 1e-5
    slow = respond(TrBdf2(), 0.05)
    assert 1.0 - 1e-5 < slow.kept < 1.0


@pytest.mark.parametrize("scheme", [GeneralizedAlpha(), TrBdf2()], ids=lambda one: one.name)
def test_periods_are_late_by_second_order(scheme: Integrator) -> None:
    late = [1.0 - respond(scheme, angle).turned / angle for angle in (0.1, 0.05)]
    assert np.log2(late[0] / late[1]) == pytest.approx(2.0, abs=0.02)
    assert respond(scheme, 2 * pi / 1000).turned == pytest.approx(2 * pi / 1000, rel=1e-4)
