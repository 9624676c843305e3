"""CPU time of repeated runs, and the yardstick that makes timings comparable between machines."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import cache

import numpy as np
from scipy.linalg import solveh_banded


def once(action: Callable[[], object]) -> float:
    """CPU time of one call [s]."""
    start = time.process_time()
    action()
    return time.process_time() - start


def alternately(actions: Sequence[Callable[[], object]], *, seconds: float) -> list[float]:
    """Least CPU time per call of each action [s].

    The actions take turns, so that load from other programs and changes of the clock rate meet all
    of them alike; a turn is long enough for the resolution of the process clock.
    """
    calls = [_calls_per_turn(action) for action in actions]
    best = [np.inf] * len(actions)
    started, turns = time.process_time(), 0
    while turns < 3 or time.process_time() - started < seconds:
        for index, (action, count) in enumerate(zip(actions, calls, strict=True)):
            spent = once(lambda action=action, count=count: [action() for _ in range(count)])
            best[index] = min(best[index], spent / count)
        turns += 1
    return best


def _calls_per_turn(action: Callable[[], object], turn: float = 2e-3) -> int:
    action()
    return max(1, int(turn / max(once(action), 1e-7)))


@cache
def yardstick(nodes: int) -> Callable[[], object]:
    """R(N): SciPy's banded Cholesky solve of order 4 N with ten upper diagonals."""
    order = 4 * nodes
    band = np.full((11, order), -0.1)
    band[10] = 4.0
    rhs = np.ones(order)
    return lambda: solveh_banded(band, rhs, check_finite=False)
