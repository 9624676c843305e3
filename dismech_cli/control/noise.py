"""Noise that depends on a seed, a name and the number of a sample, and on nothing that went before."""

from __future__ import annotations

import hashlib

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen


@frozen
class Noise:
    """Normal noise, a function of the number of the sample: no generator has a state to keep.

    Attributes:
        deviation: Standard deviation.
        seed: Seed.
        name: Of the sensor: others draw other numbers by the same seed.
    """

    deviation: float
    seed: int
    name: str

    def at(self, sample: int, n: int) -> FloatArray:
        """The noise of a sample, shape (n,)."""
        digest = hashlib.sha256(f"{self.seed} {self.name}".encode()).digest()
        key = np.frombuffer(digest[:16], dtype=np.uint64)
        bits = np.random.Philox(key=key, counter=[0, 0, 0, sample])
        return self.deviation * np.random.Generator(bits).standard_normal(n)
