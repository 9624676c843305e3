"""Sizes of edges and triangles, and the share of each node in them."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray


def edge_lengths(nodes: FloatArray, edges: IntArray) -> FloatArray:
    """Lengths [m], shape (E,), in space or in the plane."""
    lengths: FloatArray = np.linalg.norm(nodes[edges[:, 1]] - nodes[edges[:, 0]], axis=1)
    return lengths


def area_vectors(nodes: FloatArray, triangles: IntArray) -> FloatArray:
    """Area times unit normal of each triangle [m^2], shape (T, 3)."""
    x0, x1, x2 = (nodes[triangles[:, k]] for k in range(3))
    return np.asarray(0.5 * np.cross(x1 - x0, x2 - x0))


def triangle_areas(nodes: FloatArray, triangles: IntArray) -> FloatArray:
    """Areas [m^2], shape (T,)."""
    areas: FloatArray = np.linalg.norm(area_vectors(nodes, triangles), axis=1)
    return areas


def side_vectors(nodes: FloatArray, triangles: IntArray) -> FloatArray:
    """Sides opposite the corners, counter-clockwise [m], shape (3, T, 3)."""
    x = [nodes[triangles[:, k]] for k in range(3)]
    return np.stack([x[2] - x[1], x[0] - x[2], x[1] - x[0]])


def corner_angles(nodes: FloatArray, triangles: IntArray) -> FloatArray:
    """Angles of the corners [rad], shape (3, T)."""
    sides = side_vectors(nodes, triangles)
    # a corner lies between the sides opposite the other two, of which one runs towards it
    a, b = -np.roll(sides, -1, axis=0), np.roll(sides, -2, axis=0)
    angles: FloatArray = np.arctan2(np.linalg.norm(np.cross(a, b), axis=2), np.einsum("kti,kti->kt", a, b))
    return angles


def nodal_lengths(n_nodes: int, edges: IntArray, lengths: FloatArray) -> FloatArray:
    """Half of every adjacent edge [m], shape (n_nodes,): the Voronoi length of a node of a rod."""
    halves = np.repeat(0.5 * lengths, 2)
    return np.bincount(edges.reshape(-1), halves, minlength=n_nodes).astype(np.float64)


def nodal_areas(n_nodes: int, triangles: IntArray, areas: FloatArray) -> FloatArray:
    """A third of the area of every adjacent triangle [m^2], shape (n_nodes,)."""
    thirds = np.repeat(areas / 3.0, 3)
    return np.bincount(triangles.reshape(-1), thirds, minlength=n_nodes).astype(np.float64)


def adjacent_areas(edge_faces: IntArray, areas: FloatArray) -> FloatArray:
    """Sum of the areas of the one or two triangles at each edge [m^2], shape (B,).

    Args:
        edge_faces: Triangles at each edge, -1 where there is no second, shape (B, 2).
        areas: Shape (T,).
    """
    second = np.where(edge_faces[:, 1] >= 0, areas[edge_faces[:, 1]], 0.0)
    total: FloatArray = areas[edge_faces[:, 0]] + second
    return total
