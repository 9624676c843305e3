"""Pairs that must keep a distance, and those of rods: edges with edges."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...kinematics.dofs import DofMap
from ..drivers.loops import Loops
from ..law.between import Between
from ..nearby.neighbours import Neighbours
from ..nearby.searches import Nearby, Searches
from ..points.barrier import Closest
from ..points.closest import closest_of_segments


@frozen
class Traits:
    """What pairs are made of.

    Attributes:
        thickness: Distance at which they touch [m], shape (K,).
        stiffness: k at factor one [N/m], shape (K,).
        between: What their bodies are to each other.
    """

    thickness: FloatArray
    stiffness: FloatArray
    between: Between


class Pairing(Protocol):
    """Pairs of a kind, told by keys."""

    @property
    def name(self) -> str:
        """Under which checkpoints have them."""

    @property
    def map(self) -> DofMap:
        """Numbering of the DOFs."""

    def search(self, x: FloatArray, more: float) -> IntArray:
        """Keys of pairs that may touch or be ``more`` [m] farther apart, ascending."""

    def nearby(self, searches: Searches) -> Nearby:
        """What finds the pairs that they are parts of, in a run."""

    def parts(self, keys: IntArray) -> IntArray:
        """Keys of pairs that are parts of those that are found, ascending, each once."""

    def nodes(self, keys: IntArray) -> IntArray:
        """The four nodes of each pair, shape (K, 4)."""

    def spans(self, keys: IntArray) -> IntArray:
        """The same as lines and segments, shape (K, 4), or as lines and triangles, shape (K, 5)."""

    def distances(self, x: FloatArray, keys: IntArray, loops: Loops) -> FloatArray:
        """Distances at nodes (N, 3) [m], shape (K,)."""

    def lines(self, keys: IntArray) -> IntArray:
        """A line of the first of each pair, shape (K,)."""

    def closest(self, ends: FloatArray) -> Closest:
        """Closest points of pairs with nodes (4, 3, K) [m]."""

    def reach(self, keys: IntArray) -> FloatArray:
        """Distance at which they touch [m], shape (K,)."""

    def traits(self, keys: IntArray) -> Traits:
        """What they are made of."""


@frozen
class RodEdges:
    """Edges of rods; implements :class:`Pairing`."""

    all: Neighbours
    name: str = "contact.guarded.rods"

    @property
    def map(self) -> DofMap:
        """Numbering of the DOFs."""
        return self.all.map

    def search(self, x: FloatArray, more: float) -> IntArray:
        """Keys of pairs that may touch or be ``more`` [m] farther apart, ascending."""
        return np.sort(self.all.keys(self.all.search(x, more)))

    def nearby(self, searches: Searches) -> Nearby:
        """What finds rods."""
        return searches.rods

    def parts(self, keys: IntArray) -> IntArray:
        """The same."""
        return keys

    def nodes(self, keys: IntArray) -> IntArray:
        """The four nodes of each pair."""
        return self.all.lines.nodes[self.all.pairs(keys)].reshape(-1, 4)

    def spans(self, keys: IntArray) -> IntArray:
        """The same: lines and segments."""
        return self.nodes(keys)

    def distances(self, x: FloatArray, keys: IntArray, loops: Loops) -> FloatArray:
        """Distances of segments."""
        return loops.segment_distances(x, self.nodes(keys))

    def lines(self, keys: IntArray) -> IntArray:
        """The first line of each pair."""
        return self.all.pairs(keys)[:, 0]

    def closest(self, ends: FloatArray) -> Closest:
        """Closest points of pairs."""
        return closest_of_segments(ends)

    def reach(self, keys: IntArray) -> FloatArray:
        """Distance at which they touch."""
        return self.all.reach(self.all.pairs(keys))

    def traits(self, keys: IntArray) -> Traits:
        """What they are made of."""
        every, pairs = self.all, self.all.pairs(keys)
        one, other = every.lines.bodies[pairs].T
        stiff = (every.stiffness * every.lines.lengths)[pairs].max(axis=1)
        return Traits(every.reach(pairs), stiff, every.between(one, other))
