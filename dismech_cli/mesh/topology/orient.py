"""Consistent winding of triangles."""

from __future__ import annotations

import numpy as np

from ...arrays import BoolArray, IntArray
from ...errors import MeshError
from .components import components
from .sides import half_edges, shared_sides


def reversed_triangles(triangles: IntArray, where: str) -> BoolArray:
    """Tell which triangles to reverse so that neighbours wind the same way.

    Every triangle appears twice in a graph, as it is and reversed; two appearances are joined when
    they agree across a shared edge. A connected patch then falls into two sheets, of which the one
    that reverses fewer triangles is taken; a patch that stays in one piece is not orientable.

    Args:
        triangles: Shape (T, 3); sheets that meet three and more at an edge wind each for itself.
        where: Names the mesh in messages.

    Returns:
        True where a triangle has to be reversed, shape (T,).

    Raises:
        MeshError: If a patch is not orientable (a Moebius strip).
    """
    count = len(triangles)
    directed = half_edges(triangles)
    one, two = shared_sides(triangles)
    clash = (directed[one] == directed[two]).all(axis=1)
    if not clash.any():
        return np.zeros(count, dtype=np.bool_)

    f, g = one // 3, two // 3
    rows = np.concatenate([f, f + count])
    cols = np.concatenate([np.where(clash, g + count, g), np.where(clash, g, g + count)])
    _, label = components(2 * count, np.stack([rows, cols], axis=1))
    as_is, turned = label[:count], label[count:]
    if (as_is == turned).any():
        first = int(np.argmax(as_is == turned))
        raise MeshError(
            f"{where}: the surface around triangle {first + 1} has only one side (a Moebius strip); "
            "shells need an orientable surface"
        )
    kept = np.bincount(as_is, minlength=2 * count)
    # Equal counts: keep the sheet that holds the lowest-numbered triangle as it is.
    rank = np.full(2 * count, 2 * count, dtype=np.int64)
    np.minimum.at(rank, as_is, np.arange(count))
    fewer = kept[as_is] < kept[turned]
    tie = (kept[as_is] == kept[turned]) & (rank[as_is] > rank[turned])
    return np.asarray(fewer | tie, dtype=np.bool_)


def reverse(triangles: IntArray, which: BoolArray) -> IntArray:
    """Return a copy with the chosen triangles wound the other way, first node kept."""
    turned = triangles.copy()
    turned[which] = triangles[which][:, [0, 2, 1]]
    return turned
