"""CPU time of repeated runs, its growth, and the yardstick that makes timings comparable between machines."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import cache

import numpy as np
from scipy.linalg import solveh_banded

from dismech_cli.arrays import FloatArray


def in_turns(actions: Sequence[Callable[[], object]], *, seconds: float) -> FloatArray:
    """CPU time per call of each action in each turn [s], shape (turns, actions).

    The actions take turns, so that load from other programs and changes of the clock rate meet all
    of them alike; a turn is long enough for the resolution of the process clock. The least time of
    a column is the cost of an action; two actions are compared by the median of the turns' ratios,
    because the least times of two columns may be from different clock rates.
    """
    calls = [_calls_per_turn(action) for action in actions]
    turns: list[list[float]] = []
    started = time.process_time()
    while len(turns) < 3 or time.process_time() - started < seconds:
        turns.append([_spent(action, count) / count for action, count in zip(actions, calls, strict=True)])
    return np.array(turns)


def _spent(action: Callable[[], object], count: int) -> float:
    start = time.process_time()
    for _ in range(count):
        action()
    return time.process_time() - start


def _calls_per_turn(action: Callable[[], object], turn: float = 5e-3) -> int:
    action()
    return max(1, int(turn / max(_spent(action, 1), 1e-7)))


def exponent(sizes: Sequence[float], times: Sequence[float]) -> float:
    """Fitted p of time ~ size^p; 1 is linear."""
    return float(np.polyfit(np.log(sizes), np.log(times), 1)[0])


@cache
def yardstick(nodes: int) -> Callable[[], object]:
    """R(N): SciPy's banded Cholesky solve of order 4 N with ten upper diagonals."""
    order = 4 * nodes
    band = np.full((11, order), -0.1)
    band[10] = 4.0
    rhs = np.ones(order)
    return lambda: solveh_banded(band, rhs, check_finite=False)
