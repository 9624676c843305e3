"""The normal force that friction goes by: that of the moment, or that at the end of the last step."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ...arrays import FloatArray, IntArray
from ...model.term import Memory


class Loads(Protocol):
    """Normal forces of pairs that are told by keys."""

    def recall(self, memory: Memory) -> None:
        """Take up what the last step left."""

    def memory(self, keys: IntArray, loads: FloatArray) -> Memory:
        """What a step leaves to the next that ends with these forces [N] on pairs of ascending keys (K,)."""

    def of(self, keys: IntArray) -> FloatArray | None:
        """Those of some pairs [N], shape (K,); None for those of the moment."""


class Implicit:
    """That of the moment; implements :class:`Loads`."""

    def recall(self, memory: Memory) -> None:
        """Nothing is left to it."""

    def memory(self, keys: IntArray, loads: FloatArray) -> Memory:
        """Nothing."""
        return {}

    def of(self, keys: IntArray) -> None:
        """None: those of the moment."""


class Lagged:
    """That at the end of the last step, as the family has it; implements :class:`Loads`."""

    def __init__(self, name: str) -> None:
        """Begin without any.

        Args:
            name: Under which checkpoints have them.
        """
        self._name = name
        self._keys, self._loads = np.empty(0, dtype=np.int64), np.empty(0)

    def recall(self, memory: Memory) -> None:
        """Take up those of a state."""
        keys, self._loads = memory.get(self._name, np.empty((2, 0)))
        self._keys = keys.astype(np.int64)

    def memory(self, keys: IntArray, loads: FloatArray) -> Memory:
        """They, with their keys."""
        return {self._name: np.stack((keys.astype(np.float64), loads))}

    def of(self, keys: IntArray) -> FloatArray:
        """Those of some pairs; 0 of what did not touch."""
        out = np.zeros(len(keys))
        if len(self._keys):
            place = np.minimum(np.searchsorted(self._keys, keys), len(self._keys) - 1)
            out = np.where(self._keys[place] == keys, self._loads[place], 0.0)
        return out
