"""What is done to many pairs or points at once, by NumPy or by compiled loops."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from ...arrays import FloatArray, IntArray
from ...kernels.driver import Driver
from ...kernels.linearization import Pattern
from ..gather.stencils import GeneralPlaces, Stencils
from ..gather.touching import Touching
from ..gather.upper import Sums, Upper
from ..nearby.candidates import Boxes
from ..pieces.surface import Faced
from ..points.strips import Strips
from .batches import Batches
from .compiled import Compiled


class Near(Protocol):
    """Lines and triangles that were looked at.

    Attributes:
        kept: Which of the pairs these are, ascending, shape (K,).
        bound: What their distances are no less than [m], shape (K,).
    """

    @property
    def kept(self) -> IntArray:
        """See the class."""

    @property
    def bound(self) -> FloatArray:
        """See the class."""

    def distances(self, which: IntArray) -> FloatArray:
        """Distances of some of them [m], shape (W,)."""

    def strips(self, faced: Faced) -> tuple[Strips, Strips, Strips]:
        """Parts that touch triangles, and the sides and corners that these share.

        Pairs that do not touch do no harm: who touches a side touches all triangles that have it. Stiffness
        is that of the secant. What counts as often with one sign as with the other is left out. Valid until
        the next call.
        """


class Loops(Protocol):
    """All places of nodes are x (N, 3) [m]; both kinds agree to rounding.

    Points may come in another order.
    """

    def near_among(self, boxes: Boxes) -> IntArray:
        """Pairs of boxes that are nearer than both sizes, the lower number first, ascending, shape (P, 2)."""

    def near_boxes(self, first: Boxes, second: Boxes) -> IntArray:
        """Pairs of two kinds of boxes that are nearer than both sizes, ascending, shape (P, 2)."""

    def segment_distances(self, x: FloatArray, nodes: IntArray) -> FloatArray:
        """Distances of lines from segments, nodes (P, 4) [m], shape (P,)."""

    def segment_strips(
        self, x: FloatArray, nodes: IntArray, rows: IntArray, reach: FloatArray, factor: FloatArray
    ) -> Strips:
        """Parts of lines that touch segments, by the row of each; valid until the next call.

        Args:
            x: Nodes.
            nodes: Of lines and segments, shape (S, 4).
            rows: Those to look at, shape (K,).
            reach: Of these [m], shape (K,).
            factor: Of these, stiffness times rest length times sign [N/m], shape (K,).
        """

    def vertex_strips(
        self, x: FloatArray, nodes: IntArray, rows: IntArray, reach: FloatArray, factor: FloatArray
    ) -> Strips:
        """The same with vertices, nodes (S, 3)."""

    def safe_way(
        self, x: FloatArray, way: FloatArray, nodes: IntArray, stop: FloatArray, nearest: FloatArray
    ) -> float:
        """Part in (0, 1] of a way on which no gap of pairs falls below the least one; see :mod:`.advance`.

        Args:
            x: Nodes.
            way: Of each [m], shape (N, 3).
            nodes: Of lines and segments, shape (P, 4), or of lines and triangles, shape (P, 5).
            stop: Gaps are what distances are more than this [m], shape (P,).
            nearest: Least gap [m], shape (P,).
        """

    def boxes_apart(self, x: FloatArray, more: FloatArray, nodes: IntArray) -> FloatArray:
        """Distances of the boxes of lines and triangles, nodes (P, 5), at two places of the nodes [m]."""

    def look(self, x: FloatArray, nodes: IntArray, limit: FloatArray) -> Near:
        """Lines and triangles, nodes (P, 5), all that are nearer than a limit (P,) [m] and maybe more."""

    def face_distances(self, x: FloatArray, nodes: IntArray) -> FloatArray:
        """Distances of lines from triangles, nodes (P, 5) [m], shape (P,)."""

    def sums(self, stencils: Sequence[Stencils], pattern: Pattern) -> Sums:
        """Places of items of all kinds."""

    def symmetric_places(self, stencils: Stencils, pattern: Pattern) -> Upper:
        """Places of the upper triangles of items."""

    def general_places(self, stencils: Stencils, pattern: Pattern) -> GeneralPlaces:
        """Places of the whole matrices of items."""

    def add_forces(self, touching: Touching, vector: FloatArray, r: FloatArray) -> None:
        """Add weights times a vector (3, K) of each point to ``r``, shape (n,)."""

    def add_general(
        self, touching: Touching, places: GeneralPlaces, block: FloatArray, values: FloatArray
    ) -> None:
        """Add w_i w_j times a block (3, 3, K) of each point to stored values (slots,)."""


def loops_of(driver: Driver) -> Loops:
    """Those that a driver runs."""
    return Compiled.of(driver) or Batches()
