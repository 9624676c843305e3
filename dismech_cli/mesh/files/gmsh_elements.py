"""Elements of a gmsh file, of either version: their types, and the nodes that they name."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ...arrays import BoolArray, IntArray
from ...errors import MeshError
from ..limits import MAX_COUNT
from .gmsh_section import Section

MAX_TAG = 8 * MAX_COUNT
"""Largest node number: meshio keeps a table from number to index."""

_SOLIDS = {
    **dict.fromkeys((4, 11, 29, 30, 31), "tetrahedron"),
    **dict.fromkeys((5, 12, 17, 92, 93), "hexahedron"),
    **dict.fromkeys((6, 13, 18), "prism"),
    **dict.fromkeys((7, 14, 19), "pyramid"),
}
_WIDTHS = {15: 1, 1: 2, 2: 3, 3: 4}


def element_width(kind: int, section: Section, at: int) -> int:
    """Return the number of nodes of an element."""
    if kind in _SOLIDS:
        raise section.error(
            f"a solid element (gmsh type {kind}, {_SOLIDS[kind]}); rods and shells need lines and triangles: "
            "save the surface alone, as physical groups of surfaces do (Mesh.SaveAll = 0)",
            at,
        )
    if kind not in _WIDTHS:
        raise section.error(
            f"gmsh element type {kind}; expected points, lines, triangles or quads, "
            "of first order (Mesh.ElementOrder = 1)",
            at,
        )
    return _WIDTHS[kind]


def element_nodes(
    section: Section, rows: int, skip: int, width: int, kind: Literal["int", "size"]
) -> IntArray:
    """Return the node numbers of elements and their positions, shape (2, rows * width)."""
    start, stride = section.position, skip + width
    numbers = section.take(rows * stride, kind)
    places = np.arange(start, start + len(numbers))
    return np.stack([v.reshape(rows, stride)[:, skip:].ravel() for v in (numbers, places)])


def known_nodes(tags: NDArray[Any], where: str) -> BoolArray:
    """Return a table that is true at node numbers, and never at 0."""
    fine = (tags >= 1) & (tags <= MAX_TAG) & (tags == np.floor(tags))
    if not fine.all():
        raise MeshError(f"{where}: node number {tags[~fine][0]}; expected a whole number, 1 to {MAX_TAG}")
    counts = np.bincount(tags.astype(np.int64), minlength=1)
    if counts.max() > 1:
        raise MeshError(f"{where}: node number {np.argmax(counts > 1)} is defined twice")
    return np.asarray(counts > 0)


def check_known(section: Section, nodes: list[IntArray], known: BoolArray) -> None:
    """Refuse elements that name a node which the file does not define.

    Raises:
        MeshError: At the number.
    """
    numbers, places = np.concatenate([np.empty((2, 0), dtype=np.int64), *nodes], axis=1)
    fine = known[np.clip(numbers, 0, len(known) - 1)] & (numbers < len(known))
    if not fine.all():
        bad = int(np.argmin(fine))
        message = f"element names node {numbers[bad]}, which the file does not define"
        raise section.error(message, int(places[bad]))
