"""Bend-twist stencils of rods, and the chains that rods form. Pure functions of index arrays."""

from __future__ import annotations

from enum import Enum

import numpy as np

from ...arrays import IntArray, distinct
from ...errors import MeshError
from ...frozen import frozen
from .components import components

MAX_STENCILS = 20_000_000
"""Largest number of stencils: a node with m edges alone has m (m - 1) / 2 of them."""


def rod_stencils(n_nodes: int, edges: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Pair up the edges that meet at each node: the stencils of rod bending and twisting.

    For each node in ascending order come first the pairs of edges that point into it, then the
    pairs that point out of it, then the pairs of one edge into and one out of it (the outer loop
    runs over the latter). Edges run in ascending order within each. A sign of -1 says that the
    stencil traverses the edge backwards, so that it always runs x0 -> x1 -> x2.

    Args:
        n_nodes: Number of nodes N.
        edges: Directed edges (tail, head), shape (E, 2).

    Returns:
        Nodes (x0, centre x1, x2), shape (J, 3); edges, shape (J, 2); signs +1 or -1, shape (J, 2).

    Raises:
        MeshError: If nodes with very many edges would give more than 20 million stencils.
    """
    incoming, n_in = _by_node(edges[:, 1], n_nodes)
    outgoing, n_out = _by_node(edges[:, 0], n_nodes)
    total = int(np.sum((n_in + n_out) * (n_in + n_out - 1) // 2))
    if total > MAX_STENCILS:
        raise MeshError(
            f"{total} pairs of rod edges meet at nodes; expected at most {MAX_STENCILS}: "
            "is one node joined to thousands of edges?"
        )
    first_in, second_in = _pairs(n_in)
    first_out, second_out = _pairs(n_out)
    through_in, through_out = _products(n_in, n_out)
    cases = (
        (incoming[first_in], incoming[second_in], 0, 0, (1, -1)),
        (outgoing[first_out], outgoing[second_out], 1, 1, (-1, 1)),
        (incoming[through_in], outgoing[through_out], 0, 1, (1, 1)),
    )
    nodes, pairs, signs = [], [], []
    for a, b, far_a, far_b, sign in cases:
        nodes.append(np.stack([edges[a, far_a], edges[a, 1 - far_a], edges[b, far_b]], axis=1))
        pairs.append(np.stack([a, b], axis=1))
        signs.append(np.broadcast_to(np.array(sign, dtype=np.int64), (len(a), 2)))
    stencil_nodes = np.concatenate(nodes)
    order = np.argsort(stencil_nodes[:, 1], kind="stable")
    return stencil_nodes[order], np.concatenate(pairs)[order], np.concatenate(signs)[order]


def _by_node(ends: IntArray, n_nodes: int) -> tuple[IntArray, IntArray]:
    """Sort edges by the node at one end: edge numbers, shape (E,), and counts per node, shape (N,)."""
    return np.argsort(ends, kind="stable"), np.bincount(ends, minlength=n_nodes)


def _runs(lengths: IntArray) -> tuple[IntArray, IntArray]:
    """Unroll loops: for lengths (2, 3) return the loop of each step 0 0 1 1 1 and its count 0 1 0 1 2."""
    loop = np.repeat(np.arange(len(lengths)), lengths)
    return loop, np.arange(len(loop)) - (np.cumsum(lengths) - lengths)[loop]


def _pairs(counts: IntArray) -> tuple[IntArray, IntArray]:
    """Positions (p, q), p < q, of all pairs within consecutive groups, in lexicographic order."""
    stop = np.repeat(np.cumsum(counts), counts)
    first, step = _runs(stop - np.arange(len(stop)) - 1)
    return first, first + 1 + step


def _products(inner: IntArray, outer: IntArray) -> tuple[IntArray, IntArray]:
    """Positions of all (inner, outer) members of corresponding groups, the inner one running fastest."""
    group = np.repeat(np.arange(len(outer)), outer)
    position, step = _runs(inner[group])
    return (np.cumsum(inner) - inner)[group[position]] + step, position


class ChainKind(Enum):
    """How the edges of a connected piece hang together."""

    OPEN = "open"
    CLOSED = "closed"
    NETWORK = "network"


@frozen(kw_only=True)
class Chain:
    """One connected piece of rod.

    Attributes:
        kind: Open chain, closed ring, or network (some node has three edges or more).
        nodes: Nodes in order along the chain (a ring does not repeat its first node); ascending
            in a network.
        edges: Edges in the same order; ascending in a network.
    """

    kind: ChainKind
    nodes: IntArray
    edges: IntArray


def chains(n_nodes: int, edges: IntArray) -> tuple[Chain, ...]:
    """Split the rod edges into connected pieces and order each along its length.

    An open chain runs in the direction of its edges where its end edges agree, else from its
    lower-numbered end; a ring starts at its lowest node along an outgoing edge. Nodes without
    edges belong to no chain.

    Args:
        n_nodes: Number of nodes N.
        edges: Shape (E, 2).

    Returns:
        The pieces, by their lowest node.
    """
    if not len(edges):
        return ()
    _, label = components(n_nodes, edges)
    degree = np.bincount(edges.ravel(), minlength=n_nodes)
    piece = label[edges[:, 0]]
    by_piece = np.argsort(piece, kind="stable")
    found: list[Chain] = []
    meetings: _Meetings | None = None
    for members in np.split(by_piece, np.flatnonzero(np.diff(piece[by_piece])) + 1):
        own = edges[members]
        if degree[own].max() > 2:
            found.append(Chain(kind=ChainKind.NETWORK, nodes=distinct(own), edges=members))
        elif (own[1:, 0] == own[:-1, 1]).all():
            found.append(_listed_in_order(own, members))
        else:
            meetings = meetings or _Meetings.of(edges, degree)
            found.append(_walked(own, degree, meetings))
    return tuple(sorted(found, key=lambda chain: int(chain.nodes.min())))


def _listed_in_order(own: IntArray, members: IntArray) -> Chain:
    """The chain of edges each of which begins where the last one ends."""
    if own[0, 0] != own[-1, 1]:
        return Chain(kind=ChainKind.OPEN, nodes=np.append(own[:, 0], own[-1, 1]), edges=members)
    lowest = -int(own[:, 0].argmin())
    return Chain(kind=ChainKind.CLOSED, nodes=np.roll(own[:, 0], lowest), edges=np.roll(members, lowest))


@frozen
class _Meetings:
    """Which edges meet at each node: at node i ``incident[start[i]:start[i + 1]]``.

    Lists, which a walk reads faster one by one.
    """

    edges: list[list[int]]
    incident: list[int]
    start: list[int]

    @classmethod
    def of(cls, edges: IntArray, degree: IntArray) -> _Meetings:
        """Sort both ends of each edge by node."""
        incident = np.argsort(edges.ravel(), kind="stable") // 2
        return cls(edges.tolist(), incident.tolist(), [0, *np.cumsum(degree).tolist()])

    def at(self, node: int) -> list[int]:
        """The edges at a node."""
        return self.incident[self.start[node] : self.start[node + 1]]


def _walked(own: IntArray, degree: IntArray, meetings: _Meetings) -> Chain:
    """A chain of edges that are listed in any order and direction."""
    nodes = distinct(own)
    ends = nodes[degree[nodes] == 1]
    walk_nodes, walk_edges = _walk(meetings, *_first(meetings, (ends if len(ends) else nodes[:1]).tolist()))
    if len(ends):
        return Chain(kind=ChainKind.OPEN, nodes=walk_nodes, edges=walk_edges)
    return Chain(kind=ChainKind.CLOSED, nodes=walk_nodes[:-1], edges=walk_edges)


def _first(meetings: _Meetings, candidates: list[int]) -> tuple[int, int]:
    """Return the node and the edge to start walking from."""
    for node in candidates:
        for edge in meetings.at(node):
            if meetings.edges[edge][0] == node:
                return node, edge
    return candidates[0], meetings.at(candidates[0])[0]


def _walk(meetings: _Meetings, node: int, edge: int) -> tuple[IntArray, IntArray]:
    """Follow a chain from a node and an edge to its end or back to the start."""
    nodes, path = [node], [edge]
    while True:
        tail, head = meetings.edges[edge]
        node = head if node == tail else tail
        nodes.append(node)
        onward = [e for e in meetings.at(node) if e != edge]
        if not onward or onward[0] == path[0]:
            return np.array(nodes, dtype=np.int64), np.array(path, dtype=np.int64)
        edge = onward[0]
        path.append(edge)
