"""Material damping: decay of modes, creep and relaxation, against Kelvin and Voigt's material."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import Deck, line, rod_deck, scalar, solve
from numpy.testing import assert_allclose
from order import observed_order

from dismech_cli.arrays import FloatArray

LENGTH, RADIUS, MODULUS, DENSITY = 0.1, 2e-3, 1e6, 1000.0
BETA = 1.8751041
OMEGA = (BETA / LENGTH) ** 2 * np.sqrt(MODULUS * RADIUS**2 / (4.0 * DENSITY))


def material(time: float, **keys: Any) -> Deck:
    base = {"youngs_modulus": MODULUS, "poisson_ratio": 0.5, "density": DENSITY, "relaxation_time": time}
    return {"m": base | keys}


def first_mode(x: FloatArray) -> FloatArray:
    """Of a cantilever from 0 to 1, of unit amplitude at its tip."""
    ratio = (np.cosh(BETA) + np.cos(BETA)) / (np.sinh(BETA) + np.sin(BETA))
    y = np.cosh(BETA * x) - np.cos(BETA * x) - ratio * (np.sinh(BETA * x) - np.sin(BETA * x))
    return np.asarray(y / y[-1])


def swing(folder: Path, nodes: int, per_period: int, **keys: Any) -> tuple[FloatArray, FloatArray]:
    """Times and deflections of the tip of a cantilever let go at its rest in its first mode."""
    speed = np.zeros((nodes, 3))
    speed[:, 2] = 1e-4 * LENGTH * OMEGA * first_mode(np.linspace(0.0, 1.0, nodes))
    np.savetxt(folder / "speed.csv", speed, delimiter=",", header="x,y,z", comments="")
    dt = 2.0 * np.pi / OMEGA / per_period
    base = {
        "initial_velocity": [{"where": "rod", "velocity": {"file": "speed.csv"}}],
        "numerics": {"integrator": {"type": "tr_bdf2"}, "dt": dt, "t_end": 4.2 * per_period * dt},
        "output": {"every": dt, "probes": {"w": {"displacement": "rod.end", "component": "z"}}},
    }
    deck = rod_deck(line(nodes, (LENGTH, 0.0, 0.0)), {"type": "round", "radius": RADIUS}, **base | keys)
    result = solve(folder, deck)
    return np.array([frame.t for frame in result.frames]), scalar(result, "w")


def decrement(t: FloatArray, w: FloatArray) -> float:
    """Logarithm of the ratio of neighbouring maxima, fitted over all."""
    peaks = np.flatnonzero((np.abs(w[1:-1]) > np.abs(w[:-2])) & (np.abs(w[1:-1]) >= np.abs(w[2:]))) + 1
    a, b, c = np.abs(w[peaks - 1]), np.abs(w[peaks]), np.abs(w[peaks + 1])
    heights = b + 0.125 * (a - c) ** 2 / (2.0 * b - a - c)
    return float(-2.0 * np.polyfit(np.arange(len(heights)), np.log(heights), 1)[0])


@pytest.mark.parametrize("keys", [{}, {"dimension": 3}])
def test_decay_of_a_mode(tmp_path: Path, keys: Deck) -> None:
    """Each period leaves exp(-delta), delta = 2 pi zeta / sqrt(1 - zeta^2), zeta = omega tau / 2."""
    zeta = 0.05
    t, w = swing(tmp_path, 41, 100, materials=material(2.0 * zeta / OMEGA), **keys)
    assert_allclose(decrement(t, w), 2.0 * np.pi * zeta / np.sqrt(1.0 - zeta**2), rtol=1e-2)
