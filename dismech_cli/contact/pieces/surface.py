"""Triangles of shells: what lines face."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ..law.levels import from_here_on, of_next, shared


@frozen
class Surface:
    """Triangles with a thickness.

    Attributes:
        nodes: Corners, shape (T, 3).
        halves: Half of the thickness [m], shape (T,).
        masses: Mean of the masses of the corners [kg], shape (T,).
        bodies: Body of each, shape (T,).
    """

    nodes: IntArray
    halves: FloatArray
    masses: FloatArray
    bodies: IntArray


@frozen
class Junctions:
    """Sides and corners that two or more of the triangles share that one line faces.

    The sum over triangles counts them too often. A side of m triangles is taken off m - 1 times, and with all
    sides gone a corner of n triangles must be left once. Both follow from the triangles that are there, so
    that a surface may end, branch, or have parts that the line does not face.

    Triangles that are faced at several distances are layers: the whole surface at the least of them, and on
    top of that, at each next one, what is thicker. Every layer is a surface with junctions of its own. So a
    side of two triangles is taken off at the lesser distance: thin parts feel the rim of thick ones, nothing
    is counted twice, and nothing jumps. Sides and corners stand here once for each such level.

    Attributes:
        sides: Lines and the two ends of a side, as nodes, shape (S, 4).
        corners: Lines and a corner, as nodes, shape (C, 3).
        sides_of: Side at the level of each of the pairs of line and triangle, -1 if it is no junction,
            shape (P, 3).
        corners_of: Corners likewise, shape (P, 3).
        ends: Corners of each side, shape (S, 2).
        sides_until: Where the levels of each side end, which ascend, shape (S,).
        corners_until: The same of corners, shape (C,).
    """

    sides: IntArray
    corners: IntArray
    sides_of: IntArray
    corners_of: IntArray
    ends: IntArray
    sides_until: IntArray
    corners_until: IntArray

    @classmethod
    def of(cls, numbers: IntArray, line_nodes: IntArray, triangles: IntArray, levels: IntArray) -> Junctions:
        """Of pairs of a line and a triangle.

        Args:
            numbers: Of the line of each pair, shape (P,).
            line_nodes: Its ends, shape (P, 2).
            triangles: Corners, shape (P, 3).
            levels: Rank of the distance at which it faces the triangle, from 0, shape (P,).
        """
        count = int(triangles.max(initial=0)) + 1
        following = np.roll(triangles, -1, axis=1)
        low, high = np.minimum(triangles, following), np.maximum(triangles, following)
        corners_of, corner, corners_until = shared(numbers[:, None] * count + triangles, levels)
        sides_of, side, sides_until = shared((numbers[:, None] * count + low) * count + high, levels)
        (pair, k), (whose, at) = np.divmod(side, 3), np.divmod(corner, 3)
        ends = np.column_stack((corners_of[pair, k], corners_of[pair, (k + 1) % 3]))
        ends = np.where((triangles[pair, k] == low[pair, k])[:, None], ends, ends[:, ::-1])
        return cls(
            sides=np.column_stack((line_nodes[pair], low[pair, k], high[pair, k])),
            corners=np.column_stack((line_nodes[whose], triangles[whose, at])),
            sides_of=sides_of,
            corners_of=corners_of,
            ends=ends,
            sides_until=sides_until,
            corners_until=corners_until,
        )

    def coefficients(self, rows: IntArray) -> tuple[FloatArray, FloatArray]:
        """How often sides (S,) and corners (C,) count, where some of the pairs only are within reach."""
        of_side, of_corner = self.sides_of[rows], self.corners_of[rows]
        m = np.bincount(of_side[of_side >= 0], minlength=len(self.sides))
        n = np.bincount(of_corner[of_corner >= 0], minlength=len(self.corners))
        over = np.maximum(from_here_on(m, self.sides_until) - 1, 0)
        # a layer without that of the next one, which is felt farther away
        over = over - of_next(over, self.sides_until)
        off = np.bincount(self.ends.reshape(-1), weights=np.repeat(over, 2), minlength=len(self.corners))
        thickest = (n > 0) & (of_next(from_here_on(n, self.corners_until), self.corners_until) == 0)
        left = np.where(thickest, 1.0, 0.0) - n + off
        return -over.astype(np.float64), left.astype(np.float64)


@frozen
class Shared:
    """What some pairs of lines and triangles share.

    Attributes:
        rows: Which pairs of all, ascending, shape (K,).
        side_times: How often each side counts beside the triangles, shape (S,).
        corner_times: How often each corner counts beside triangles and sides, shape (C,).
        side_owner: One of the pairs that has each side, shape (S,).
        corner_owner: One of the pairs that has each corner, shape (C,).
    """

    rows: IntArray
    side_times: FloatArray
    corner_times: FloatArray
    side_owner: IntArray
    corner_owner: IntArray

    @classmethod
    def of(cls, junctions: Junctions, rows: IntArray) -> Shared:
        """Of the junctions of all pairs."""
        j = junctions
        return cls(
            rows,
            *j.coefficients(rows),
            owners(j.sides_of, rows, len(j.sides)),
            owners(j.corners_of, rows, len(j.corners)),
        )


@frozen
class Faced:
    """Lines and triangles within reach of each other.

    Attributes:
        which: Which of those that were measured, shape (K,).
        nodes: Of all that may face each other, shape (P, 5).
        reach: Of all [m], shape (P,).
        factor: Stiffness times rest length of all [N/m], shape (P,).
        junctions: Of all.
        shared: Of the K.
    """

    which: IntArray
    nodes: IntArray
    reach: FloatArray
    factor: FloatArray
    junctions: Junctions
    shared: Shared

    @property
    def rows(self) -> IntArray:
        """Which of all these are, ascending, shape (K,)."""
        return self.shared.rows


def owners(of: IntArray, rows: IntArray, count: int) -> IntArray:
    """The last of some pairs that has each junction, shape (count,)."""
    out = np.zeros(count, dtype=np.int64)
    found = of[rows]
    out[found[found >= 0]] = np.repeat(rows, 3)[found.reshape(-1) >= 0]
    return out
