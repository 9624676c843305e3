"""Whole spheres: an icosahedron whose faces are divided and put on the sphere."""

from __future__ import annotations

from typing import Final

import numpy as np

from ...arrays import FloatArray, IntArray
from ..mesh import Mesh
from ..validate import validate
from .checks import check_divisions, check_positive, check_triangles

# Corners: north pole, five at the northern parallel, five at the southern one half an angle on, south pole.
_RING: Final = 1 + np.arange(5)
_NEXT: Final = 1 + (np.arange(5) + 1) % 5
_FACES: Final[IntArray] = np.concatenate(
    [
        np.stack([np.zeros(5, dtype=np.int64), _RING, _NEXT], axis=1),
        np.stack([_RING, 5 + _RING, _NEXT], axis=1),
        np.stack([_NEXT, 5 + _RING, 5 + _NEXT], axis=1),
        np.stack([np.full(5, 11), 5 + _NEXT, 5 + _RING], axis=1),
    ]
)


def icosphere(radius: float, divisions: int) -> Mesh:
    """Make a closed sphere around the origin, normals outward.

    There are 10 n^2 + 2 nodes and 20 n^2 triangles of nearly one size. Six meet at each node, five at the
    corners of the icosahedron, of which two are the poles.

    Args:
        radius: Radius of the sphere [m].
        divisions: Number n of edges along a side of the icosahedron.

    Returns:
        Mesh with node groups ``top`` and ``bottom``, the poles at +z and -z.

    Raises:
        MeshError: If the radius is not positive, or triangles are none or too many.
    """
    check_positive(radius, "radius", "icosphere")
    check_divisions(divisions, "icosphere")
    check_triangles(20.0 * divisions * divisions, "icosphere")
    shares = _shares(divisions)
    # A node is known by its whole shares in the corners, whichever face it is looked at from.
    known = np.zeros((len(_FACES), len(shares), 12), dtype=np.int64)
    np.put_along_axis(
        known, np.broadcast_to(_FACES[:, None], (len(_FACES), *shares.shape)), shares[None], axis=2
    )
    keys, node = np.unique(known.reshape(-1, 12), axis=0, return_inverse=True)
    nodes = keys @ _corners()
    nodes *= radius / np.linalg.norm(nodes, axis=1)[:, None]
    triangles = node.reshape(len(_FACES), -1)[:, _rows(divisions)].reshape(-1, 3)
    groups = {
        name: np.flatnonzero(keys[:, corner] == divisions) for name, corner in (("top", 0), ("bottom", 11))
    }
    return validate(Mesh(nodes=nodes, triangles=triangles, node_groups=groups), "icosphere")


def _corners() -> FloatArray:
    """Corners of the icosahedron on the unit sphere, one at angle 0, shape (12, 3)."""
    height, width = 1.0 / np.sqrt(5.0), 2.0 / np.sqrt(5.0)
    angle = 0.4 * np.pi * np.arange(5)
    north = np.column_stack([width * np.cos(angle), width * np.sin(angle), np.full(5, height)])
    late = angle + 0.2 * np.pi
    south = np.column_stack([width * np.cos(late), width * np.sin(late), np.full(5, -height)])
    return np.concatenate([[[0.0, 0.0, 1.0]], north, south, [[0.0, 0.0, -1.0]]])


def _shares(n: int) -> IntArray:
    """Whole shares of the nodes of a face in its corners, row by row from the first, shape (K, 3)."""
    row = np.repeat(np.arange(n + 1), np.arange(n + 1) + 1)
    along = np.arange(len(row)) - row * (row + 1) // 2
    return np.stack([n - row, row - along, along], axis=1)


def _rows(n: int) -> IntArray:
    """Triangles of a divided face as numbers of its nodes, wound as the face is, shape (n^2, 3)."""
    row = np.repeat(np.arange(n), np.arange(n) + 1)
    first = np.arange(len(row))
    below = first + row + 1
    upright = np.stack([first, below, below + 1], axis=1)
    inside = np.flatnonzero(first - row * (row + 1) // 2 < row)
    return np.concatenate([upright, np.stack([first, below + 1, first + 1], axis=1)[inside]])
