"""Edges of the shells, and those that carry a normal numbered through all of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...arrays import IntArray
from ...mesh.topology.shells import shell_edges
from ..bodies.geometry import Geometry
from .bending import bending_of
from .body import ShellBody


@dataclass(frozen=True, slots=True)
class ShellEdges:
    """The shells with their topology, and the edges that carry a mid-edge normal.

    Attributes:
        bodies: The shells by name.
        edges: Edges with a normal, shape (B, 2).
        edge_faces: Their triangles within ``triangles``, -1 where there is no second, shape (B, 2).
        triangles: Triangles of the shells whose edges have normals, shape (F, 3).
    """

    bodies: Mapping[str, ShellBody]
    edges: IntArray
    edge_faces: IntArray
    triangles: IntArray


def find_shell_edges(geometry: Geometry) -> ShellEdges:
    """Find the edges of each shell; those of the shells whose edges have normals are numbered on."""
    bodies: dict[str, ShellBody] = {}
    edges, faces, triangles = ([np.empty((0, k), dtype=np.int64)] for k in (2, 2, 3))
    n_edges = n_faces = 0
    for shell, sheet in zip(geometry.shells, geometry.sheets, strict=True):
        own = geometry.triangles[geometry.triangles_of(shell.name)]
        topology = shell_edges(own)
        bodies[shell.name] = ShellBody(shell, sheet, own, topology, n_edges)
        if not bending_of(shell).has_normals:
            continue
        edges.append(topology.edges)
        faces.append(np.where(topology.edge_faces >= 0, topology.edge_faces + n_faces, -1))
        triangles.append(own)
        n_edges, n_faces = n_edges + len(topology.edges), n_faces + len(own)
    return ShellEdges(bodies, np.concatenate(edges), np.concatenate(faces), np.concatenate(triangles))
