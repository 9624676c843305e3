"""Kernels on all stencils at once, so many per call that what is between fits into the cache."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ..arrays import FloatArray
from .replay import Replay

# Stencils per call: temporaries of a chunk stay in the second-level cache.
_CHUNK = 2048


class Batches:
    """A kernel on batches of any width."""

    def __init__(self, function: Callable[..., Any]) -> None:
        """Take nothing down yet.

        Args:
            function: Arrays to results, each a number, an array or a tuple of these.
        """
        self._function = function
        self._replays: dict[int, Replay] = {}

    def evaluate(self, wanted: tuple[int, ...], out: Sequence[FloatArray], *given: FloatArray) -> None:
        """Write some results to arrays.

        Args:
            wanted: Their places.
            out: An array for each of them, shape (rows, S).
            given: Arguments of the kernel, each of shape (rows, S).
        """
        count = given[0].shape[1]
        for start in range(0, count, _CHUNK):
            chunk = slice(start, min(start + _CHUNK, count))
            replay = self._of(chunk.stop - start, given)
            for target, source in zip(replay.inputs, given, strict=True):
                target[:] = source[:, chunk]
            for whole, rows in zip(out, replay.run(wanted), strict=True):
                np.concatenate(rows, out=whole[:, chunk])

    def _of(self, width: int, given: Sequence[FloatArray]) -> Replay:
        if width not in self._replays:
            self._replays[width] = Replay(self._function, [len(one) for one in given], width)
        return self._replays[width]
