"""Rod edges and joints of the model, with the walls behind clamped rod ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ...mesh.measure import edge_lengths
from ...mesh.topology.rods import chains, rod_stencils
from ..bodies.geometry import Geometry
from .holds import Hold


@dataclass(frozen=True, slots=True)
class Joints:
    """Bend-twist stencils of all rods, walls of clamps included.

    Attributes:
        triples: Nodes, shape (J, 3).
        pairs: Edges, shape (J, 2).
        signs: Walking directions, shape (J, 2).
        voronoi: Length over which each joint bends [m], shape (J,).
        rod: Rod of each joint, -1 between rods, shape (J,).
        number: Number of the joint along its rod, shape (J,); a wall has that of its neighbour.
    """

    triples: IntArray
    pairs: IntArray
    signs: FloatArray
    voronoi: FloatArray
    rod: IntArray
    number: IntArray


@dataclass(frozen=True, slots=True)
class Skeleton:
    """Nodes and edges of the model: the geometry's first, then one of each per wall.

    Attributes:
        positions: Rest positions [m], shape (N + W, 3).
        edges: All edges, shape (E + W, 2).
        owners: Edge of the geometry that each wall continues, shape (W,).
        wall_nodes: Node of the geometry at each wall, shape (W,).
        rest_lengths: Edge lengths [m], shape (E + W,).
        joints: Bend-twist stencils.
    """

    positions: FloatArray
    edges: IntArray
    owners: IntArray
    wall_nodes: IntArray
    rest_lengths: FloatArray
    joints: Joints

    @property
    def visible(self) -> int:
        """Nodes of the geometry; those of walls come after them."""
        return len(self.positions) - len(self.wall_nodes)


@dataclass(frozen=True, slots=True)
class _Edges:
    """All edges, walls included.

    Attributes:
        n_nodes: Nodes, those of walls included.
        ends: Their nodes, shape (E + W, 2).
        rest: Their lengths [m], shape (E + W,).
        rigid: Whether they bend nothing, shape (E + W,).
        rod: Their rods, shape (E + W,).
    """

    n_nodes: int
    ends: IntArray
    rest: FloatArray
    rigid: BoolArray
    rod: IntArray


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
    return Skeleton(
        all_positions,
        all_edges,
        owners,
        wall_nodes,
        rest,
        _joints(geometry, _Edges(len(all_positions), all_edges, rest, rigid, edge_rod)),
    )


def _joints(geometry: Geometry, edges: _Edges) -> Joints:
    triples, pairs, signs = rod_stencils(edges.n_nodes, edges.ends)
    rods = edges.rod[pairs]
    kept = _passing(geometry, triples, rods)
    triples, pairs, signs, rods = triples[kept], pairs[kept], signs[kept], rods[kept]
    half = np.where(edges.rigid, 0.0, 0.5 * edges.rest)
    voronoi = half[pairs].sum(axis=1)
    # between two held edges nothing can bend; any length will do
    voronoi = np.where(voronoi > 0.0, voronoi, 0.5 * edges.rest[pairs].sum(axis=1))
    rod = np.where(rods[:, 0] == rods[:, 1], rods[:, 0], -1)
    return Joints(triples, pairs, signs.astype(np.float64), voronoi, rod, _numbers(geometry, triples, rod))


def _passing(geometry: Geometry, triples: IntArray, rods: IntArray) -> BoolArray:
    """Mask of the joints through which bending and twist pass: hinges left out, shape (J,).

    Args:
        geometry: The rods.
        triples: Nodes of the joints, shape (J, 3).
        rods: Rods of their two edges, shape (J, 2).
    """
    centre = triples[:, 1]
    released = np.isin(centre, geometry.hinges)
    same = rods[:, 0] == rods[:, 1]
    released |= np.isin(centre, geometry.rod_hinges) & ~same
    node, rod = geometry.parted.T
    released |= np.isin(centre * len(geometry.rods) + rods[:, 0], node * len(geometry.rods) + rod) & same
    kept: BoolArray = ~released
    return kept


def _numbers(geometry: Geometry, triples: IntArray, rod: IntArray) -> IntArray:
    """Number each joint along its rod from the start of the rod."""
    number = np.zeros(len(triples), dtype=np.int64)
    for index, one in enumerate(geometry.rods):
        members = np.flatnonzero(rod == index)
        place = np.full(len(geometry.nodes), -1)
        count = 0
        for chain in chains(len(geometry.nodes), geometry.edges[geometry.rod_edges[one.name]]):
            inner = chain.nodes[1:-1] if chain.kind.value == "open" else chain.nodes
            place[inner] = count + np.arange(len(inner))
            if chain.kind.value == "open":
                # the joints at walls count as their inner neighbours
                place[chain.nodes[0]] = count
                place[chain.nodes[-1]] = count + max(len(inner) - 1, 0)
            count += len(inner)
        number[members] = place[triples[members, 1]]
    return number
