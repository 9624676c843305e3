"""Rod edges and joints of the model, with the walls behind clamped rod ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import FloatArray, IntArray
from ...mesh.measure import edge_lengths
from ..bodies.geometry import Geometry
from .corners import sharp_joints
from .holds import Hold
from .joints import Edges, Joints, make_joints


@dataclass(frozen=True, slots=True)
class Skeleton:
    """Nodes and edges of the model: the geometry's first, then one of each per wall.

    Attributes:
        positions: Rest positions [m], shape (N + W, 3).
        edges: All edges, shape (E + W, 2).
        owners: Edge of the geometry that each wall continues, shape (W,).
        wall_nodes: Node of the geometry at each wall, shape (W,).
        rest_lengths: Edge lengths [m], shape (E + W,).
        joints: Where edges meet along one smooth line, or three and more at a node.
        corners: Where two edges alone meet at an angle that no curve has.
    """

    positions: FloatArray
    edges: IntArray
    owners: IntArray
    wall_nodes: IntArray
    rest_lengths: FloatArray
    joints: Joints
    corners: Joints

    @property
    def visible(self) -> int:
        """Nodes of the geometry; those of walls come after them."""
        return len(self.positions) - len(self.wall_nodes)


def make_skeleton(geometry: Geometry, holds: tuple[Hold, ...]) -> Skeleton:
    """Add a wall edge behind every rod end that is clamped at its node.

    The wall continues the rod by one edge that never moves relative to the clamp; the joint
    between them bends over the half edge on the free side only. So the clamp acts at the node,
    with second-order accuracy, where a clamp of two nodes acts half an edge inside.
    """
    n, e = len(geometry.nodes), len(geometry.edges)
    wall_nodes = np.unique(np.concatenate([np.empty(0, dtype=np.int64), *(h.walls for h in holds)]))
    touching = np.isin(geometry.edges, wall_nodes)
    owner_of = {
        int(geometry.edges[k, i]): (int(k), int(i)) for k, i in zip(*np.nonzero(touching), strict=True)
    }
    owners = np.array([owner_of[int(w)][0] for w in wall_nodes], dtype=np.int64)
    positions, edges = [geometry.nodes], [geometry.edges]
    for k, node in enumerate(wall_nodes):
        owner, side = owner_of[int(node)]
        other = geometry.nodes[geometry.edges[owner, 1 - side]]
        positions.append((2.0 * geometry.nodes[node] - other)[None])
        edges.append(np.array([[n + k, node] if side == 0 else [node, n + k]]))
    all_positions, all_edges = np.concatenate(positions), np.concatenate(edges)
    rest = edge_lengths(all_positions, all_edges)
    rigid = np.zeros(len(all_edges), dtype=bool)
    rigid[e:] = True
    for hold in holds:
        rigid[hold.rigid] = True
    edge_rod = np.concatenate((geometry.edge_rod, geometry.edge_rod[owners]))
    joints = make_joints(geometry, Edges(all_positions, all_edges, rest, rigid, edge_rod))
    sharp = sharp_joints(geometry, all_positions, joints)
    return Skeleton(
        all_positions,
        all_edges,
        owners,
        wall_nodes,
        rest,
        joints.some(~sharp),
        joints.some(sharp),
    )
