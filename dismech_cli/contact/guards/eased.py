"""Pairs some of which start nearer than a core begins."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...kinematics.dofs import DofMap
from ..drivers.loops import Loops
from ..nearby.candidates import among
from ..nearby.searches import Nearby, Searches
from ..points.barrier import Closest
from .guarded import Pairing, Traits


@frozen
class Eased:
    """Pairs some of which start nearer than a core begins: theirs begins where they start.

    Implements :class:`.guarded.Pairing`.

    Attributes:
        all: The pairs as they are.
        keys: Of those that start nearer, ascending, shape (P,).
        thickness: That these count as having [m], shape (P,).
    """

    all: Pairing
    keys: IntArray
    thickness: FloatArray

    @property
    def name(self) -> str:
        """Under which checkpoints have them."""
        return self.all.name

    @property
    def map(self) -> DofMap:
        """Numbering of the DOFs."""
        return self.all.map

    def search(self, x: FloatArray, more: float) -> IntArray:
        """Keys of pairs that may touch or be ``more`` [m] farther apart, ascending."""
        return self.all.search(x, more)

    def nearby(self, searches: Searches) -> Nearby:
        """What finds the pairs that they are parts of."""
        return self.all.nearby(searches)

    def parts(self, keys: IntArray) -> IntArray:
        """Keys of pairs that are parts of those that are found."""
        return self.all.parts(keys)

    def nodes(self, keys: IntArray) -> IntArray:
        """The four nodes of each pair."""
        return self.all.nodes(keys)

    def spans(self, keys: IntArray) -> IntArray:
        """The same as lines and what they face."""
        return self.all.spans(keys)

    def distances(self, x: FloatArray, keys: IntArray, loops: Loops) -> FloatArray:
        """Distances of pairs."""
        return self.all.distances(x, keys, loops)

    def lines(self, keys: IntArray) -> IntArray:
        """A line of the first of each pair."""
        return self.all.lines(keys)

    def closest(self, ends: FloatArray) -> Closest:
        """Closest points of pairs."""
        return self.all.closest(ends)

    def reach(self, keys: IntArray) -> FloatArray:
        """Distance at which they touch."""
        thickness = self.all.reach(keys)
        near = among(keys, self.keys)
        thickness[near] = self.thickness[np.searchsorted(self.keys, keys[near])]
        return thickness

    def traits(self, keys: IntArray) -> Traits:
        """What they are made of."""
        return replace(self.all.traits(keys), thickness=self.reach(keys))


def eased(pairing: Pairing, x: FloatArray, begin: float) -> Eased:
    """Pairs whose barrier begins at a share of the thickness, or where they start if that is nearer.

    Args:
        pairing: The pairs.
        x: Where nodes start (N, 3) [m].
        begin: The share.
    """
    keys = pairing.search(x, 0.0)
    ends = np.ascontiguousarray(x[pairing.nodes(keys)].transpose(1, 2, 0))
    distance, thickness = pairing.closest(ends).distance, pairing.reach(keys)
    near = distance < begin * thickness
    return Eased(pairing, keys[near], distance[near] / begin)
