"""Rods along given points."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ...errors import MeshError
from ..limits import MAX_COORDINATE
from ..mesh import Mesh
from .chain import chain
from .checks import check_nodes, check_positive


def polyline(
    points: ArrayLike,
    *,
    nodes: int | None = None,
    spacing: float | None = None,
    closed: bool = False,
    where: str = "polyline",
) -> Mesh:
    """Make a rod along given points.

    Args:
        points: Corners [m], shape (K, 3). A closed rod may repeat its first point at the end.
        nodes: Number of nodes, evenly spaced along the path (corners are cut); excludes ``spacing``.
        spacing: Approximate distance between evenly spaced nodes [m]; excludes ``nodes``. With
            neither, the points are the nodes.
        closed: Whether the last node is joined to the first.
        where: Where the points come from, for messages.

    Raises:
        MeshError: If there are too few points, two in a row coincide, or both ``nodes`` and
            ``spacing`` are given.
    """
    corners = np.asarray(points, dtype=np.float64)
    if corners.ndim != 2 or corners.shape[1] != 3 or not (np.abs(corners) <= MAX_COORDINATE).all():
        raise MeshError(f"{where}: points of shape {corners.shape}; expected finite rows of x, y, z")
    if closed and len(corners) > 1 and (corners[0] == corners[-1]).all():
        corners = corners[:-1]
    check_nodes(len(corners), 3 if closed else 2, where)
    if nodes is not None and spacing is not None:
        raise MeshError(f"{where}: both nodes and spacing are given; expected one of them")
    path = np.concatenate([corners, corners[:1]]) if closed else corners
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    if spacing is not None:
        nodes = _node_count(float(length[-1]), spacing, closed, where)
    if nodes is None:
        return chain(corners, closed, where)
    check_nodes(nodes, 3 if closed else 2, where)
    at = np.linspace(0.0, length[-1], nodes, endpoint=not closed)
    return chain(np.stack([np.interp(at, length, path[:, k]) for k in range(3)], axis=1), closed, where)


def _node_count(length: float, spacing: float, closed: bool, where: str) -> int:
    """Return the number of nodes whose spacing comes nearest to the one asked for."""
    check_positive(spacing, "spacing", where)
    cells = length / spacing
    if not cells < 1e15:
        raise MeshError(f"{where}: spacing {spacing:g} m over a length of {length:g} m")
    return max(round(cells), 3) if closed else max(round(cells), 1) + 1
