"""What sensors and controllers show of themselves."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ...arrays import FloatArray, IntArray
from ...control.sensor import Reading
from ...frozen import frozen
from ...model.state import State
from .snapshot import Snapshot

OVER: Mapping[str, Callable[[FloatArray], float]] = {
    "mean": lambda x: float(x.mean()),
    "rms": lambda x: float(np.sqrt((x * x).mean())),
    "max": lambda x: float(x.max()),
    "min": lambda x: float(x.min()),
}
"""One number from those of all places."""

SIZE: Mapping[str, Callable[[FloatArray], float]] = {
    "rms": OVER["rms"],
    "max": lambda x: float(np.abs(x).max()),
}
"""One size from those of all places."""


@frozen
class AtPlaces:
    """Values at some places of a body, as one number.

    Attributes:
        values: The values at a state.
        over: Makes one of them.
        unit: SI unit.
    """

    values: Reading | Callable[[State], FloatArray]
    over: Callable[[FloatArray], float]
    unit: str

    def __call__(self, s: Snapshot) -> float:
        """Read it."""
        return self.over(self.values(s.state))


@frozen
class ShapeDistance:
    """Root mean square of the distances of nodes from places.

    Attributes:
        nodes: The nodes, shape (N,).
        wanted: The places [m], shape (N, 3).
    """

    nodes: IntArray
    wanted: FloatArray
    unit: str = "m"

    def __call__(self, s: Snapshot) -> float:
        """Read it."""
        off = s.positions[self.nodes] - self.wanted
        return float(np.sqrt((off * off).sum(axis=1).mean()))
