"""Pairs that have places in the matrix: tight to come, wide once they come, slow to go."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from ...arrays import IntArray, union
from ...model.term import Memory
from .candidates import among

# Pairs that are out of reach are kept as long as they are fewer than this share, and a few.
_STALE: Final = 0.3
_FEW: Final = 10


class Placed:
    """Keeps the keys of such pairs, ascending, and makes what follows from them anew when they change."""

    keys: IntArray
    _changed: bool

    def __init__(self, name: str, make: Callable[[IntArray], None]) -> None:
        """Begin with none.

        Args:
            name: Under which checkpoints have them.
            make: Called with the keys, shape (P,), whenever they change.
        """
        self._name, self._make = name, make
        self._take(np.empty(0, dtype=np.int64))

    def recall(self, memory: Memory) -> None:
        """Take up those of a state."""
        keys = memory.get(self._name, np.empty(0)).astype(np.int64)
        if not np.array_equal(keys, self.keys):
            self._take(keys)

    def memory(self, near: IntArray) -> Memory:
        """They; if too many of them are far apart, those that are ``near``, shape (Q,)."""
        many = len(self.keys) > (1.0 + _STALE) * len(near) + _FEW
        return {self._name: (near if many else self.keys).astype(np.float64)}

    def detect(self, touching: IntArray, near: Callable[[], IntArray]) -> bool:
        """Give places to all pairs nearby if one that touches has none; whether they are others now."""
        if not among(touching, self.keys).all():
            self._take(union(near(), self.keys))
        changed = self._changed
        self._changed = False
        return changed

    def _take(self, keys: IntArray) -> None:
        self.keys, self._changed = keys, True
        self._make(keys)
