"""Wings that fold within a step: the balances of a long step, each at a least of energy, are told apart."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from dismech_cli import simulate
from dismech_cli.run.loop import Limits

RAY = Path(__file__).parents[2] / "scenarios" / "manta_ray.yaml"


@pytest.fixture(scope="module")
def fine() -> np.ndarray:
    """Nodes after 16 ms in steps of 0.5 ms, where there is one balance."""
    return spread("0.5 ms")[0]


def spread(dt: str) -> tuple[np.ndarray, int]:
    """Nodes after 16 ms, and the steps cut."""
    report = simulate(
        RAY,
        overrides=[f"numerics.dt={dt}", "output.every=16 ms", "output.probes={}"],
        limits=Limits(until=0.0161),
    )
    frame = next(f for f in report.frames if abs(f.t - 0.016) < 1e-9)
    return frame.positions, report.outcome.counters["cuts"]


@pytest.mark.parametrize("dt", ["2 ms", "4 ms"])
def test_long_steps_take_the_balance_that_short_ones_do(fine: np.ndarray, dt: str) -> None:
    positions, cuts = spread(dt)
    moved = np.abs(fine[:, 2]).max()
    # the wrong balance is off by half of the motion, implicit Euler by its order: 2 to 4 %
    assert np.abs(positions - fine).max() < 0.1 * moved
    assert cuts > 0


def test_short_steps_are_not_doubted() -> None:
    assert spread("1 ms")[1] == 0
