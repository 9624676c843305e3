"""Which ends of edges turn as one: between them bending and twist pass."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import combinations

import numpy as np

from ...arrays import BoolArray, IntArray
from ...frozen import frozen
from ...mesh.topology.components import components

RELEASED = ("bending", "twist")
"""What a joint may keep from passing, in the order of columns."""


@frozen
class Turning:
    """How the edges of rods turn with each other where they meet.

    Attributes:
        ends: A number for each end of each edge; ends of one number meet at one node and turn as one,
            shape (E, 2).
        partial: For bending and for twist, the pairs of numbers between which it alone does not pass,
            shape (L, 2).
    """

    ends: IntArray
    partial: Mapping[str, IntArray]

    def passing(self, first: IntArray, second: IntArray) -> BoolArray:
        """What passes between pairs of ends by their numbers: bending, twist, shape (K, 2)."""
        same = first == second
        size = int(max(first.max(initial=0), second.max(initial=0), self.ends.max(initial=0))) + 1
        keys = np.minimum(first, second) * size + np.maximum(first, second)
        linked = {}
        for what, pairs in self.partial.items():
            linked[what] = np.isin(keys, pairs.min(axis=1) * size + pairs.max(axis=1))
        some = linked["bending"] | linked["twist"]
        return np.stack([same | (some & ~linked[what]) for what in RELEASED], axis=1)

    def hanging(self) -> IntArray:
        """Numbers of the ends, the same where anything passes, counted from 0, shape (E, 2)."""
        numbers, place = np.unique(self.ends, return_inverse=True)
        pairs = np.concatenate(tuple(self.partial.values()))
        known = np.isin(pairs, numbers).all(axis=1)
        _, label = components(len(numbers), np.searchsorted(numbers, pairs[known]))
        together: IntArray = label[place.reshape(self.ends.shape)]
        return together


def whole(edges: IntArray) -> Turning:
    """Edges of each body that turn as one at each node."""
    return Turning(edges, {what: np.empty((0, 2), dtype=np.int64) for what in RELEASED})


@frozen(kw_only=True)
class Said:
    """What joints say, by the nodes of the bodies before they are joined.

    Attributes:
        rigid: Pairs that turn as one.
        linked: For bending and for twist, pairs between which it alone does not pass.
        loose: Nodes whose edges do not turn with each other.
        loosened: For bending and for twist, nodes between whose edges it alone does not pass.
        welds: Ends of edges that turn with a shell: edge and side.
    """

    rigid: Iterable[tuple[int, int]]
    linked: Mapping[str, Iterable[tuple[int, int]]]
    loose: Iterable[int]
    loosened: Mapping[str, Iterable[int]]
    welds: Iterable[tuple[int, int]]


def turning_nodes(count: int, said: Said) -> IntArray:
    """A number for each of the nodes of the bodies, the same where they turn as one, shape (N,)."""
    return components(count, _pairs(said.rigid))[1]


def make_turning(count: int, edges: IntArray, said: Said) -> Turning:
    """Number the ends of edges by what joints say.

    Args:
        count: Number of nodes of the bodies before they are joined.
        edges: Their edges, shape (E, 2).
        said: What joints say.
    """
    of_node = turning_nodes(count, said)
    ends = of_node[edges]
    own = count + np.arange(ends.size).reshape(ends.shape)
    partial = {what: [tuple(of_node[list(pair)]) for pair in said.linked[what]] for what in RELEASED}
    apart = np.isin(ends, of_node[_nodes(said.loose)])
    for edge, side in said.welds:
        apart[edge, side] = True
    for what in RELEASED:
        for node in said.loosened[what]:
            here = ends == of_node[node]
            apart |= here
            partial[what] += combinations(own[here].tolist(), 2)
    ends = np.where(apart, own, ends)
    return Turning(ends, {what: _pairs(pairs) for what, pairs in partial.items()})


def _pairs(pairs: Iterable[tuple[int, int]]) -> IntArray:
    return np.array(list(pairs), dtype=np.int64).reshape(-1, 2)


def _nodes(nodes: Iterable[int]) -> IntArray:
    return np.array(list(nodes), dtype=np.int64)
