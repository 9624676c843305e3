"""Points of contact of lines with surfaces: triangles, less what they count too often where they meet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ..drivers.loops import Near
from ..nearby.faces import Faces
from ..pieces.surface import Faced, Junctions, Shared
from ..points.strips import Strips

# Thicknesses that differ by less than that of a file in single precision are alike.
_DIGITS = 6


@frozen
class Facing:
    """Lines and the triangles that they may face, with the junctions of these.

    Attributes:
        faces: Who may touch.
        keys: Of the pairs, ascending, shape (P,).
        pairs: Line and triangle, shape (P, 2).
        nodes: Of line and triangle, shape (P, 5).
        junctions: Sides and corners that are shared.
    """

    faces: Faces
    keys: IntArray
    pairs: IntArray
    nodes: IntArray
    junctions: Junctions
    _every: IntArray = field(init=False, repr=False, compare=False)
    # of the pairs last asked for, which seldom change from one trial point to the next
    _last: list[Shared] = field(init=False, repr=False, compare=False, default_factory=list)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_every", np.arange(len(self.keys)))

    @classmethod
    def of(cls, faces: Faces, keys: IntArray) -> Facing:
        """Of some pairs."""
        pairs = faces.pairs(keys)
        nodes = faces.nodes(pairs)
        kind = _kinds(faces, pairs[:, 1])
        numbers = pairs[:, 0] * (int(kind.max(initial=0)) + 1) + kind
        junctions = Junctions.of(numbers, nodes[:, :2], nodes[:, 2:], _levels(faces, pairs[:, 1]))
        return cls(faces, keys, pairs, nodes, junctions)

    def strips(
        self, near: Near, which: IntArray, rows: IntArray, reach: FloatArray, factor: FloatArray
    ) -> Iterator[tuple[int, Strips, IntArray]]:
        """What touches by kind: triangles, sides and corners; and a pair that each item belongs to.

        Args:
            near: Lines and triangles that were measured.
            which: Those of them within reach, shape (K,).
            rows: Where these pairs are among all, ascending, shape (K,).
            reach: Of all pairs [m], shape (P,).
            factor: Stiffness times rest length of all pairs [N/m], shape (P,).
        """
        if not len(rows):
            return
        if not (self._last and np.array_equal(self._last[0].rows, rows)):
            self._last[:] = [Shared.of(self.junctions, rows)]
        (shared,) = self._last
        faced = Faced(which, self.nodes, reach, factor, self.junctions, shared)
        for kind, strips in enumerate(near.strips(faced)):
            yield kind, strips, self.owners(kind)

    def owners(self, kind: int) -> IntArray:
        """A pair that each item last asked for belongs to: of triangles, sides or corners, by kind."""
        (shared,) = self._last
        return (self._every, shared.side_owner, shared.corner_owner)[kind]


def _kinds(faces: Faces, triangles: IntArray) -> IntArray:
    """Numbers of triangles, the same for those that any line faces at one stiffness, shape (P,).

    Only what is alike cancels where triangles meet. Shells that differ have a rim each where they meet: a
    line feels both within reach of it, and its forces stay those of an energy.
    """
    scale = np.abs(faces.stiffness).max(axis=1, initial=0.0, keepdims=True)
    stiffness = np.round(faces.stiffness / np.maximum(scale, np.finfo(float).tiny), _DIGITS)
    _, body = np.unique(stiffness.T, axis=0, return_inverse=True)
    return body.reshape(-1)[faces.surface.bodies[triangles]]


def _levels(faces: Faces, triangles: IntArray) -> IntArray:
    """Ranks of the thickness of triangles, shape (P,)."""
    halves = faces.surface.halves
    steps = np.round(halves[triangles] / halves.max() * 10.0**_DIGITS).astype(np.int64)
    _, level = np.unique(steps, return_inverse=True)
    return level.reshape(-1)
