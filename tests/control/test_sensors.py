"""Sensors: noise that depends on nothing but its seed and number, and readings that arrive late."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.testing import assert_array_equal

from dismech_cli.arrays import FloatArray
from dismech_cli.control.noise import Noise
from dismech_cli.control.sensor import Sensor


@dataclass(frozen=True)
class Counting:
    """Reads the number that it is given as a state."""

    size: int = 2

    def __call__(self, state: Any) -> FloatArray:
        return np.full(2, float(state))


def test_noise_is_a_function_of_seed_name_and_number() -> None:
    noise = Noise(0.1, 7, "bend")
    backwards = [noise.at(k, 3) for k in (5, 1, 0)]
    for k, values in zip((5, 1, 0), backwards, strict=True):
        assert_array_equal(values, Noise(0.1, 7, "bend").at(k, 3))
    assert not np.array_equal(backwards[0], backwards[1])
    assert not np.array_equal(noise.at(0, 3), Noise(0.1, 8, "bend").at(0, 3))
    assert not np.array_equal(noise.at(0, 3), Noise(0.1, 7, "other").at(0, 3))


def test_noise_has_the_deviation_that_it_is_given() -> None:
    """A mean of n squares is off by sqrt(2/n): four of these are never passed in practice."""
    values = np.concatenate([Noise(0.5, 1, "x").at(k, 100) for k in range(200)])
    assert abs((values**2).mean() / 0.25 - 1.0) < 4.0 * np.sqrt(2.0 / len(values))
    assert abs(values.mean()) < 4.0 * 0.5 / np.sqrt(len(values))


def test_readings_arrive_late_by_whole_samples() -> None:
    sensor = Sensor("s", Counting(), late=2)
    memory, arrived = sensor.start(), []
    for k in range(5):
        values, memory = sensor.read(k, k, memory)  # type: ignore[arg-type]
        arrived.append(values[0])
    # the first one stands for those before it
    assert arrived == [0.0, 0.0, 0.0, 1.0, 2.0]


def test_noise_belongs_to_when_it_was_read() -> None:
    noise = Noise(0.3, 2, "s")
    sensor = Sensor("s", Counting(), noise, late=1)
    memory = sensor.start()
    _, memory = sensor.read(0, 0, memory)  # type: ignore[arg-type]
    values, _ = sensor.read(1, 1, memory)  # type: ignore[arg-type]
    assert_array_equal(values, noise.at(0, 2))
