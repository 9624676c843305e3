"""Joints of rods: every pair of edges between which bending and twist pass."""

from __future__ import annotations

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ...frozen import frozen
from ...mesh.topology.rods import chains, rod_stencils
from ..bodies.geometry import Geometry


@frozen
class Joints:
    """Pairs of edges at a node, walls of clamps included.

    Attributes:
        triples: Nodes, shape (J, 3).
        pairs: Edges, shape (J, 2).
        signs: Walking directions, shape (J, 2).
        halves: Length of either edge that bends at the joint [m], shape (J, 2).
        rods: Rod of either edge, shape (J, 2).
        numbers: Number of the joint along the rod of either edge, shape (J, 2); at the ends of a rod, walls
            too, that of its neighbour.
        loose: Whether bending and twist do not pass, shape (J, 2).
        counts: Joints of each rod, whatever their kind, shape (rods,).
    """

    triples: IntArray
    pairs: IntArray
    signs: FloatArray
    halves: FloatArray
    rods: IntArray
    numbers: IntArray
    loose: BoolArray
    counts: IntArray

    @property
    def voronoi(self) -> FloatArray:
        """Length over which each joint bends [m], shape (J,)."""
        length: FloatArray = self.halves.sum(axis=1)
        return length

    @property
    def rod(self) -> IntArray:
        """Rod of each joint, -1 between rods, shape (J,)."""
        return np.where(self.rods[:, 0] == self.rods[:, 1], self.rods[:, 0], -1)

    @property
    def number(self) -> IntArray:
        """Number of each joint along its rod, 0 between rods, shape (J,)."""
        return np.where(self.rod < 0, 0, self.numbers[:, 0])

    def some(self, kept: BoolArray) -> Joints:
        """Those of a mask (J,)."""
        return Joints(
            self.triples[kept],
            self.pairs[kept],
            self.signs[kept],
            self.halves[kept],
            self.rods[kept],
            self.numbers[kept],
            self.loose[kept],
            self.counts,
        )

    def followed_by(self, other: Joints) -> Joints:
        """These, then others of the same rods."""
        return Joints(
            np.concatenate((self.triples, other.triples)),
            np.concatenate((self.pairs, other.pairs)),
            np.concatenate((self.signs, other.signs)),
            np.concatenate((self.halves, other.halves)),
            np.concatenate((self.rods, other.rods)),
            np.concatenate((self.numbers, other.numbers)),
            np.concatenate((self.loose, other.loose)),
            self.counts,
        )


@frozen
class Edges:
    """All edges, walls included.

    Attributes:
        positions: Rest positions of all nodes, those of walls included [m], shape (N + W, 3).
        ends: Their nodes, shape (E + W, 2).
        rest: Their lengths [m], shape (E + W,).
        rigid: Whether they bend nothing, shape (E + W,).
        rod: Their rods, shape (E + W,).
        turning: Numbers of their ends, the same where they turn as one, shape (E + W, 2).
    """

    positions: FloatArray
    ends: IntArray
    rest: FloatArray
    rigid: BoolArray
    rod: IntArray
    turning: IntArray


def make_joints(geometry: Geometry, edges: Edges) -> Joints:
    """All joints through which bending or twist passes."""
    triples, pairs, signs = rod_stencils(len(edges.positions), edges.ends)
    passing = geometry.turning.passing(*turning_at(edges.turning, pairs, signs))
    kept = passing.any(axis=1)
    triples, pairs, signs, passing = triples[kept], pairs[kept], signs[kept], passing[kept]
    rods = edges.rod[pairs]
    halves = np.where(edges.rigid, 0.0, 0.5 * edges.rest)[pairs]
    # between two held edges nothing can bend; any length will do
    held = halves.sum(axis=1) == 0.0
    halves[held] = 0.5 * edges.rest[pairs[held]]
    numbers = number_joints(geometry, triples, rods)
    same = rods[:, 0] == rods[:, 1]
    counts = np.zeros(len(geometry.rods), dtype=np.int64)
    np.maximum.at(counts, rods[same, 0], numbers[same, 0] + 1)
    return Joints(triples, pairs, signs.astype(np.float64), halves, rods, numbers, ~passing, counts)


def turning_at(ends: IntArray, pairs: IntArray, signs: IntArray) -> tuple[IntArray, IntArray]:
    """Numbers of the two ends that meet at each joint, each shape (J,).

    Args:
        ends: Those of all ends of edges, shape (E, 2).
        pairs: Edges of the joints, shape (J, 2).
        signs: Walking directions, shape (J, 2).
    """
    # the first edge is walked into its node, the second one out of it
    into, out = (1 + signs[:, 0]) // 2, (1 - signs[:, 1]) // 2
    return ends[pairs[:, 0], into], ends[pairs[:, 1], out]


def number_joints(geometry: Geometry, triples: IntArray, rods: IntArray) -> IntArray:
    """Number each joint along the rods of its edges from their starts, shape (J, 2)."""
    numbers = np.zeros(rods.size, dtype=np.int64)
    at, by_rod = np.repeat(triples[:, 1], 2), np.argsort(rods, axis=None, kind="stable")
    bounds = np.searchsorted(rods.reshape(-1)[by_rod], np.arange(len(geometry.rods) + 1))
    for index, one in enumerate(geometry.rods):
        # numbered anew, so that each of many rods costs what it has
        nodes, ends = np.unique(geometry.edges[geometry.rod_edges[one.name]], return_inverse=True)
        place = np.full(len(nodes), -1)
        count = 0
        for chain in chains(len(nodes), ends.reshape(-1, 2)):
            inner = chain.nodes[1:-1] if chain.kind.value == "open" else chain.nodes
            place[inner] = count + np.arange(len(inner))
            if chain.kind.value == "open":
                # the joints at its ends count as their inner neighbours
                place[chain.nodes[0]] = count
                place[chain.nodes[-1]] = count + max(len(inner) - 1, 0)
            count += len(inner)
        mine = by_rod[bounds[index] : bounds[index + 1]]
        found = np.minimum(np.searchsorted(nodes, at[mine]), len(nodes) - 1)
        numbers[mine] = np.where(nodes[found] == at[mine], place[found], -1)
    return numbers.reshape(rods.shape)
