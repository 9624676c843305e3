"""Closed surfaces, and the side to which their normals point."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray
from .components import components
from .sides import half_edges, rim_sides


def inward_surfaces(nodes: FloatArray, triangles: IntArray) -> int:
    """Number of closed surfaces whose normals point inward: those that enclose a negative volume.

    Args:
        nodes: Positions [m], shape (N, 3).
        triangles: Consistently wound, shape (T, 3).
    """
    count, label = components(len(nodes), half_edges(triangles))
    is_open = np.zeros(count, dtype=np.bool_)
    is_open[label[rim_sides(triangles).ravel()]] = True
    corners = nodes[triangles] - nodes.mean(axis=0)
    volumes = np.einsum("ti,ti->t", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
    enclosed = np.bincount(label[triangles[:, 0]], volumes, minlength=count)
    return int(((enclosed < 0.0) & ~is_open).sum())
