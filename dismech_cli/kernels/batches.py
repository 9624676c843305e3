"""Kernels on all stencils at once, so many per call that what is between fits into the cache."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np

from ..arrays import FloatArray
from .replay import Replay, rows_of

# Stencils per call: temporaries of a chunk stay in the second-level cache.
_CHUNK: Final = 2048

# So often a kernel runs as it stands: to take down its calls costs as much as it saves in twenty runs.
_FEW: Final = 4


class Batches:
    """A kernel on batches of any width."""

    def __init__(self, function: Callable[..., Any]) -> None:
        """Take nothing down yet.

        Args:
            function: Arrays to results, each a number, an array or a tuple of these.
        """
        self._function = function
        self._runs: defaultdict[int, int] = defaultdict(int)
        self._replays: dict[int, Replay] = {}

    def evaluate(self, wanted: tuple[int, ...], out: Sequence[FloatArray], *given: FloatArray) -> None:
        """Write some results to arrays.

        Args:
            wanted: Their places.
            out: An array for each of them, shape (rows, S).
            given: Arguments of the kernel, each of shape (rows, S).
        """
        count = given[0].shape[1]
        if 0 < count <= _CHUNK:
            self._evaluate(wanted, out, given)
            return
        for start in range(0, count, _CHUNK):
            chunk = slice(start, start + _CHUNK)
            self._evaluate(wanted, [one[:, chunk] for one in out], [one[:, chunk] for one in given])

    def _evaluate(
        self, wanted: tuple[int, ...], out: Sequence[FloatArray], given: Sequence[FloatArray]
    ) -> None:
        for target, rows in zip(out, self._run(wanted, given), strict=True):
            np.concatenate(rows, out=target)

    def _run(self, wanted: tuple[int, ...], given: Sequence[FloatArray]) -> Sequence[Sequence[FloatArray]]:
        """Arrays (k, S) of each result that is wanted, one below the other."""
        width = given[0].shape[1]
        replay = self._replays.get(width)
        if replay is not None:
            return replay.run(wanted, given)
        self._runs[width] += 1
        if self._runs[width] > _FEW:
            self._replays[width] = Replay(self._function, [len(one) for one in given], width)
        results = self._function(*given)
        return [rows_of(results[place], width) for place in wanted]
