"""Lines and the triangles of shells that they may touch."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...kinematics.dofs import DofMap
from ..law.between import Between
from ..pieces.facing_triangle import features
from ..pieces.lines import Lines
from ..pieces.pieces import Pieces
from ..pieces.surface import Surface
from .candidates import Boxes, among, near_boxes


@frozen
class Faces:
    """Who may touch shells.

    A rod touches a shell along its own lines only. Two shells, or a shell and itself, touch along the lines
    of either, at half the energy each.

    Attributes:
        lines: All lines; those of numbers take part.
        numbers: Lines that take part, shape (K,).
        surface: The triangles, T of them.
        masses: Mass that comes with each of all lines [kg], shape (E,).
        stiffness: Of a line of the body of the first index against a shell, per length and weight of the line
            at factor one, shape (bodies, bodies).
        labels: Number of the pair of two bodies, -1 if they may not touch, same shape.
        signs: 1 where the first index is the first of the pair, else -1, same shape.
        friction: Coefficients, same shape.
        excluded: Keys of lines and triangles that are too near along a body, ascending.
        own_reach: Most that the reach of a line to its own body may be [m], shape (E,).
        map: Numbering of the DOFs.
    """

    lines: Lines
    numbers: IntArray
    surface: Surface
    masses: FloatArray
    stiffness: FloatArray
    labels: IntArray
    signs: FloatArray
    friction: FloatArray
    excluded: IntArray
    own_reach: FloatArray
    map: DofMap

    def keys(self, pairs: IntArray) -> IntArray:
        """Line times number of triangles plus triangle, of pairs (P, 2)."""
        return pairs[:, 0] * len(self.surface.nodes) + pairs[:, 1]

    def pairs(self, keys: IntArray) -> IntArray:
        """Pairs of keys, shape (P, 2)."""
        return np.stack(np.divmod(keys, len(self.surface.nodes)), axis=1)

    def bodies(self, pairs: IntArray) -> tuple[IntArray, IntArray]:
        """Body of the line and of the triangle of each pair, shapes (P,)."""
        return self.lines.bodies[pairs[:, 0]], self.surface.bodies[pairs[:, 1]]

    def between(self, one: IntArray, other: IntArray) -> Between:
        """What bodies (K,) are to each other."""
        return Between(self.friction[one, other], self.labels[one, other], self.signs[one, other])

    def thickness(self, pairs: IntArray) -> FloatArray:
        """Half the thickness of both together [m], shape (P,)."""
        both: FloatArray = self.lines.radii[pairs[:, 0]] + self.surface.halves[pairs[:, 1]]
        return both

    def reach(self, pairs: IntArray) -> FloatArray:
        """Distance at which pairs touch [m], shape (P,): one for a line and what is equally thick."""
        line, face = self.bodies(pairs)
        own = np.where(line == face, self.own_reach[pairs[:, 0]], np.inf)
        return np.minimum(self.thickness(pairs), own)

    def factor(self, pairs: IntArray) -> FloatArray:
        """Stiffness times rest length and weight of the line [N/m], shape (P,)."""
        line, face = self.bodies(pairs)
        lines = self.lines
        scale: FloatArray = (
            self.stiffness[line, face] * lines.lengths[pairs[:, 0]] * lines.weights[pairs[:, 0]]
        )
        return scale

    def nodes(self, pairs: IntArray) -> IntArray:
        """Nodes of the lines and of the triangles of pairs (P, 2), shape (P, 5)."""
        line, face = self.lines.nodes[pairs[:, 0]], self.surface.nodes[pairs[:, 1]]
        return np.concatenate((line, face), axis=1)

    def distances(self, x: FloatArray, pairs: IntArray) -> FloatArray:
        """Distances of pairs (P, 2), with nodes at (N, 3) [m], shape (P,)."""
        return face_distances(np.ascontiguousarray(x[self.nodes(pairs)].transpose(1, 2, 0)))

    def boxes(self, x: FloatArray, more: float) -> tuple[Boxes, Boxes]:
        """Boxes of the lines that take part and of the triangles, and how far they and ``more`` [m] reach."""
        lines, surface = self.lines, self.surface
        return (
            Boxes.around(x[lines.nodes[self.numbers]], lines.radii[self.numbers] + more),
            Boxes.around(x[surface.nodes], surface.halves),
        )

    def allowed(self, near: IntArray) -> IntArray:
        """Keys of those pairs of a line that takes part and a triangle (P, 2), ascending, that may touch."""
        pairs = np.stack((self.numbers[near[:, 0]], near[:, 1]), axis=1)
        line, face = self.bodies(pairs)
        keys = self.keys(pairs)
        return keys[(self.labels[line, face] >= 0) & ~among(keys, self.excluded)]

    def search(self, x: FloatArray, more: float) -> IntArray:
        """Keys of pairs that may be within reach and ``more`` [m] of each other, ascending."""
        return self.allowed(near_boxes(*self.boxes(x, more)))


def face_pieces(x: FloatArray, nodes: IntArray) -> tuple[Pieces, IntArray]:
    """Pieces of lines by what they face of a triangle each, nodes (P, 5) at (N, 3) [m], and the features."""
    places = np.ascontiguousarray(x[nodes].transpose(1, 2, 0))
    return features(places[0], places[1] - places[0], places[2:])


def face_distances(places: FloatArray) -> FloatArray:
    """Distances of lines from triangles, nodes (5, 3, P) [m]: two of the line first."""
    pieces, _ = features(places[0], places[1] - places[0], places[2:])
    return pieces.nearest(places.shape[2])


def boxes_apart(x: FloatArray, more: FloatArray, nodes: IntArray) -> FloatArray:
    """Distances of the boxes of lines and triangles, nodes (P, 5), at two places of the nodes (N, 3) [m].

    They are no more than the least distance on the straight way between the two.
    """
    low, high = np.minimum(x, more), np.maximum(x, more)
    line, face = nodes[:, :2], nodes[:, 2:]
    over = np.maximum(
        low[line].min(axis=1) - high[face].max(axis=1), low[face].min(axis=1) - high[line].max(axis=1)
    )
    gap = np.maximum(over, 0.0)
    return np.asarray(np.sqrt((gap * gap).sum(axis=1)))
