"""Rod edges and joints of the model, with the walls behind clamped rod ends."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray, distinct
from ...frozen import frozen
from ...mesh.measure import edge_lengths
from ..bodies.geometry import Geometry
from .corners import sharp_joints
from .holds import Hold
from .hubs import Members, hub_joints, hubs_of, members_of
from .joints import Edges, Joints, make_joints, turning_at

# Length of a stub in that of the edge it continues; nothing depends on it but round-off.
_STUB = 1.0


@frozen
class Skeleton:
    """Nodes and edges of the model: the geometry's first, then one of each per wall and per stub.

    Attributes:
        positions: Rest positions [m], shape (N + W + H, 3).
        edges: All edges, shape (E + W + H, 2).
        owners: Edge of the geometry that each wall and each stub continues, shape (W + H,).
        wall_nodes: Node of the geometry at each wall and at each stub, shape (W + H,).
        hubs: Numbers of the ends of edges that turn as one with each stub, shape (H,).
        rest_lengths: Edge lengths [m], shape (E + W + H,).
        joints: Where edges meet along one smooth line, or let bending or twist alone pass.
        corners: Where two edges alone meet at an angle that no curve has, and edges with stubs.
    """

    positions: FloatArray
    edges: IntArray
    owners: IntArray
    wall_nodes: IntArray
    hubs: IntArray
    rest_lengths: FloatArray
    joints: Joints
    corners: Joints

    @property
    def visible(self) -> int:
        """Nodes of the geometry; those of walls and stubs come after them."""
        return len(self.positions) - len(self.wall_nodes)

    @property
    def stubs(self) -> IntArray:
        """Edges that are the frames of hubs, shape (H,)."""
        return len(self.edges) - len(self.hubs) + np.arange(len(self.hubs))

    def behind(self, hold: Hold) -> IntArray:
        """The walls and stubs that a motion holds with its nodes, counted among both."""
        walls = len(self.owners) - len(self.hubs)
        held = np.isin(self.wall_nodes, hold.walls)
        held[walls:] = np.isin(self.hubs, hold.hubs)
        return np.flatnonzero(held)


def make_skeleton(geometry: Geometry, holds: tuple[Hold, ...]) -> Skeleton:
    """Add a wall edge behind every rod end that is clamped at its node, and a stub to every hub.

    The wall continues the rod by one edge that never moves relative to the clamp; the joint
    between them bends over the half edge on the free side only. So the clamp acts at the node,
    with second-order accuracy, where a clamp of two nodes acts half an edge inside. A stub does
    the same for all edges at a hub, and moves with them.
    """
    n, e = len(geometry.nodes), len(geometry.edges)
    rigid = np.zeros(e, dtype=bool)
    for hold in holds:
        rigid[hold.rigid] = True
    hubs = hubs_of(geometry)
    members = members_of(geometry, hubs)
    walls = distinct(np.concatenate([np.empty(0, dtype=np.int64), *(h.walls for h in holds)]))
    edge, side = _ends_at(geometry, walls)
    first, first_side = _first_of(members)
    owners, sides = np.concatenate((edge, first)), np.concatenate((side, first_side))
    long = np.concatenate((np.ones(len(edge)), np.full(len(first), _STUB)))[:, None]
    nodes, others = geometry.edges[owners, sides], geometry.edges[owners, 1 - sides]
    ghosts = n + np.arange(len(owners))
    added = np.where((sides == 0)[:, None], np.stack((ghosts, nodes), 1), np.stack((nodes, ghosts), 1))
    beyond = (1.0 + long) * geometry.nodes[nodes] - long * geometry.nodes[others]
    positions = np.concatenate((geometry.nodes, beyond))
    all_edges = np.concatenate((geometry.edges, added))
    # the ends of walls and stubs at nodes of their own meet nothing
    own = geometry.turning.ends.max(initial=0) + 1 + ghosts
    turning = np.where(added >= n, own[:, None], geometry.turning.ends[owners, sides][:, None])
    edges = Edges(
        positions,
        all_edges,
        edge_lengths(positions, all_edges),
        np.concatenate((rigid, np.ones(len(added), dtype=bool))),
        np.concatenate((geometry.edge_rod, geometry.edge_rod[owners])),
        np.concatenate((geometry.turning.ends, turning)),
    )
    joints = make_joints(geometry, edges)
    sharp = sharp_joints(positions, joints)
    at_hub = np.isin(turning_at(edges.turning, joints.pairs, joints.signs.astype(np.int64)), hubs)
    among = at_hub.all(axis=0)
    corners = joints.some(sharp & ~among)
    stubs = len(all_edges) - len(hubs) + np.arange(len(hubs))
    if len(hubs):
        corners = corners.followed_by(hub_joints(geometry, edges, members, stubs, joints.counts))
    return Skeleton(
        positions,
        all_edges,
        owners,
        nodes,
        hubs,
        edges.rest,
        joints.some(~sharp & ~among),
        corners,
    )


def _ends_at(geometry: Geometry, nodes: IntArray) -> tuple[IntArray, IntArray]:
    """The edge that ends at each node, and which of its ends does, each shape (W,)."""
    edge, side = np.nonzero(np.isin(geometry.edges, nodes))
    order = np.argsort(geometry.edges[edge, side], kind="stable")
    return edge[order], side[order]


def _first_of(members: Members) -> tuple[IntArray, IntArray]:
    """The edge that each stub continues, and its end at the hub, each shape (H,)."""
    _, first = np.unique(members.hub, return_index=True)
    return members.edge[first], members.side[first]
