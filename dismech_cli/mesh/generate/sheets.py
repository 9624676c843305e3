"""Shells from formulas: sheets, discs, annuli, hemispheres."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import Enum

import numpy as np

from ...arrays import FloatArray, IntArray
from ...errors import MeshError
from ..files.source import MAX_COORDINATE, check_count
from ..mesh import Mesh
from ..validate import validate
from .unstructured import smallest_angle, unstructured_sheet


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
    _check_sizes("sheet", length=length, width=width)
    _check_divisions("sheet", divisions)
    cells = width / length * divisions
    check_count(int(min(2.0 * divisions * max(cells, 1.0), 1e18)), "triangles", "sheet")
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


def disc(radius: float, rings: int, *, counts: Sequence[int] | None = None) -> Mesh:
    """Make a flat disc at z = 0 around the origin, normal along +z.

    Args:
        radius: Radius [m].
        rings: Number of rings around the central node, evenly spaced.
        counts: Nodes of each ring, inner first; 6, 12, 18, ... by default.

    Returns:
        Mesh with node groups ``center`` and ``rim``.

    Raises:
        MeshError: If sizes are not positive or the counts do not fit.
    """
    _check_sizes("disc", radius=radius)
    _check_divisions("disc", rings)
    check_count(3 * rings * rings, "nodes", "disc")
    numbers = [6 * (ring + 1) for ring in range(rings)] if counts is None else counts
    radii = radius * (np.arange(rings) + 1) / rings
    return _rings("disc", radii, np.zeros(rings), numbers, np.zeros(3), ("center", "rim"))


def annulus(inner: float, outer: float, rings: int, *, counts: Sequence[int] | None = None) -> Mesh:
    """Make a flat ring at z = 0 around the origin, normal along +z.

    Args:
        inner: Radius of the hole [m].
        outer: Outer radius [m].
        rings: Number of strips between the two circles: there are ``rings + 1`` circles of nodes.
        counts: Nodes of each circle, inner first; by default such that triangles are about
            equilateral.

    Returns:
        Mesh with node groups ``inner`` and ``outer``.

    Raises:
        MeshError: If sizes are not positive or ordered, or the counts do not fit.
    """
    _check_sizes("annulus", inner=inner, outer=outer)
    _check_divisions("annulus", rings)
    if not inner < outer:
        raise MeshError(f"annulus: inner radius {inner} m is not below the outer radius {outer} m")
    radii = np.linspace(inner, outer, check_count(rings, "rings", "annulus") + 1)
    if counts is None:
        counts = _even_counts("annulus", 2.0 * np.pi * radii, (outer - inner) / rings)
    return _rings("annulus", radii, np.zeros(len(radii)), counts, None, ("inner", "outer"))


def hemisphere(
    radius: float,
    rings: int,
    *,
    polar_angles: Sequence[float] | None = None,
    counts: Sequence[int] | None = None,
) -> Mesh:
    """Make a hemisphere or cap around +z, its sphere centred at the origin, normals outward.

    Args:
        radius: Radius of the sphere [m].
        rings: Number of rings of nodes below the apex.
        polar_angles: Angle of each ring from +z [rad], ascending, below pi; evenly spaced to the
            equator by default.
        counts: Nodes of each ring, top first; by default such that triangles are about equilateral.

    Returns:
        Mesh with node groups ``apex`` and ``rim``.

    Raises:
        MeshError: If the sizes are not positive or angles and counts do not fit.
    """
    _check_sizes("hemisphere", radius=radius)
    _check_divisions("hemisphere", rings)
    check_count(rings, "rings", "hemisphere")
    even = 0.5 * np.pi * (np.arange(rings) + 1) / rings
    angles = np.asarray(even if polar_angles is None else polar_angles, dtype=np.float64)
    if len(angles) != rings or not (np.diff(angles, prepend=0.0, append=np.pi) > 0.0).all():
        raise MeshError(
            f"hemisphere: polar_angles {angles.tolist()[:20]}; expected {rings} between 0 and pi, ascending"
        )
    radii, heights = radius * np.sin(angles), radius * np.cos(angles)
    # The equator lies at z = 0 exactly, not at the rounding error of cos(pi / 2).
    heights[np.abs(heights) < 1e-15 * radius] = 0.0
    step = radius * float(angles[-1]) / rings
    numbers = _even_counts("hemisphere", 2.0 * np.pi * radii, step) if counts is None else counts
    return _rings("hemisphere", radii, heights, numbers, np.array([0.0, 0.0, radius]), ("apex", "rim"))


def _even_counts(where: str, lengths: FloatArray, step: float) -> list[int]:
    """Nodes of circles of given lengths, for edges as long as those of equilateral rows ``step`` apart."""
    numbers = np.maximum(np.round(lengths / (step * 2.0 / np.sqrt(3.0))), 5.0)
    check_count(int(min(numbers.sum(), 1e18)), "nodes", where)
    return [int(number) for number in numbers]


def _rings(
    where: str,
    radii: FloatArray,
    heights: FloatArray,
    counts: Sequence[int],
    center: FloatArray | None,
    names: tuple[str, str],
) -> Mesh:
    """Triangulate between circles of nodes, each starting at angle 0, around an optional centre node."""
    if len(counts) != len(radii) or min(counts) < 3:
        raise MeshError(f"{where}: counts {list(counts)[:20]}; expected {len(radii)} numbers of at least 3")
    check_count(sum(counts), "nodes", where)
    points = [] if center is None else [center[None]]
    triangles = []
    start = 0 if center is None else 1
    if center is not None:
        k = np.arange(counts[0])
        triangles.append(np.stack([np.zeros_like(k), 1 + k, 1 + (k + 1) % counts[0]], axis=1))
    for ring, (radius, height, count) in enumerate(zip(radii, heights, counts, strict=True)):
        angle = 2.0 * np.pi * np.arange(count) / count
        points.append(
            np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(count, height)])
        )
        if ring + 1 < len(counts):
            triangles.append(_between(count, counts[ring + 1], start, start + count))
        start += count
    first = np.arange(counts[0]) if center is None else np.zeros(1, dtype=np.int64)
    groups = {names[0]: first, names[1]: np.arange(start - counts[-1], start)}
    mesh = Mesh(nodes=np.concatenate(points), triangles=np.concatenate(triangles), node_groups=groups)
    return validate(mesh, where)


def _between(inner: int, outer: int, low: int, high: int) -> IntArray:
    """Triangulate between two circles with ``inner`` and ``outer`` nodes from angle 0, wound outward.

    Each edge of one circle is joined to the node of the other that faces its middle. In whole
    numbers, so that ties fall alike everywhere: edge i of the inner circle has its middle at
    (2 i + 1) / (2 inner) turns.
    """
    i, j = np.arange(inner), np.arange(outer)
    # Number of middles of the other circle that lie before (or, for one circle only, at) this middle.
    faces_inner = ((2 * i + 1) * outer + inner - 1) // (2 * inner)
    faces_outer = ((2 * j + 1) * inner + outer) // (2 * outer)
    return np.concatenate(
        [
            np.stack([low + (i + 1) % inner, low + i, high + faces_inner % outer], axis=1),
            np.stack([high + j, high + (j + 1) % outer, low + faces_outer % inner], axis=1),
        ]
    )


def _check_sizes(where: str, **sizes: float) -> None:
    for name, value in sizes.items():
        if not 0.0 < value <= MAX_COORDINATE:
            raise MeshError(f"{where}: {name} {value}; expected a positive number")


def _check_divisions(where: str, count: int) -> None:
    if count < 1:
        raise MeshError(f"{where}: {count} divisions; expected at least 1")
