"""Pairs of shells that must keep a distance: edges with edges, and nodes with triangles."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...kinematics.dofs import DofMap
from ..drivers.loops import Loops
from ..nearby.candidates import among, distinct
from ..nearby.faces import Faces
from ..nearby.searches import Nearby, Searches
from ..points.barrier import Closest
from ..points.closest import closest_of_points, closest_of_segments
from .guarded import Traits


@frozen
class SheetEdges:
    """Edges of rods and shells with those of shells; implements :class:`.guarded.Pairing`.

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


@frozen
class SheetNodes:
    """Nodes of rods and shells with triangles of shells; implements :class:`.guarded.Pairing`.

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
