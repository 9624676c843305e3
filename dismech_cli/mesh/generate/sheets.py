"""Shells from formulas: flat rectangles."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum

import numpy as np

from ...arrays import FloatArray, IntArray
from ...errors import MeshError
from ..mesh import Mesh
from ..validate import validate
from .checks import check_divisions, check_positive, check_triangles
from .unstructured import smallest_angle, unstructured_sheet

MAX_ROWS = 100_000
"""Most rows of triangles of a sheet, as its divisions."""


class Pattern(Enum):
    """How a sheet is divided into triangles."""

    EQUILATERAL = "equilateral"
    RIGHT = "right"
    ALTERNATING = "alternating"
    UNSTRUCTURED = "unstructured"


def sheet(length: float, width: float, divisions: int, pattern: Pattern = Pattern.EQUILATERAL) -> Mesh:
    """Make a flat rectangle 0 <= x <= length, 0 <= y <= width at z = 0, normals along +z.

    ``equilateral`` has rows of (nearly) equilateral triangles along x and 30 degree triangles that
    fill its short sides; ``right`` has all diagonals the same way, ``alternating`` every other one;
    ``unstructured`` has no preferred direction (fixed random seed).

    Args:
        length: Size along x [m].
        width: Size along y [m].
        divisions: Number of edges along the length; the width follows.
        pattern: How the triangles are laid.

    Returns:
        Mesh with node groups ``left``, ``right``, ``bottom``, ``top`` and ``rim`` (all four sides).

    Raises:
        MeshError: If sizes are not positive or there would be too many nodes.
    """
    check_positive(length, "length", "sheet")
    check_positive(width, "width", "sheet")
    check_divisions(divisions, "sheet")
    cells = max(width / length * divisions, 1.0)
    check_triangles(2.0 * divisions * cells, "sheet")
    if cells > MAX_ROWS:
        raise MeshError(
            f"sheet: {cells:.3g} rows of triangles; expected at most {MAX_ROWS}: make it shorter or coarser"
        )
    nodes, triangles = _SHEETS[pattern](length, width, divisions)
    x, y = nodes[:, 0], nodes[:, 1]
    sides = {"left": x == 0.0, "right": x == length, "bottom": y == 0.0, "top": y == width}
    sides["rim"] = np.logical_or.reduce(list(sides.values()))
    groups = {name: np.flatnonzero(side) for name, side in sides.items()}
    notes: tuple[str, ...] = ()
    if pattern is Pattern.UNSTRUCTURED:
        angle = smallest_angle(nodes, triangles)
        notes = (f"The smallest angle of the unstructured triangles is {angle:.1f} degrees.",)
    return validate(Mesh(nodes=nodes, triangles=triangles, node_groups=groups, notes=notes), "sheet")


def _equilateral(length: float, width: float, divisions: int) -> tuple[FloatArray, IntArray]:
    rows = max(1, round(width / (length / divisions * np.sqrt(3.0) / 2.0)))
    full = np.linspace(0.0, length, divisions + 1)
    short = 0.5 * (full[1:] + full[:-1])
    # The last row, if it is a short one, needs the corners of the sheet.
    cornered = np.concatenate([[0.0], short, [length]])
    lines = [full if row % 2 == 0 else cornered if row == rows else short for row in range(rows + 1)]
    heights = np.linspace(0.0, width, rows + 1)
    starts = np.concatenate([[0], np.cumsum([len(points) for points in lines])])
    nodes = np.column_stack(
        [np.concatenate(lines), np.repeat(heights, [len(points) for points in lines]), np.zeros(starts[-1])]
    )
    triangles = [_strip(lines[row], lines[row + 1], starts[row], starts[row + 1]) for row in range(rows)]
    for row in range(1, rows, 2):
        low, here, high = starts[row - 1], starts[row], starts[row + 1]
        ends = [[low, here, high]]
        if row + 1 <= rows:
            ends.append([here - 1, starts[row + 2] - 1, starts[row + 1] - 1])
        triangles.append(np.array(ends, dtype=np.int64))
    return nodes, np.concatenate(triangles)


def _strip(lower: FloatArray, upper: FloatArray, low: int, high: int) -> IntArray:
    """Triangulate between two rows of points sorted by x, counter-clockwise.

    Each interval of one row is joined to the point of the other row that faces its middle.
    """
    faces_lower = np.searchsorted(0.5 * (upper[1:] + upper[:-1]), 0.5 * (lower[1:] + lower[:-1]), "left")
    faces_upper = np.searchsorted(0.5 * (lower[1:] + lower[:-1]), 0.5 * (upper[1:] + upper[:-1]), "right")
    i, j = np.arange(len(lower) - 1), np.arange(len(upper) - 1)
    return np.concatenate(
        [
            np.stack([low + i, low + i + 1, high + faces_lower], axis=1),
            np.stack([high + j + 1, high + j, low + faces_upper], axis=1),
        ]
    )


def _grid(length: float, width: float, divisions: int) -> tuple[FloatArray, IntArray, int]:
    """Nodes of a rectangular grid, its cells as quads, and the number of columns."""
    rows = max(1, round(width / length * divisions))
    x, y = np.meshgrid(np.linspace(0.0, length, divisions + 1), np.linspace(0.0, width, rows + 1))
    nodes = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    corner = (np.arange(rows)[:, None] * (divisions + 1) + np.arange(divisions)).ravel()
    quads = np.stack([corner, corner + 1, corner + divisions + 2, corner + divisions + 1], axis=1)
    return nodes, quads, divisions


def _right(length: float, width: float, divisions: int) -> tuple[FloatArray, IntArray]:
    nodes, quads, _ = _grid(length, width, divisions)
    return nodes, quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def _alternating(length: float, width: float, divisions: int) -> tuple[FloatArray, IntArray]:
    nodes, quads, columns = _grid(length, width, divisions)
    cell = np.arange(len(quads))
    odd = (cell // columns + cell % columns) % 2 == 1
    split = np.where(odd[:, None], quads[:, [0, 1, 3, 1, 2, 3]], quads[:, [0, 1, 2, 0, 2, 3]])
    return nodes, split.reshape(-1, 3)


_SHEETS: dict[Pattern, Callable[[float, float, int], tuple[FloatArray, IntArray]]] = {
    Pattern.EQUILATERAL: _equilateral,
    Pattern.RIGHT: _right,
    Pattern.ALTERNATING: _alternating,
    Pattern.UNSTRUCTURED: unstructured_sheet,
}
