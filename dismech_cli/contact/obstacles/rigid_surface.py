"""A rigid surface of triangles, as read from a mesh file: what lines touch from either side.

A line faces all its triangles, less what these count too often where they meet, as it does on a shell; but
nothing of that gives way, so that a line couples its own two nodes only.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from ...arrays import FloatArray, IntArray, distinct
from ...frozen import frozen
from ..pieces.cores import beside, facing_node
from ..pieces.facing_triangle import facing
from ..pieces.pieces import Pieces
from ..pieces.surface import Junctions, owners
from ..points.barrier import Closest
from ..points.closest import closest_to_rigid
from ..points.points import Points, round_points
from ..points.secant import with_secant

if TYPE_CHECKING:
    from scipy.spatial import KDTree

# Triangles within a class differ in size by at most this factor: one tree each.
_CLASS: Final = 4.0
# So many lines, and pairs of lines and triangles, are looked at together.
_LINES: Final = 500
_TOGETHER: Final = 20_000


@frozen
class Group:
    """Triangles of similar size.

    Attributes:
        numbers: Among all, shape (K,).
        tree: Of the centres of their balls.
        size: The largest of their radii [m].
    """

    numbers: IntArray
    tree: KDTree
    size: float


@frozen
class RigidSurface:
    """All within half of a thickness of triangles; implements :class:`.obstacle.Shape`.

    Attributes:
        vertices: [m], shape (V, 3).
        triangles: Corners, shape (T, 3).
        half: Half of the thickness [m].
        lowest: Corners of boxes about them [m], shape (T, 3).
        highest: The opposite ones, shape (T, 3).
        groups: Balls about them, by size.
    """

    vertices: FloatArray
    triangles: IntArray
    half: float
    lowest: FloatArray
    highest: FloatArray
    groups: tuple[Group, ...]

    @classmethod
    def of(cls, vertices: FloatArray, triangles: IntArray, half: float) -> RigidSurface:
        """Of vertices [m] and triangles; arguments as the attributes."""
        from scipy.spatial import KDTree

        corners = vertices[triangles]
        middles = corners.mean(axis=1)
        out = corners - middles[:, None]
        sizes = np.sqrt((out * out).sum(axis=2).max(axis=1))
        classes = np.floor(np.log(sizes / sizes.min()) / np.log(_CLASS) + 1e-9).astype(np.int64)
        groups = []
        for one in distinct(classes).tolist():
            own = np.flatnonzero(classes == one)
            groups.append(Group(own, KDTree(middles[own]), float(sizes[own].max())))
        return cls(vertices, triangles, half, corners.min(axis=1), corners.max(axis=1), tuple(groups))

    def points(self, start: FloatArray, slope: FloatArray, radii: FloatArray, factor: FloatArray) -> Points:
        """Points of contact of lines; see :class:`.obstacle.Shape`."""
        reach = radii + self.half
        pairs = self._near(start, slope, reach)
        pieces = self._facing(start, slope, pairs)
        within = pieces.nearest(len(pairs)) < reach[pairs[:, 0]]
        rows = np.flatnonzero(within)
        place = np.cumsum(within) - 1
        some = pieces.some(np.flatnonzero(within[pieces.item]))
        some = Pieces(place[some.item], *(getattr(some, one.name) for one in fields(Pieces)[1:]))
        lines, faced = pairs[rows].T
        found = [_on_lines(some.fixed(), lines, np.ones(len(lines)), reach, factor)]
        nowhere = np.zeros((len(lines), 2), dtype=np.int64)
        junctions = Junctions.of(lines, nowhere, self.triangles[faced], np.zeros_like(lines))
        found += self._taken_off(junctions, lines, start, slope, reach, factor)
        return Points(*(np.concatenate([getattr(one, f.name) for one in found], axis=-1) for f in _FIELDS))

    def gaps(self, start: FloatArray, slope: FloatArray) -> FloatArray:
        """Distance of each line from the surface [m], shape (E,)."""
        count = start.shape[1]
        if not count:
            return np.empty(0)
        middle, half = _balls(start, slope)
        nearest = np.zeros(count, dtype=np.int64)
        far = np.full(count, np.inf)
        for group in self.groups:
            told, which = group.tree.query(middle)
            distance, found = np.asarray(told), np.asarray(which)
            nearer = distance < far
            far[nearer], nearest[nearer] = distance[nearer], group.numbers[found[nearer]]
        pairs = np.column_stack((np.arange(count), nearest))
        # no nearest triangle is farther than one of them
        out = self._facing(start, slope, pairs).nearest(count)
        for some in np.array_split(np.arange(count), max(count // _LINES, 1)):
            pairs = self._within(middle[some], half[some] + out[some])
            pairs[:, 0] = some[pairs[:, 0]]
            pairs = pairs[self._apart(start, slope, pairs) < out[pairs[:, 0]]]
            for part in np.array_split(pairs, max(len(pairs) // _TOGETHER, 1)):
                np.minimum.at(out, part[:, 0], self._facing(start, slope, part).nearest(len(part)))
        return np.asarray(out - self.half)

    @property
    def rounding(self) -> float:
        """Half of the thickness."""
        return self.half

    def closest(self, start: FloatArray, slope: FloatArray, more: FloatArray) -> Closest:
        """Closest points with every triangle nearby."""
        pairs = self._near(start, slope, more)
        line, nowhere = pairs[:, 0], np.zeros((3, len(pairs)))
        own, along = start[:, line], slope[:, line]
        corners = np.ascontiguousarray(self.vertices[self.triangles[pairs[:, 1]]].transpose(1, 2, 0))
        ends = facing(own, nowhere, corners), facing(own + along, nowhere, corners)
        found = closest_to_rigid(facing(own, along, corners), ends, len(pairs))
        return replace(found, item=line[found.item])

    def _near(self, start: FloatArray, slope: FloatArray, reach: FloatArray) -> IntArray:
        """Pairs of a line and a triangle that may be within reach [m], ascending, shape (P, 2)."""
        middle, half = _balls(start, slope)
        pairs = self._within(middle, half + reach)
        pairs = pairs[self._apart(start, slope, pairs) < reach[pairs[:, 0]]]
        return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]

    def _within(self, middle: FloatArray, sizes: FloatArray) -> IntArray:
        """Balls (K, 3) and triangles whose own balls overlap them, shape (P, 2)."""
        found = [np.empty((0, 2), dtype=np.int64)]
        for group in self.groups:
            lists = group.tree.query_ball_point(middle, sizes + group.size)
            counts = np.array([len(one) for one in lists], dtype=np.int64)
            faced = group.numbers[np.concatenate([np.empty(0, dtype=np.int64), *map(np.int64, lists)])]
            found.append(np.column_stack((np.repeat(np.arange(len(counts)), counts), faced)))
        return np.concatenate(found)

    def _apart(self, start: FloatArray, slope: FloatArray, pairs: IntArray) -> FloatArray:
        """Distance of the boxes of lines and triangles [m], shape (P,): no more than their own."""
        line, face = pairs.T
        low, high = np.minimum(start, start + slope).T, np.maximum(start, start + slope).T
        over = np.maximum(low[line] - self.highest[face], self.lowest[face] - high[line])
        gap = np.maximum(over, 0.0)
        return np.asarray(np.sqrt((gap * gap).sum(axis=1)))

    def _facing(self, start: FloatArray, slope: FloatArray, pairs: IntArray) -> Pieces:
        corners = self.vertices[self.triangles[pairs[:, 1]]].transpose(1, 2, 0)
        return facing(start[:, pairs[:, 0]], slope[:, pairs[:, 0]], np.ascontiguousarray(corners))

    def _taken_off(
        self,
        junctions: Junctions,
        lines: IntArray,
        start: FloatArray,
        slope: FloatArray,
        reach: FloatArray,
        factor: FloatArray,
    ) -> Iterator[Points]:
        """What sides and corners that triangles share count too often."""
        rows = np.arange(len(lines))
        sides, corners = junctions.coefficients(rows)
        which = np.flatnonzero(sides)
        line = lines[owners(junctions.sides_of, rows, len(sides))[which]]
        first, second = self.vertices[junctions.sides[which, 2:]].transpose(1, 2, 0)
        pieces = beside(start[:, line], slope[:, line], first, second).fixed()
        yield _on_lines(pieces, line, sides[which], reach, factor)
        which = np.flatnonzero(corners)
        line = lines[owners(junctions.corners_of, rows, len(corners))[which]]
        pieces = facing_node(start[:, line], slope[:, line], self.vertices[junctions.corners[which, 2]].T)
        yield _on_lines(pieces.fixed(), line, corners[which], reach, factor)


_FIELDS = fields(Points)


def _on_lines(
    pieces: Pieces, lines: IntArray, weights: FloatArray, reach: FloatArray, factor: FloatArray
) -> Points:
    """Points of pieces whose items are parts of lines, told by the lines.

    Args:
        pieces: Item k is on line ``lines[k]`` and counts ``weights[k]`` times.
        lines: Shape (K,).
        weights: Shape (K,).
        reach: Of all lines [m], shape (E,).
        factor: Stiffness times rest length of all lines [N/m], shape (E,).
    """
    points = round_points(pieces, reach[lines], weights * factor[lines])
    line = lines[points.item]
    points = with_secant(points, reach[line])
    return Points(line, *(getattr(points, one.name) for one in _FIELDS[1:]))


def _balls(start: FloatArray, slope: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Middles (E, 3) and half lengths (E,) of lines [m]."""
    return (start + 0.5 * slope).T, 0.5 * np.sqrt((slope * slope).sum(axis=0))
