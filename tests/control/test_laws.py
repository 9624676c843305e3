"""Laws of control by themselves: pure, within limits, and as the formulas say."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from dismech_cli.control.controller import Controller
from dismech_cli.control.incremental import Incremental
from dismech_cli.control.limits import Limits
from dismech_cli.control.positional import Positional
from dismech_cli.control.smoothing import GraphSmoothing

LINKS = np.array([[0, 1], [1, 2]])
PI = Positional(p=2.0, i=5.0, d=0.0, weight=0.7, forward=0.5, period=0.1)
PID = Positional(p=2.0, i=5.0, d=0.3, weight=1.0, forward=0.0, period=0.1)
SLOW = Incremental(p=0.2, i=0.5, leak=0.2, links=LINKS, period=0.1)
Y, R = np.array([0.1, -0.2, 0.3]), np.array([1.0, 2.0, -1.0])


@pytest.mark.parametrize("law", [PI, PID, SLOW])
def test_a_law_is_pure(law: Controller) -> None:
    """Neither what it reads nor what it remembers changes, and memory is arrays of float64 of fixed names."""
    memory = law.start(3)
    for _ in range(3):
        kept = {key: values.copy() for key, values in memory.items()}
        first, after = law.sample(0.0, Y, R, memory)
        again, _ = law.sample(0.0, Y, R, memory)
        assert_array_equal(first, again)
        assert memory.keys() == after.keys() == kept.keys()
        for key, values in kept.items():
            assert_array_equal(memory[key], values)
            assert after[key].dtype == np.float64
        memory = after


def test_positional_terms_are_those_of_the_formula() -> None:
    memory = PI.start(3)
    first, memory = PI.sample(0.0, Y, R, memory)
    assert_allclose(first, 0.5 * R + 2.0 * (0.7 * R - Y), rtol=1e-15)
    second, _ = PI.sample(0.1, Y, R, memory)
    assert_allclose(second - first, 5.0 * 0.1 * (R - Y), rtol=1e-14)


def test_the_first_reading_has_no_rate() -> None:
    first, memory = PID.sample(0.0, Y, R, PID.start(3))
    assert_allclose(first, 2.0 * (R - Y), rtol=1e-15)
    second, _ = PID.sample(0.1, Y + 0.01, R, memory)
    integral = 5.0 * 0.1 * (R - Y)
    assert_allclose(second, 2.0 * (R - Y - 0.01) + integral - 0.3 * 0.1, rtol=1e-13)


def test_incremental_gains_act_on_the_command() -> None:
    memory = {"integral": np.zeros(3), "command": np.array([1.0, 0.0, 0.0])}
    command, after = SLOW.sample(0.0, Y, R, memory)
    integral = 0.1 * (R - Y)
    wanted = memory["command"] + 0.2 * (R - Y) + 0.5 * integral
    lost = np.array([wanted[0] - wanted[1], 2 * wanted[1] - wanted[0] - wanted[2], wanted[2] - wanted[1]])
    assert_allclose(command, wanted - 0.2 * lost, rtol=1e-14)
    assert_allclose(after["integral"], integral, rtol=1e-15)


@pytest.mark.parametrize(
    "limits", [Limits(magnitude=0.5), Limits(change=0.05), Limits(magnitude=0.3, change=0.1)]
)
def test_limits_are_never_passed(limits: Limits) -> None:
    rng = np.random.default_rng(1)
    before = np.zeros(50)
    for _ in range(20):
        after = limits.applied(rng.normal(size=50), before)
        assert np.abs(after).max() <= limits.magnitude
        assert np.abs(after - before).max() <= limits.change * (1.0 + 1e-12)
        before = after


def test_no_integral_grows_that_the_actuator_cannot_follow() -> None:
    """A slow plant whose command saturates for 2 s overshoots by less than a tenth.

    Where the law does not know of the limit, the integral unwinds for as long as it wound up.
    """
    most = 1.5

    def overshoot(limits: Limits) -> float:
        law = Positional(p=5.0, i=5.0, d=0.0, weight=1.0, forward=0.0, period=0.01, limits=limits)
        y, memory, saturated, worst = np.zeros(1), law.start(1), 0, 0.0
        for k in range(1000):
            u, memory = law.sample(0.01 * k, y, np.ones(1), memory)
            saturated += bool(abs(u[0]) >= most)
            y = y + 0.01 / 2.0 * (np.clip(u, -most, most) - y)
            worst = max(worst, float(y[0]) - 1.0)
        assert saturated >= 200
        return worst

    assert overshoot(Limits(magnitude=most)) < 0.1
    assert overshoot(Limits()) > 0.25


def test_windup_is_of_each_place_alone() -> None:
    law = Positional(p=1.0, i=1.0, d=0.0, weight=1.0, forward=0.0, period=0.1, limits=Limits(magnitude=1.0))
    memory = law.start(2)
    for _ in range(50):
        _, memory = law.sample(0.0, np.zeros(2), np.array([5.0, 0.01]), memory)
    free = law.start(1)
    for _ in range(50):
        _, free = law.sample(0.0, np.zeros(1), np.array([0.01]), free)
    assert memory["integral"][1] == free["integral"][0] > 0.0


# ---------------------------------------------------------------- smoothing


def matrix(smooth: GraphSmoothing, n: int) -> np.ndarray:
    return smooth(np.eye(n))


def chain(n: int) -> np.ndarray:
    return np.column_stack((np.arange(n - 1), np.arange(1, n)))


def test_smoothing_keeps_constants_and_is_symmetric() -> None:
    spans = np.random.default_rng(0).uniform(5e-3, 2e-2, 9)
    f = matrix(GraphSmoothing.of(10, chain(10), spans, 15e-3), 10)
    assert_allclose(f.sum(axis=1), 1.0, rtol=1e-13)
    assert_allclose(f, f.T, atol=1e-15)
    assert np.linalg.eigvalsh(f).min() > 0.0


def test_smoothing_is_a_length_and_not_a_number_of_places() -> None:
    """A wave far longer than the mesh fades by the same factor on meshes of both sizes, (1 + (kl)^2)^-2."""
    for n in (40, 80):
        h = 1.0 / n
        x = (np.arange(n) + 0.5) * h
        wave = np.cos(2.0 * np.pi * x)
        f = GraphSmoothing.of(n, chain(n), np.full(n - 1, h), 0.1)
        factor = (f(wave) @ wave) / (wave @ wave)
        # the mesh sees the wave number k to (kh)^2/12
        assert factor == pytest.approx((1.0 + (0.2 * np.pi) ** 2) ** -2, rel=(2.0 * np.pi * h) ** 2 / 12.0)


def test_smoothing_does_not_know_in_which_order_places_are_numbered() -> None:
    rng = np.random.default_rng(3)
    spans, values, order = rng.uniform(1e-2, 2e-2, 11), rng.normal(size=12), rng.permutation(12)
    there = np.empty(12, dtype=int)
    there[order] = np.arange(12)
    plain = GraphSmoothing.of(12, chain(12), spans, 3e-2)(values)
    turned = GraphSmoothing.of(12, there[chain(12)][::-1], spans[::-1], 3e-2)(values[order])
    assert_allclose(turned, plain[order], rtol=1e-12)


def test_smoothing_does_not_couple_what_is_not_linked() -> None:
    links = np.array([[0, 1], [2, 3]])
    f = matrix(GraphSmoothing.of(4, links, np.ones(2), 5.0), 4)
    assert_array_equal(f[:2, 2:], 0.0)
