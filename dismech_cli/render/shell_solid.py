"""The closed surface of a shell: two sides at half the thickness and a rim."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..mesh.measure import area_vectors
from ..mesh.topology.sides import rim_sides
from ..output.frame import Topology
from .tubes import unit


@frozen(kw_only=True)
class ShellSolid:
    """What does not move of the surface of one body.

    The vertices are the nodes on the upper side, the nodes on the lower side, and four for each rim edge
    (so that the rim keeps a sharp edge).

    Attributes:
        nodes: Indices of the nodes used, shape (M,).
        triangles: Into ``nodes``, shape (T, 3).
        rim: Boundary edges with the shell on their left, into ``nodes``, shape (B, 2).
        half_thickness: At each of ``nodes``, at least so that a thin rim stays visible [m], shape (M,).
        faces: See :class:`.parts.Part`, 2 T + 2 B triangles.
        source: See there, for 2 M + 4 B vertices.
        body: See there.
    """

    nodes: IntArray
    triangles: IntArray
    rim: IntArray
    half_thickness: FloatArray
    faces: IntArray
    source: IntArray
    body: IntArray
    color: ClassVar[None] = None
    meshed: ClassVar[bool] = True

    def place(self, t: float, positions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Vertices [m] and outward unit normals, shape (2 M + 4 B, 3) each."""
        middle = positions[self.nodes]
        normal = vertex_normals(middle, self.triangles)
        offset = normal * self.half_thickness[:, None]
        upper, lower = middle + offset, middle - offset
        a, b = self.rim.T
        outward = unit(np.cross(middle[b] - middle[a], normal[a] + normal[b]))
        vertices = np.concatenate([upper, lower, upper[a], upper[b], lower[b], lower[a]])
        return vertices, np.concatenate([normal, -normal, outward, outward, outward, outward])


def vertex_normals(points: FloatArray, triangles: IntArray) -> FloatArray:
    """Unit normals at the vertices, averaged by area; shape as ``points``."""
    area = area_vectors(points, triangles)
    corners = triangles.ravel()
    total = [np.bincount(corners, np.repeat(area[:, k], 3), len(points)) for k in range(3)]
    return unit(np.stack(total, axis=1))


def cells_to_nodes(values: FloatArray, cells: IntArray, nodes: int) -> FloatArray:
    """Average the values of the cells around each node.

    Args:
        values: One value per cell, shape (C,).
        cells: Node indices, shape (C, k).
        nodes: Number of nodes.

    Returns:
        One value per node, shape (nodes,); zero at nodes without a cell.
    """
    count = np.bincount(cells.ravel(), minlength=nodes)
    total = np.bincount(cells.ravel(), weights=np.repeat(values, cells.shape[1]), minlength=nodes)
    return np.asarray(total / np.maximum(count, 1))


def make_shells(topology: Topology, least: float) -> list[ShellSolid]:
    """The surface of every body that has triangles, at least ``least`` to each side [m]."""
    return [_make_shell(topology, int(body), least) for body in np.unique(topology.triangle_body)]


def _make_shell(topology: Topology, body: int, least: float) -> ShellSolid:
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
    source = np.concatenate([nodes, nodes, a, b, b, a])
    half = cells_to_nodes(topology.triangle_thickness[mine], triangles, count) / 2
    return ShellSolid(
        nodes=nodes,
        triangles=triangles,
        rim=rim,
        half_thickness=np.maximum(half, least),
        faces=faces,
        source=source,
        body=np.full(len(source), body),
    )
