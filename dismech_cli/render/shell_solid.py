"""The closed surface of a shell: two sides at half the thickness and a rim."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray
from ..mesh.measure import area_vectors
from ..mesh.topology.sides import rim_sides
from ..output.frame import Topology
from .coloring import cells_to_nodes


@dataclass(frozen=True, slots=True, kw_only=True)
class ShellSolid:
    """What does not move of the surface of one body.

    The vertices are the nodes on the upper side, the nodes on the lower side, and four for each rim edge
    (so that the rim keeps a sharp edge).

    Attributes:
        nodes: Indices of the nodes used, shape (M,).
        triangles: Into ``nodes``, shape (T, 3).
        rim: Boundary edges with the shell on their left, into ``nodes``, shape (B, 2).
        half_thickness: At each of ``nodes`` [m], shape (M,).
        faces: Triangles of the closed surface, into its vertices, shape (2 T + 2 B, 3).
        source: Node index behind each vertex, shape (2 M + 4 B,).
        body: Index of the body.
    """

    nodes: IntArray
    triangles: IntArray
    rim: IntArray
    half_thickness: FloatArray
    faces: IntArray
    source: IntArray
    body: int

    def vertices(self, positions: FloatArray, least_half_thickness: float) -> tuple[FloatArray, FloatArray]:
        """Place the surface.

        Args:
            positions: Of all nodes [m], shape (N, 3).
            least_half_thickness: Drawn at least this thick [m], so that a thin rim stays visible.

        Returns:
            Vertices [m] and outward unit normals, shape (2 M + 4 B, 3) each.
        """
        middle = positions[self.nodes]
        normal = vertex_normals(middle, self.triangles)
        offset = normal * np.maximum(self.half_thickness, least_half_thickness)[:, None]
        upper, lower = middle + offset, middle - offset
        a, b = self.rim.T
        outward = np.cross(middle[b] - middle[a], normal[a] + normal[b])
        outward /= np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-300)
        vertices = np.concatenate([upper, lower, upper[a], upper[b], lower[b], lower[a]])
        return vertices, np.concatenate([normal, -normal, outward, outward, outward, outward])


def vertex_normals(points: FloatArray, triangles: IntArray) -> FloatArray:
    """Unit normals at the vertices, averaged by area; shape as ``points``."""
    area = area_vectors(points, triangles)
    total = np.zeros_like(points)
    for corner in range(3):
        np.add.at(total, triangles[:, corner], area)
    return np.asarray(total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-300))


def make_shells(topology: Topology) -> list[ShellSolid]:
    """Build the surface of every body that has triangles."""
    return [_make_shell(topology, int(body)) for body in np.unique(topology.triangle_body)]


def _make_shell(topology: Topology, body: int) -> ShellSolid:
    mine = topology.triangle_body == body
    nodes, local = np.unique(topology.triangles[mine], return_inverse=True)
    triangles = local.reshape(-1, 3)
    rim = rim_sides(triangles)
    count, edges = len(nodes), len(rim)
    quads = 2 * count + np.arange(4)[:, None] * edges + np.arange(edges)
    faces = np.concatenate(
        [triangles, triangles[:, ::-1] + count, quads[[0, 3, 2]].T, quads[[0, 2, 1]].T], dtype=np.int64
    )
    a, b = nodes[rim].T
    return ShellSolid(
        nodes=nodes,
        triangles=triangles,
        rim=rim,
        half_thickness=cells_to_nodes(topology.triangle_thickness[mine], triangles, count) / 2,
        faces=faces,
        source=np.concatenate([nodes, nodes, a, b, b, a]),
        body=body,
    )
