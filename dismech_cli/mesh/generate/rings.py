"""Shells from formulas: circles of nodes around an axis, as discs, annuli and hemispheres."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...arrays import FloatArray, IntArray
from ...errors import MeshError
from ..limits import check_count
from ..mesh import Mesh
from ..validate import validate
from .checks import check_divisions, check_positive, check_triangles


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
    check_positive(radius, "radius", "disc")
    check_divisions(rings, "disc")
    if counts is None:
        check_triangles(6.0 * rings * rings, "disc")
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
    check_positive(inner, "inner", "annulus")
    check_positive(outer, "outer", "annulus")
    check_divisions(rings, "annulus")
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
    check_positive(radius, "radius", "hemisphere")
    check_divisions(rings, "hemisphere")
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
    check_triangles(2.0 * float(numbers.sum()), where)
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
    check_triangles(2.0 * sum(counts), where)
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
