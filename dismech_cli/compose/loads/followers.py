"""Follower loads: the edges and triangles that they turn with, and the part of the load on each."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TypeAlias

import numpy as np

from ...arrays import FloatArray, IntArray
from ...forces.follower import Carrier, Faces, FollowerForce, FramedEdges, PlanarEdges
from ...kinematics.rod_frames import RodFrames
from ...mesh.measure import edge_lengths
from ...mesh.topology.sides import half_edges
from ..scene import Scene
from ..structure.structure import Structure
from .vectors import Vector, parts

Carried: TypeAlias = tuple[str, Carrier, FloatArray]
"""Label, parts of the body, and the weight of the load on each of their nodes, shape (K, m)."""


def follower_loads(
    scene: Scene, structure: Structure, vector: Vector, carried: Iterable[Carried]
) -> Iterator[FollowerForce]:
    """One load per component at rest that does not vanish, and kind of carrier.

    Args:
        scene: The scene.
        structure: What moves.
        vector: The load at rest.
        carried: What the load turns with.

    Raises:
        ScenarioError: A component leaves the plane of a planar scene.
    """
    carriers = tuple(carried)
    for axis, law in parts(scene, structure, vector):
        for label, carrier, shares in carriers:
            yield FollowerForce.of(
                f"{vector.name}.{'xyz'[axis]}.{label}", carrier, shares, np.eye(3)[axis], law
            )


def carried_at_nodes(scene: Scene, structure: Structure, nodes: IntArray) -> Iterator[Carried]:
    """The rod edges at each node, each with an equal part; without any the triangles, by their areas."""
    geometry = scene.geometry
    chosen = np.zeros(len(geometry.nodes), dtype=np.bool_)
    chosen[nodes] = True
    degree = np.bincount(geometry.edges.reshape(-1), minlength=len(chosen))
    by_edge = (chosen / np.maximum(degree, 1))[geometry.edges]
    if by_edge.any():
        yield _on_edges(scene, structure, by_edge)
    around = np.bincount(geometry.triangles.reshape(-1), np.repeat(geometry.areas, 3), len(chosen))
    alone = (chosen & (degree == 0))[geometry.triangles]
    if alone.any():
        yield _on_faces(scene, structure, alone * geometry.areas[:, None] / around[geometry.triangles])


def carried_by_edges(scene: Scene, structure: Structure, per_length: FloatArray) -> Carried:
    """The rod edges, half of their rest length, times a number per edge (E,), at either end."""
    half = 0.5 * scene.geometry.lengths * per_length
    return _on_edges(scene, structure, np.stack((half, half), axis=1))


def carried_by_sides(scene: Scene, structure: Structure, edges: IntArray) -> Carried:
    """The triangles at shell edges (B, 2), half of an edge's rest length at either end, by their areas.

    Args:
        scene: The scene.
        structure: What moves.
        edges: Nodes of each edge, ascending, in lexical order.
    """
    geometry = scene.geometry
    count = len(geometry.nodes)
    sides = np.sort(half_edges(geometry.triangles), axis=1)
    keys, wanted = sides @ (count, 1), edges @ (count, 1)
    chosen = np.flatnonzero(np.isin(keys, wanted))
    which = np.searchsorted(wanted, keys[chosen])
    areas = geometry.areas[chosen // 3]
    half = np.zeros(len(sides))
    half[chosen] = 0.5 * (edge_lengths(geometry.nodes, edges) / np.bincount(which, areas))[which] * areas
    by_side = half.reshape(-1, 3)
    # side k is opposite corner k: the other two end at it
    shares = np.roll(by_side, 1, axis=1) + np.roll(by_side, -1, axis=1)
    return _on_faces(scene, structure, shares)


def _on_edges(scene: Scene, structure: Structure, shares: FloatArray) -> Carried:
    geometry, dofs = scene.geometry, structure.dofs
    which = np.flatnonzero(shares.any(axis=1))
    if dofs.dimension == 2:
        return "edges", PlanarEdges.of(dofs, geometry.edges[which], geometry.nodes), shares[which]
    # the plan gives them to every rod that carries such a load
    frames = structure.rod_frames
    assert isinstance(frames, RodFrames)
    return "edges", FramedEdges.of(dofs, frames, which, structure.rest), shares[which]


def _on_faces(scene: Scene, structure: Structure, shares: FloatArray) -> Carried:
    geometry = scene.geometry
    which = np.flatnonzero(shares.any(axis=1))
    return "faces", Faces.of(structure.dofs, geometry.triangles[which], geometry.nodes), shares[which]
