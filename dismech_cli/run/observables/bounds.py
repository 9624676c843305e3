"""Bounds on how far a state of rods is from what their model means: told without roots and angles."""

from __future__ import annotations

from typing import Final

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from .snapshot import Snapshot

# What is nearer to its limit than this is measured: far more than rounding, of cosines and of shares.
_SLACK: Final = 1e-9


@frozen
class SlightTurns:
    """Tells whether all joints of rods turn by less than angles.

    Attributes:
        at: Places of the three nodes of each joint in a flat array of positions, shape (3, 3, J): by node,
            component and joint.
        cosines: Of the angles; less than -1 where any angle will do, shape (J,).
    """

    at: IntArray
    cosines: FloatArray

    @classmethod
    def of(cls, triples: IntArray, angles: FloatArray) -> SlightTurns:
        """Bound of joints with nodes (J, 3) by angles [rad], shape (J,)."""
        cosines = np.where(angles < np.pi, np.cos(np.minimum(angles, np.pi)) + _SLACK, -2.0)
        return cls(_components(triples), cosines)

    def __call__(self, s: Snapshot) -> bool:
        """Whether they do; edges without length turn as if not."""
        a, b, c = s.positions.ravel().take(self.at, mode="clip")
        u, w = b - a, c - b
        sizes = np.sqrt((u * u).sum(axis=0) * (w * w).sum(axis=0))
        return bool(((u * w).sum(axis=0) > self.cosines * sizes).all())


@frozen
class SlightStrain:
    """Tells whether all edges are strained by less than a share, as :class:`.limits.RodStrain` has it.

    Attributes:
        at: Places of the two nodes of each edge, as in :class:`SlightTurns`, shape (2, 3, K).
        rest: Rest lengths [m], shape (K,).
        energy: Name of the stretching energy.
        stencils: Places of the edges in it, shape (K,).
        limit: The share.
    """

    at: IntArray
    rest: FloatArray
    energy: str
    stencils: IntArray
    limit: float

    @classmethod
    def of(
        cls, edges: IntArray, rest: FloatArray, energy: str, stencils: IntArray, limit: float
    ) -> SlightStrain:
        """Bound of edges with nodes (K, 2)."""
        return cls(_components(edges), rest, energy, stencils, limit * (1.0 - _SLACK))

    def __call__(self, s: Snapshot) -> bool:
        """Whether they are."""
        tail, head = s.positions.ravel().take(self.at, mode="clip")
        e = head - tail
        longer = 1.0 + s.natural(self.energy)[0].take(self.stencils)
        change = np.abs(np.sqrt((e * e).sum(axis=0)) - self.rest * longer)
        return bool((change < self.limit * self.rest * np.maximum(longer, 1.0)).all())


def _components(nodes: IntArray) -> IntArray:
    """Places of the components of nodes (J, K) in a flat array of positions, shape (K, 3, J)."""
    return np.ascontiguousarray(3 * nodes.T[:, None, :] + np.arange(3)[:, None])
