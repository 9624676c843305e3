"""Errors from differences between levels: right where they converge, careful where they do not."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dismech_cli.scenario.language.study import Measured
from dismech_cli.studies.study.estimate import estimate
from dismech_cli.studies.study.gap import Gap, largest, root_mean_square
from dismech_cli.studies.study.yardstick import Yardstick


def _gaps(*sizes: float) -> list[Gap]:
    """Differences that are the same at all times."""
    return [Gap((np.array([size]),), (largest,)) for size in sizes]


def _levels(order: float, constant: float = 1.0, ratio: float = 2.0, count: int = 3) -> list[Gap]:
    """Differences of successive levels whose error is constant h^order."""
    errors = constant * (1.0 / ratio ** np.arange(count)) ** order
    return _gaps(*(errors[:-1] - errors[1:]))


@pytest.mark.parametrize("order", [1.0, 1.5, 2.0])
def test_a_power_law_is_seen_and_enlarged(order: float) -> None:
    found = estimate(_levels(order), 2.0, 2.0)
    assert found.order == pytest.approx(order)
    assert found.steady
    assert_allclose(found.error, 1.5 * (0.25**order), rtol=1e-12)


def test_two_levels_are_trusted_less() -> None:
    true = 0.25
    found = estimate(_levels(2.0, count=2), 2.0, 2.0)
    assert np.isnan(found.order)
    assert_allclose(found.error, 2.0 * true, rtol=1e-12)


def test_a_difference_that_is_small_by_chance_is_not_believed() -> None:
    """Courses that cross: the fine difference vanishes, the error does not."""
    found = estimate(_gaps(0.1, 1e-9), 2.0, 2.0)
    assert found.error > 0.1 / 4 / 3


def test_what_does_not_fall_is_not_steady() -> None:
    found = estimate(_gaps(0.01, 0.012), 2.0, 2.0)
    assert not found.steady
    assert found.error > 0.012
    assert not estimate(_gaps(0.01, 0.007), 2.0, 2.0).steady


def test_equal_levels_have_no_error_and_lost_ones_an_infinite_one() -> None:
    assert estimate(_gaps(0.0, 0.0), 2.0, 2.0).error == 0.0
    assert estimate(_gaps(0.1, float("nan")), 2.0, 2.0).error == float("inf")


def test_errors_are_added_where_they_happen() -> None:
    """Two that are large at different times are no larger together; they never cancel, and the rest adds."""
    early, late = (Gap((np.array(share),), (largest,)) for share in ([0.3, 0.0], [0.1, 0.2]))
    assert_allclose((early + late).size, 0.4, rtol=1e-15)
    assert_allclose((2.0 * late + Gap(rest=0.05)).size, 0.45, rtol=1e-15)
    assert (early + Gap(rest=float("inf"))).size == float("inf")
    assert (Gap() + late).size == late.size
    rms = Gap((np.array([3.0, 4.0]),), (root_mean_square,))
    assert_allclose(rms.size, 12.5**0.5, rtol=1e-15)


def test_the_largest_quantity_counts() -> None:
    two = Gap((np.array([0.3, 0.1]), np.array([0.2])), (root_mean_square, largest))
    assert_allclose(two.size, 0.05**0.5, rtol=1e-15)


TIMES = np.linspace(0.0, 2.0, 81)


@pytest.mark.parametrize(
    ("norm", "distance"), [("max", 0.05), ("rms", 0.05 * 0.5**0.5), ("last", 0.05), ("period", 0.0)]
)
def test_distances_are_shares_of_the_range(norm: str, distance: float) -> None:
    """A cosine of period 1 that is a tenth too large, compared with itself."""
    measured = Measured.model_validate({"probe": "q", "norm": norm})
    yardstick = Yardstick({"q": measured}, 2.0)
    right, large = ({"q": (TIMES, size * np.cos(2 * np.pi * TIMES))} for size in (1.0, 1.1))
    yardstick.start(right)
    assert_allclose(yardstick.gap(large, right).size, distance, rtol=5e-3, atol=1e-9)


def test_courses_of_other_steps_are_compared_at_the_same_times() -> None:
    """The splines between steps are no part of the error."""
    yardstick = Yardstick({"q": Measured(probe="q")}, 2.0)
    fine, coarse = ({"q": (t, np.sin(3 * t))} for t in (TIMES, np.linspace(0.0, 2.0, 27)))
    yardstick.start(fine)
    assert yardstick.gap(fine, coarse).size < 1e-3


def test_a_known_value_is_the_reference() -> None:
    measured = Measured.model_validate({"probe": "q", "norm": "last", "value": 0.9})
    yardstick = Yardstick({"q": measured}, 1.0)
    course = {"q": (np.array([0.0, 0.5, 1.0]), np.array([0.0, 2.0, 1.0]))}
    yardstick.start(course)
    assert yardstick.known
    assert_allclose(yardstick.error(course).size, 0.05, rtol=1e-12)
