"""Rod edges joined to chains, so that a tube runs through its inner nodes without a seam."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen


@frozen(kw_only=True)
class Chain:
    """A path of edges of one body between ends and junctions.

    Attributes:
        nodes: Node indices in order, shape (L,); the first is repeated at the end of a closed chain.
        radius: Radius at each of them [m], shape (L,).
        body: Index of the body.
    """

    nodes: IntArray
    radius: FloatArray
    body: int

    @property
    def closed(self) -> bool:
        """Whether the chain is a loop."""
        return bool(self.nodes[0] == self.nodes[-1])


def find_chains(edges: IntArray, edge_radius: FloatArray, edge_body: IntArray) -> list[Chain]:
    """Join edges to the longest chains that neither branch nor change the body.

    Args:
        edges: Node indices, shape (E, 2).
        edge_radius: Radius of each edge [m], shape (E,).
        edge_body: Body of each edge, shape (E,).
    """
    around: dict[int, list[int]] = defaultdict(list)
    for edge, (a, b) in enumerate(edges.tolist()):
        around[a].append(edge)
        around[b].append(edge)
    ends = [
        node
        for node, touching in around.items()
        if len(touching) != 2 or edge_body[touching[0]] != edge_body[touching[1]]
    ]
    unused = set(range(len(edges)))
    chains = []
    # Open chains start at ends and junctions; what is left after them are loops.
    for node in [*ends, *around]:
        for edge in around[node]:
            if edge in unused:
                chains.append(_walk(node, edge, edges, around, set(ends), unused))
    return [_chain(nodes, path, edge_radius, edge_body) for nodes, path in chains]


def _walk(
    node: int,
    edge: int,
    edges: IntArray,
    around: dict[int, list[int]],
    ends: set[int],
    unused: set[int],
) -> tuple[list[int], list[int]]:
    nodes, path = [node], []
    while True:
        unused.discard(edge)
        path.append(edge)
        a, b = (int(end) for end in edges[edge])
        node = b if nodes[-1] == a else a
        nodes.append(node)
        onward = [other for other in around[node] if other in unused]
        if node in ends or not onward:
            return nodes, path
        edge = onward[0]


def _chain(nodes: list[int], path: list[int], edge_radius: FloatArray, edge_body: IntArray) -> Chain:
    radii = edge_radius[path]
    closed = nodes[0] == nodes[-1]
    before = radii[-1] if closed else radii[0]
    after = radii[0] if closed else radii[-1]
    radius = (np.concatenate([[before], radii]) + np.concatenate([radii, [after]])) / 2
    return Chain(nodes=np.array(nodes, dtype=np.int64), radius=radius, body=int(edge_body[path[0]]))


def find_chain_ends(chains: list[Chain], fewest: int) -> tuple[IntArray, FloatArray, IntArray]:
    """Nodes where open chains meet, or end alone.

    Args:
        chains: Of all rods.
        fewest: Ends of chains that a node must have.

    Returns:
        Node indices, largest radii [m] and the bodies of the thickest chains, each of shape (K,).
    """
    meeting: dict[int, list[tuple[float, int]]] = defaultdict(list)
    for chain in chains:
        if not chain.closed:
            for end in (0, -1):
                meeting[int(chain.nodes[end])].append((float(chain.radius[end]), chain.body))
    balls = [(node, *max(found)) for node, found in meeting.items() if len(found) >= fewest]
    return (
        np.array([ball[0] for ball in balls], dtype=np.int64),
        np.array([ball[1] for ball in balls], dtype=np.float64),
        np.array([ball[2] for ball in balls], dtype=np.int64),
    )
