"""Triangles of shells: what lines face."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
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


@dataclass(frozen=True, slots=True)
class Junctions:
    """Sides and corners that two or more of the triangles share that one line faces.

    The sum over triangles counts them too often. A side of m triangles is taken off m - 1 times, and with all
    sides gone a corner of n triangles must be left once. Both follow from the triangles that are there, so
    that a surface may end, branch, or have parts that the line does not face.

    Attributes:
        sides: Lines and the two ends of a side, as nodes, shape (S, 4).
        corners: Lines and a corner, as nodes, shape (C, 3).
        sides_of: Side of each of the pairs of line and triangle, -1 if it is no junction, shape (P, 3).
        corners_of: Corners likewise, shape (P, 3).
        ends: Corners of each side, shape (S, 2).
    """

    sides: IntArray
    corners: IntArray
    sides_of: IntArray
    corners_of: IntArray
    ends: IntArray

    @classmethod
    def of(cls, numbers: IntArray, line_nodes: IntArray, triangles: IntArray) -> Junctions:
        """Of pairs of a line and a triangle.

        Args:
            numbers: Of the line of each pair, shape (P,).
            line_nodes: Its ends, shape (P, 2).
            triangles: Corners, shape (P, 3).
        """
        count = int(triangles.max(initial=0)) + 1
        corner_keys = numbers[:, None] * count + triangles
        following = np.roll(triangles, -1, axis=1)
        low, high = np.minimum(triangles, following), np.maximum(triangles, following)
        side_keys = (numbers[:, None] * count + low) * count + high
        corners_of, corner, whose = _shared(corner_keys)
        sides_of, side, owner = _shared(side_keys)
        line, low, high = side // count // count, side // count % count, side % count
        return cls(
            sides=np.column_stack((line_nodes[owner], low, high)),
            corners=np.column_stack((line_nodes[whose], corner % count)),
            sides_of=sides_of,
            corners_of=corners_of,
            ends=np.searchsorted(corner, np.column_stack((line * count + low, line * count + high))),
        )

    def coefficients(self, rows: IntArray) -> tuple[FloatArray, FloatArray]:
        """How often sides (S,) and corners (C,) count, where some of the pairs only are within reach."""
        of_side, of_corner = self.sides_of[rows], self.corners_of[rows]
        m = np.bincount(of_side[of_side >= 0], minlength=len(self.sides))
        n = np.bincount(of_corner[of_corner >= 0], minlength=len(self.corners))
        over = np.maximum(m - 1, 0)
        off = np.bincount(self.ends.reshape(-1), weights=np.repeat(over, 2), minlength=len(self.corners))
        return -over.astype(np.float64), np.where(n > 0, 1.0 - n + off, 0.0)


@dataclass(frozen=True, slots=True)
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


@dataclass(frozen=True, slots=True)
class Faced:
    """Lines and triangles within reach of each other.

    Attributes:
        which: Which of those that were measured, shape (K,).
        nodes: Of all that may face each other, shape (P, 5).
        reach: Of all, set for the K [m], shape (P,).
        factor: Stiffness times rest length, set for the K [N/m], shape (P,).
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


def _shared(keys: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Numbers of keys (P, 3) that come twice or more, else -1; these keys, and a pair that has each."""
    every, first, of, times = np.unique(
        keys.reshape(-1), return_index=True, return_inverse=True, return_counts=True
    )
    double = times >= 2
    place = np.where(double, np.cumsum(double) - 1, -1)
    return place[of.reshape(keys.shape)], every[double], first[double] // 3
