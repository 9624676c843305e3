"""The grid of a run, and where its clock stands after steps that succeed and fail."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from dismech_cli.kinematics.rod_frames import NoFrames
from dismech_cli.model.state import State
from dismech_cli.run.clock import Clock, time_grid
from dismech_cli.solve.status import Status
from dismech_cli.solve.step_result import StepResult

_Q = np.zeros(2)
RESULT = StepResult(State(0.0, _Q, _Q, _Q, NoFrames().rest(_Q)), Status.CONVERGED, 1, 0.0, _Q, -1)


def test_releases_are_on_the_grid_once() -> None:
    assert_array_equal(time_grid(0.25, 1.0), [0.0, 0.25, 0.5, 0.75, 1.0])
    # one between two multiples of dt, one next to a multiple, one after the end
    grid = time_grid(0.25, 1.0, (0.3, 0.5 + 1e-12, 2.0))
    assert_array_equal(grid, [0.0, 0.25, 0.3, 0.5 + 1e-12, 0.75, 1.0])


def test_cuts_are_dyadic_and_regrow() -> None:
    clock = Clock(np.array([0.0, 1.0, 2.0, 3.0]), max_cuts=2).failed().failed()
    assert clock.exhausted
    times = []
    while not clock.done:
        times.append(clock.target)
        clock = clock.accepted(RESULT)
    # quarters until a half is full, and the next step begins one level coarser than the last ended
    assert times == [0.25, 0.5, 1.0, 2.0, 3.0]


@pytest.mark.parametrize("cuts", [0, 1, 5])
def test_a_clock_comes_back_from_its_numbers(cuts: int) -> None:
    start = Clock(time_grid(0.1, 1.0), max_cuts=9)
    clock = start.accepted(RESULT)
    for _ in range(cuts):
        clock = clock.failed()
    clock = clock.accepted(RESULT)
    restored = start.restore(clock.arrays(), clock.numbers())
    assert (restored.target, restored.exhausted) == (clock.target, clock.exhausted)
    assert restored.numbers() == clock.numbers()
