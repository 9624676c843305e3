"""Pairs that must keep a distance: edges of rods and shells, and nodes of shells with triangles."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from ...arrays import FloatArray, IntArray
from ...kinematics.dofs import DofMap
from ..drivers.loops import Loops
from ..law.between import Between
from ..nearby.candidates import among, distinct
from ..nearby.faces import Faces
from ..nearby.neighbours import Neighbours
from ..nearby.searches import Nearby, Searches
from ..points.barrier import Closest
from ..points.closest import closest_of_points, closest_of_segments


@dataclass(frozen=True, slots=True)
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


@dataclass(frozen=True, slots=True)
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


@dataclass(frozen=True, slots=True)
class SheetEdges:
    """Edges of rods and shells with those of shells; implements :class:`Pairing`.

    Attributes:
        all: Who may touch shells.
        sides: Lines that are the sides of each triangle, shape (T, 3).
        excluded: Keys of pairs that are too near along a body, ascending.
    """

    all: Faces
    sides: IntArray
    excluded: IntArray
    name: str = "contact.guarded.edges"

    @property
    def map(self) -> DofMap:
        """Numbering of the DOFs."""
        return self.all.map

    def search(self, x: FloatArray, more: float) -> IntArray:
        """Keys of pairs that may touch or be ``more`` [m] farther apart, ascending."""
        return self.parts(self.all.search(x, more))

    def nearby(self, searches: Searches) -> Nearby:
        """What finds lines and triangles."""
        return searches.faces

    def parts(self, keys: IntArray) -> IntArray:
        """Lines with the sides of triangles."""
        line, face = self.all.pairs(keys).T
        keys = self.keys(np.repeat(line, 3), self.sides[face].reshape(-1))
        return keys[~among(keys, self.excluded)]

    def keys(self, one: IntArray, other: IntArray) -> IntArray:
        """Keys of pairs of lines, the lower number first, ascending, each once."""
        low, high = np.minimum(one, other), np.maximum(one, other)
        return distinct(low * len(self.all.lines.nodes) + high)

    def nodes(self, keys: IntArray) -> IntArray:
        """The four nodes of each pair."""
        return self.all.lines.nodes[self._pairs(keys)].reshape(-1, 4)

    def spans(self, keys: IntArray) -> IntArray:
        """The same: lines and segments."""
        return self.nodes(keys)

    def distances(self, x: FloatArray, keys: IntArray, loops: Loops) -> FloatArray:
        """Distances of segments."""
        return loops.segment_distances(x, self.nodes(keys))

    def lines(self, keys: IntArray) -> IntArray:
        """The first line of each pair."""
        return self._pairs(keys)[:, 0]

    def closest(self, ends: FloatArray) -> Closest:
        """Closest points of pairs."""
        return closest_of_segments(ends)

    def reach(self, keys: IntArray) -> FloatArray:
        """Distance at which they touch."""
        (first, second), every = self._pairs(keys).T, self.all
        bodies, radii, own = every.lines.bodies, every.lines.radii, every.own_reach
        own = np.where(bodies[first] == bodies[second], np.minimum(own[first], own[second]), np.inf)
        return np.asarray(np.minimum(radii[first] + radii[second], own))

    def traits(self, keys: IntArray) -> Traits:
        """What they are made of."""
        every, pairs = self.all, self._pairs(keys)
        lines, one, other = every.lines, *every.lines.bodies[pairs].T
        stiff = (lines.lengths * lines.weights)[pairs]
        # rods come first, and never are what is faced
        scale = every.stiffness[one, other] * stiff.max(axis=1)
        return Traits(self.reach(keys), scale, every.between(one, other))

    def _pairs(self, keys: IntArray) -> IntArray:
        return np.stack(np.divmod(keys, len(self.all.lines.nodes)), axis=1)


@dataclass(frozen=True, slots=True)
class SheetNodes:
    """Nodes of rods and shells with triangles of shells; implements :class:`Pairing`.

    Attributes:
        all: Who may touch shells.
        ends: A line of each node, shape (N,), -1 where there is none.
        excluded: Keys of nodes and triangles that are too near along a body, ascending.
        own_reach: Most that the reach of a node to its own body may be [m], shape (N,).
    """

    all: Faces
    ends: IntArray
    excluded: IntArray
    own_reach: FloatArray
    name: str = "contact.guarded.nodes"

    @property
    def map(self) -> DofMap:
        """Numbering of the DOFs."""
        return self.all.map

    def search(self, x: FloatArray, more: float) -> IntArray:
        """Keys of pairs that may touch or be ``more`` [m] farther apart, ascending."""
        return self.parts(self.all.search(x, more))

    def nearby(self, searches: Searches) -> Nearby:
        """What finds lines and triangles."""
        return searches.faces

    def parts(self, keys: IntArray) -> IntArray:
        """The ends of lines with triangles."""
        line, face = self.all.pairs(keys).T
        keys = self.keys(self.all.lines.nodes[line], face[:, None])
        return keys[~among(keys, self.excluded)]

    def keys(self, nodes: IntArray, faces: IntArray) -> IntArray:
        """Keys of nodes and triangles, ascending, each once."""
        return distinct(nodes * len(self.all.surface.nodes) + faces)

    def nodes(self, keys: IntArray) -> IntArray:
        """The node and the corners."""
        node, face = self._pairs(keys)
        return np.column_stack((node, self.all.surface.nodes[face]))

    def spans(self, keys: IntArray) -> IntArray:
        """Lines without length and triangles."""
        node, face = self._pairs(keys)
        return np.column_stack((node, node, self.all.surface.nodes[face]))

    def distances(self, x: FloatArray, keys: IntArray, loops: Loops) -> FloatArray:
        """Distances of nodes from triangles."""
        return loops.face_distances(x, self.spans(keys))

    def lines(self, keys: IntArray) -> IntArray:
        """A line of each node."""
        return self.ends[self._pairs(keys)[0]]

    def closest(self, ends: FloatArray) -> Closest:
        """Closest points of pairs."""
        return closest_of_points(ends[0], ends[1:])

    def reach(self, keys: IntArray) -> FloatArray:
        """Distance at which they touch."""
        every, (node, face) = self.all, self._pairs(keys)
        pairs = np.column_stack((self.ends[node], face))
        one, other = every.bodies(pairs)
        own = np.where(one == other, self.own_reach[node], np.inf)
        return np.minimum(every.thickness(pairs), own)

    def traits(self, keys: IntArray) -> Traits:
        """What they are made of."""
        every, (node, face) = self.all, self._pairs(keys)
        pairs = np.column_stack((self.ends[node], face))
        one, other = every.bodies(pairs)
        return Traits(self.reach(keys), every.factor(pairs), every.between(one, other))

    def _pairs(self, keys: IntArray) -> tuple[IntArray, IntArray]:
        node, face = np.divmod(keys, len(self.all.surface.nodes))
        return node, face


@dataclass(frozen=True, slots=True)
class Eased:
    """Pairs some of which start nearer than a core begins: theirs begins where they start.

    Implements :class:`Pairing`.

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
