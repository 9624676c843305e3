"""What a run tells of contact at its end, and the events of it: read from what steps leave in the state."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..model.state import State


@frozen
class Penetration:
    """How deep two bodies were in each other, and where and when.

    Attributes:
        share: Depth as a share of the thickness.
        pair: Names of the two.
        node: A node there.
        t: Time [s].
    """

    share: float
    pair: tuple[str, str]
    node: int
    t: float


@frozen
class Touched:
    """Reads what contact leaves in a state.

    Attributes:
        worst: Name of the array with the deepest penetration so far: share, pair, line and time.
        places: Names of the arrays with the pairs that have places in the matrix.
        pairs: Names of the pairs of bodies.
        nodes: A node of each line, shape (E,).
        tolerance: Share of the thickness that is allowed.
    """

    worst: str
    places: tuple[str, ...]
    pairs: tuple[tuple[str, str], ...]
    nodes: IntArray
    tolerance: float

    def deepest(self, state: State) -> Penetration | None:
        """The deepest penetration up to a state; None if nothing touched."""
        share, label, line, t = state.memory.get(self.worst, np.zeros(4)).tolist()
        if share <= 0.0:
            return None
        return Penetration(share, self.pairs[int(label)], int(self.nodes[int(line)]), t)

    def too_deep(self, before: State, after: State) -> Penetration | None:
        """A step's penetration, if it is beyond the tolerance and deeper than ever before."""
        found = self.deepest(after)
        if found is None or found.share <= self.tolerance:
            return None
        last = self.deepest(before)
        return found if last is None or found.share > last.share else None

    def rebuilt(self, before: State, after: State) -> Mapping[str, int] | None:
        """Pairs that have places after a step, and how many came and went in it; None if none did."""
        came = gone = count = 0
        for name in self.places:
            old, new = _pairs(before, name), _pairs(after, name)
            count += len(new)
            common = len(np.intersect1d(old, new, assume_unique=True))
            came, gone = came + len(new) - common, gone + len(old) - common
        return {"pairs": count, "came": came, "gone": gone} if came or gone else None


def _pairs(state: State, name: str) -> FloatArray:
    return state.memory.get(name, np.empty(0))
