"""Hubs: joints at which three edges or more turn as one.

A spring between every two of them would be too stiff, by their number and because each lacks the half
edges beside it. So the hub has a frame of its own: a stub, one massless edge that the user never sees,
and every edge bends and twists against it over its own half, as it does against the wall of a clamp. Only
the direction and the roll of the stub count; a spring keeps its length.
"""

from __future__ import annotations

import numpy as np

from ...arrays import IntArray
from ...frozen import frozen
from ..bodies.geometry import Geometry
from .joints import Edges, Joints, number_joints

# Edges that turn as one, from which on they need a frame; two are a joint or a corner.
_MANY = 3


def hubs_of(geometry: Geometry) -> IntArray:
    """Numbers of the ends of edges that turn as one at each hub, ascending, shape (H,)."""
    numbers, counts = np.unique(geometry.turning.ends, return_counts=True)
    found: IntArray = numbers[counts >= _MANY]
    return found


def hub_nodes(geometry: Geometry, hubs: IntArray) -> IntArray:
    """The node of each hub, shape (H,)."""
    if not hubs.size:
        return hubs
    members = members_of(geometry, hubs)
    _, first = np.unique(members.hub, return_index=True)
    nodes: IntArray = geometry.edges[members.edge[first], members.side[first]]
    return nodes


@frozen
class Members:
    """Edges at hubs, by hub and edge.

    Attributes:
        hub: Place of the hub among all, shape (M,).
        edge: Shape (M,).
        side: Which of its ends is at the hub, shape (M,).
    """

    hub: IntArray
    edge: IntArray
    side: IntArray


def members_of(geometry: Geometry, hubs: IntArray) -> Members:
    """All edges at hubs.

    Args:
        geometry: The bodies.
        hubs: Numbers of the ends at each, shape (H,).
    """
    edge, side = np.nonzero(np.isin(geometry.turning.ends, hubs))
    hub = np.searchsorted(hubs, geometry.turning.ends[edge, side])
    order = np.argsort(hub, kind="stable")
    return Members(hub[order], edge[order], side[order])


def hub_joints(
    geometry: Geometry, edges: Edges, members: Members, stubs: IntArray, counts: IntArray
) -> Joints:
    """One joint between each edge at a hub and the stub of that hub.

    Args:
        geometry: The bodies.
        edges: All edges, walls and stubs included.
        members: Edges at hubs.
        stubs: The stub of each hub, shape (H,).
        counts: Joints of each rod, whatever their kind, shape (rods,).
    """
    stub = stubs[members.hub]
    node, far = edges.ends[members.edge, members.side], edges.ends[members.edge, 1 - members.side]
    outward = edges.ends[stub, 0] == node
    triples = np.stack((far, node, edges.ends[stub, outward.astype(np.int64)]), axis=1)
    half = 0.5 * edges.rest[members.edge]
    # a held edge keeps its place to the stub, which is held with it: any length will do
    rods = np.repeat(edges.rod[members.edge][:, None], 2, axis=1)
    return Joints(
        triples,
        np.stack((members.edge, stub), axis=1),
        np.stack((2.0 * members.side - 1.0, np.where(outward, 1.0, -1.0)), axis=1),
        np.stack((half, np.zeros_like(half)), axis=1),
        rods,
        number_joints(geometry, triples, rods),
        np.zeros((len(triples), 2), dtype=np.bool_),
        counts,
    )
