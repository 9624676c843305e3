"""Edges of the shells, and those that carry a normal numbered through all of them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...arrays import IntArray
from ...frozen import frozen
from ...mesh.topology.shells import directed, shell_edges
from ..bodies.geometry import Geometry
from .bending import bending_of
from .body import ShellBody
from .seams import SeamHinges, seam_hinges, shared_normals, turned_edges, welded_edges


@frozen
class ShellEdges:
    """The shells with their topology, and the edges that carry a mid-edge normal.

    Attributes:
        bodies: The shells by name.
        edges: Edges with a normal, shape (B, 2).
        edge_faces: Their triangles within ``triangles``, -1 where there is no second, shape (B, 2).
        triangles: Triangles of the shells whose edges have normals, shape (F, 3).
        normals: Number of the normal of each edge, shape (B,): edges that are welded turn as one.
        seams: Hinges across welds of edges without normals.
    """

    bodies: Mapping[str, ShellBody]
    edges: IntArray
    edge_faces: IntArray
    triangles: IntArray
    normals: IntArray
    seams: SeamHinges

    @property
    def n_normals(self) -> int:
        """Number of normals that turn."""
        return int(self.normals.max(initial=-1)) + 1


def find_shell_edges(geometry: Geometry) -> ShellEdges:
    """Find the edges of each shell; those of the shells whose edges have normals are numbered on."""
    owned = [geometry.triangles[geometry.triangle_shell == k] for k in range(len(geometry.shells))]
    topologies = [shell_edges(own) for own in owned]
    welds = welded_edges(geometry, topologies)
    topologies = [
        directed(one, turned) for one, turned in zip(topologies, turned_edges(topologies, welds), strict=True)
    ]
    seams = seam_hinges(geometry, topologies, welds)
    bodies: dict[str, ShellBody] = {}
    edges, faces, triangles = ([np.empty((0, k), dtype=np.int64)] for k in (2, 2, 3))
    with_normals = [np.empty(0, dtype=np.int64)]
    n_edges = n_faces = 0
    for number, (shell, topology) in enumerate(zip(geometry.shells, topologies, strict=True)):
        own = owned[number]
        bodies[shell.name] = ShellBody(
            shell,
            geometry.sheets[number],
            own,
            topology,
            n_edges,
            seams.shares[number],
            seams.own_times[number],
        )
        if not bending_of(shell).has_normals:
            continue
        edges.append(topology.edges)
        faces.append(np.where(topology.edge_faces >= 0, topology.edge_faces + n_faces, -1))
        triangles.append(own)
        with_normals.append(welds[number])
        n_edges, n_faces = n_edges + len(topology.edges), n_faces + len(own)
    return ShellEdges(
        bodies,
        np.concatenate(edges),
        np.concatenate(faces),
        np.concatenate(triangles),
        shared_normals(np.concatenate(with_normals)),
        seams,
    )
