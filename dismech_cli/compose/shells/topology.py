"""Edges of the shells whose normals are free, numbered through all of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...arrays import IntArray
from ...mesh.topology.shells import ShellTopology, shell_edges
from ..bodies.geometry import Geometry
from .bending import bending_of


@dataclass(frozen=True, slots=True)
class ShellEdges:
    """Topology of every shell, and the edges that carry a mid-edge normal.

    Attributes:
        topologies: Edges and hinges of each shell by name, in the scene's node numbers.
        first: Number of the first free edge of each shell with free normals.
        edges: Edges with a free normal, shape (B, 2).
        edge_faces: Their triangles within ``triangles``, -1 where there is no second, shape (B, 2).
        triangles: Triangles of the shells with free normals, shape (F, 3).
    """

    topologies: Mapping[str, ShellTopology]
    first: Mapping[str, int]
    edges: IntArray
    edge_faces: IntArray
    triangles: IntArray


def find_shell_edges(geometry: Geometry) -> ShellEdges:
    """Find the edges of each shell; those of the shells with free normals are numbered on."""
    topologies: dict[str, ShellTopology] = {}
    first: dict[str, int] = {}
    edges, faces, triangles = ([np.empty((0, k), dtype=np.int64)] for k in (2, 2, 3))
    n_edges = n_faces = 0
    for shell in geometry.shells:
        own = geometry.triangles[geometry.triangles_of(shell.name)]
        topology = topologies[shell.name] = shell_edges(own)
        if not bending_of(shell).free_normals:
            continue
        first[shell.name] = n_edges
        edges.append(topology.edges)
        faces.append(np.where(topology.edge_faces >= 0, topology.edge_faces + n_faces, -1))
        triangles.append(own)
        n_edges, n_faces = n_edges + len(topology.edges), n_faces + len(own)
    return ShellEdges(
        topologies, first, np.concatenate(edges), np.concatenate(faces), np.concatenate(triangles)
    )
