"""Lines of bodies against each other.

The energy of two lines that are too near is half the sum of two passes: of either line against all that it
faces of the other body. What a line faces are edges, less the inner vertices at which they meet, which would
count twice: along a straight body all but the nearest edge cancel, and no edge is told from its neighbours.
"""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...kinematics.dofs import DofMap
from ..law.between import Between
from ..pieces.cores import beside
from ..pieces.lines import Lines
from .candidates import Boxes, among, near_among


@frozen
class Neighbours:
    """Lines that may touch each other.

    Attributes:
        lines: All lines; those of numbers take part.
        numbers: Lines that take part, shape (E,).
        stiffness: Per length of each of these [N/m^2], at factor one, shape (E,).
        labels: Number of the pair of two bodies, -1 if they may not touch, shape (bodies, bodies).
        signs: 1 where the first index is the first of the pair, else -1, same shape.
        friction: Coefficients, same shape.
        excluded: Keys of pairs that are too near along a body, ascending; see :func:`.exclusion.near_along`.
        tight: Keys of pairs that are nearer at rest than they are thick, ascending.
        tight_reach: Distance at which these touch [m].
        map: Numbering of the DOFs.
    """

    lines: Lines
    numbers: IntArray
    stiffness: FloatArray
    labels: IntArray
    signs: FloatArray
    friction: FloatArray
    excluded: IntArray
    tight: IntArray
    tight_reach: FloatArray
    map: DofMap

    def allowed(self, pairs: IntArray) -> IntArray:
        """Those of some pairs (P, 2) that may touch."""
        bodies = self.lines.bodies
        kept = self.labels[bodies[pairs[:, 0]], bodies[pairs[:, 1]]] >= 0
        keys = self.keys(pairs)
        kept &= ~among(keys, self.excluded)
        return pairs[kept]

    def keys(self, pairs: IntArray) -> IntArray:
        """First times number of lines plus second."""
        return pairs[:, 0] * len(self.lines.nodes) + pairs[:, 1]

    def pairs(self, keys: IntArray) -> IntArray:
        """Pairs of keys, shape (P, 2)."""
        return np.stack(np.divmod(keys, len(self.lines.nodes)), axis=1)

    def reach(self, pairs: IntArray) -> FloatArray:
        """Distance at which pairs touch [m], shape (P,)."""
        reach = self.lines.radii[pairs].sum(axis=1)
        if len(self.tight):
            keys = self.keys(pairs)
            place = np.minimum(np.searchsorted(self.tight, keys), len(self.tight) - 1)
            reach = np.where(self.tight[place] == keys, self.tight_reach[place], reach)
        return np.asarray(reach)

    def between(self, one: IntArray, other: IntArray) -> Between:
        """What bodies (K,) are to each other."""
        return Between(self.friction[one, other], self.labels[one, other], self.signs[one, other])

    def distances(self, x: FloatArray, pairs: IntArray) -> FloatArray:
        """Distances of pairs of lines at nodes (N, 3) [m], shape (P,)."""
        return distances(np.ascontiguousarray(x[self.nodes(pairs)].transpose(1, 2, 0)))

    def nodes(self, pairs: IntArray) -> IntArray:
        """Nodes of the lines of pairs (P, 2), shape (P, 4)."""
        return self.lines.nodes[pairs].reshape(-1, 4)

    def factors(self, directed: IntArray) -> FloatArray:
        """Half the stiffness of the stiffer line, times the rest length of the first [N/m], shape (K,)."""
        stiff: FloatArray = 0.5 * self.stiffness[directed].max(axis=1) * self.lines.lengths[directed[:, 0]]
        return stiff

    def boxes(self, x: FloatArray, more: float) -> Boxes:
        """Boxes of the lines that take part, and how far they and ``more`` [m] of each pair reach."""
        lines = self.lines
        return Boxes.around(x[lines.nodes[self.numbers]], lines.radii[self.numbers] + 0.5 * more)

    def search(self, x: FloatArray, more: float) -> IntArray:
        """Allowed pairs whose lines may be within reach and ``more`` [m] of each other, shape (P, 2)."""
        return self.allowed(self.numbers[near_among(self.boxes(x, more))])


def distances(ends: FloatArray) -> FloatArray:
    """Distances of lines from segments, ends (4, 3, P) [m]: those of the line, then those of the segment."""
    start, end, first, second = ends
    return beside(start, end - start, first, second).nearest(start.shape[1])
