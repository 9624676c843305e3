"""Free vibrations: frequencies of Euler-Bernoulli beams from their periods in time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from decks import Deck, given_section, line, rod_deck, scalar, solve
from numpy.testing import assert_allclose
from order import observed_order
from scipy.optimize import brentq

from dismech_cli.arrays import FloatArray

CLAMPED_START: list[Deck] = [{"type": "clamp", "where": "rod.start"}]
CLAMPED_BOTH: list[Deck] = [*CLAMPED_START, {"type": "clamp", "where": "rod.end"}]
# beta_n L as published; sharpened below
CANTILEVER = (1.8751041, 4.6940911, 7.8547574)
CLAMPED_CLAMPED = (4.7300407,)


def mode_shape(x: FloatArray, beta: float, *, free_end: bool) -> FloatArray:
    """Deflection of a mode of a unit beam clamped at 0, of unit amplitude at its largest."""
    sign = 1.0 if free_end else -1.0
    ratio = (np.cosh(beta) + sign * np.cos(beta)) / (np.sinh(beta) + sign * np.sin(beta))
    y = np.cosh(beta * x) - np.cos(beta * x) - ratio * (np.sinh(beta * x) - np.sin(beta * x))
    return y / np.abs(y).max()


def exact_root(published: float, *, free_end: bool) -> float:
    """Root of cos b cosh b = -1 (free end) or 1 (clamped)."""
    sign = 1.0 if free_end else -1.0
    beta = brentq(lambda b: np.cos(b) + sign / np.cosh(b), published - 1e-3, published + 1e-3, xtol=1e-13)
    assert_allclose(beta, published, atol=6e-8)
    return float(beta)


def frequency_ratio(folder: Path, nodes: int, published: float, *, free_end: bool) -> float:
    """Measured over exact angular frequency of one mode."""
    beta = exact_root(published, free_end=free_end)
    omega = beta**2
    x = np.linspace(0.0, 1.0, nodes)
    amplitude = 1e-4
    speed = np.zeros((nodes, 3))
    speed[:, 2] = amplitude * omega * mode_shape(x, beta, free_end=free_end)
    np.savetxt(folder / "speed.csv", speed, delimiter=",", header="x,y,z", comments="")
    periods, per_period = 4, 60
    dt = 2.0 * np.pi / omega / per_period
    watched = nodes - 1 if free_end else nodes // 2
    deck = rod_deck(
        line(nodes),
        given_section(axial=1e4),
        motions=CLAMPED_START if free_end else CLAMPED_BOTH,
        initial_velocity=[{"where": "rod", "velocity": {"file": "speed.csv"}}],
        numerics={"integrator": {"type": "newmark"}, "dt": dt, "t_end": (periods + 0.2) * per_period * dt},
        output={
            "every": dt,
            "probes": {
                "w": {"displacement": {"nodes": {"of": "rod", "indices": [watched]}}, "component": "z"}
            },
        },
    )
    result = solve(folder, deck)
    t, w = np.array([frame.t for frame in result.frames]), scalar(result, "w")
    upward = np.flatnonzero((w[:-1] < 0.0) & (w[1:] >= 0.0))
    crossings = t[upward] - w[upward] * (t[upward + 1] - t[upward]) / (w[upward + 1] - w[upward])
    # the motion starts at zero, going up or down
    measured = 2.0 * np.pi * (len(crossings) - 1) / (crossings[-1] - crossings[0])
    # the trapezoidal rule slows an oscillator of frequency w to 2/dt atan(w dt/2): undone here
    return float(2.0 / dt * np.tan(0.5 * measured * dt) / omega)


@pytest.mark.parametrize(
    ("published", "free_end"),
    [(CANTILEVER[0], True), (CANTILEVER[1], True), (CLAMPED_CLAMPED[0], False)],
)
def test_frequency(tmp_path: Path, published: float, free_end: bool) -> None:
    # of second order: at most (beta h)^2 / 4
    tolerance = (published / 100.0) ** 2 / 4.0
    assert_allclose(frequency_ratio(tmp_path, 101, published, free_end=free_end), 1.0, atol=tolerance)


@pytest.mark.slow
def test_third_mode_of_the_cantilever(tmp_path: Path) -> None:
    assert_allclose(frequency_ratio(tmp_path, 101, CANTILEVER[2], free_end=True), 1.0, atol=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("published", "free_end"), [(CANTILEVER[1], True), (CLAMPED_CLAMPED[0], False)])
def test_frequency_converges_at_second_order(tmp_path: Path, published: float, free_end: bool) -> None:
    nodes = np.array([9, 17, 33])
    errors = [frequency_ratio(tmp_path, int(n), published, free_end=free_end) - 1.0 for n in nodes]
    assert observed_order(1.0 / (nodes - 1.0), np.abs(errors)) > 1.8
