"""Triangles so slender that their stiffness is lost in rounding."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..errors import MeshError
from .measure import triangle_areas

# The determinant of a rest metric, of size (L h)^2, is a difference of products of size L^4: an error of
# eps (L / h)^2 of the stiffness, one per cent here.
_LENGTH_PER_HEIGHT = 1e7


def refuse_slivers(nodes: FloatArray, triangles: IntArray) -> None:
    """Refuse triangles of which no stiffness can be computed.

    Args:
        nodes: Positions, shape (N, 3).
        triangles: Shape (T, 3).

    Raises:
        MeshError: naming the worst.
    """
    if not len(triangles):
        return
    x = nodes[triangles]
    longest = np.linalg.norm(x - np.roll(x, 1, axis=1), axis=2).max(axis=1)
    with np.errstate(divide="ignore", over="ignore"):
        ratio = longest**2 / (2.0 * triangle_areas(nodes, triangles))
    worst = int(np.argmax(ratio))
    if not ratio[worst] < _LENGTH_PER_HEIGHT:
        raise MeshError(
            f"triangle {worst + 1} is {ratio[worst]:.2g} times as long as it is high: from "
            f"{_LENGTH_PER_HEIGHT:.0e} on its stiffness is lost in rounding; divide the mesh otherwise"
        )
