"""Edges and hinges of shells. Pure functions of index arrays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...arrays import BoolArray, IntArray
from ...frozen import frozen
from .components import components
from .sides import half_edges, rim_sides, row_keys


@frozen(kw_only=True)
class ShellTopology:
    """Edges and hinges of a triangulated surface; B shell edges, H hinges.

    Attributes:
        edges: Directed shell edges in discovery order, shape (B, 2).
        face_edges: Shell edge opposite each corner of each triangle, shape (T, 3).
        face_signs: +1 where the triangle runs along its edge, -1 against it, shape (T, 3).
        hinges: Nodes (x0, x1, x2, x3), shape (H, 4): shared edge x0 -> x1 as the later triangle
            runs, x2 opposite it in the earlier triangle, x3 in the later one.
        hinge_edges: Shell edge of each hinge, shape (H,).
        hinge_faces: Earlier and later triangle of each hinge, shape (H, 2).
        edge_faces: Triangles at each shell edge, -1 where there is no second, shape (B, 2).
    """

    edges: IntArray
    face_edges: IntArray
    face_signs: IntArray
    hinges: IntArray
    hinge_edges: IntArray
    hinge_faces: IntArray
    edge_faces: IntArray


def directed(topology: ShellTopology, turned: BoolArray) -> ShellTopology:
    """The same surface with some of its edges running the other way; its hinges stay.

    Args:
        topology: The surface.
        turned: True for edges to turn, shape (B,).
    """
    return replace(
        topology,
        edges=np.where(turned[:, None], topology.edges[:, ::-1], topology.edges),
        face_signs=np.where(turned[topology.face_edges], -topology.face_signs, topology.face_signs),
    )


def rims(triangles: IntArray) -> int:
    """Number of closed lines of sides that have one triangle only."""
    nodes, ends = np.unique(rim_sides(triangles), return_inverse=True)
    return components(len(nodes), ends.reshape(-1, 2))[0]


def shell_edges(triangles: IntArray) -> ShellTopology:
    """Find the edges and hinges of a surface.

    Triangles are visited in order, and in each the edges opposite its corners 1, 2, 3. An edge
    keeps the direction in which it is first met; the second meeting makes a hinge.

    An edge of three and more triangles is one edge for each of them, with one triangle: what passes
    across it is not the surface's to say.

    Args:
        triangles: Shape (T, 3).
    """
    directed = half_edges(triangles)
    _, first, inverse, counts = np.unique(
        row_keys(directed), return_index=True, return_inverse=True, return_counts=True
    )
    key = inverse.ravel()
    crowded = counts[key] > 2
    if crowded.any():
        key = np.where(crowded, len(counts) + np.arange(len(key)), key)
        _, first, key = np.unique(key, return_index=True, return_inverse=True)
    # np.unique numbers edges by their nodes; discovery order numbers them by first appearance.
    discovery = np.empty(len(first), dtype=np.int64)
    discovery[np.argsort(first)] = np.arange(len(first))
    edge = discovery[key]
    found = np.sort(first)
    edges = directed[found]

    is_first = np.zeros(len(directed), dtype=np.bool_)
    is_first[found] = True
    second = np.flatnonzero(~is_first)
    corners = triangles.ravel()
    hinge_edges = edge[second]
    earlier = found[hinge_edges]
    edge_faces = np.full((len(edges), 2), -1, dtype=np.int64)
    edge_faces[:, 0] = found // 3
    edge_faces[hinge_edges, 1] = second // 3
    return ShellTopology(
        edges=edges,
        face_edges=edge.reshape(-1, 3),
        face_signs=np.where(directed[:, 0] == edges[edge, 0], 1, -1).reshape(-1, 3),
        # Half-edge 3 f + j is opposite corner j of triangle f, so both share a position.
        hinges=np.column_stack([directed[second], corners[earlier], corners[second]]),
        hinge_edges=hinge_edges,
        hinge_faces=np.stack([earlier // 3, second // 3], axis=1),
        edge_faces=edge_faces,
    )
