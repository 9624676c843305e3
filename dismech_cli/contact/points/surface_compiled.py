"""Points of contact of lines with surfaces by compiled loops: what :mod:`.surface_points` does in batches."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...kernels.driver import Driver
from ..pieces import junction_loops, line_loops, point_loops
from ..pieces.face_loops import MOST_PIECES
from ..pieces.surface import Faced
from .filled import Filler, Laid, Loop
from .strips import Strips, Table


class SurfaceLoops:
    """The loops, with buffers that are kept."""

    def __init__(self, loops: list[Loop], fill: Loop) -> None:
        self._faces, self._junctions, self._net, self._sides, self._corners = loops
        self._fill = tuple(Filler(fill, faced, 0) for faced in (3, 2, 1))
        self._capacity = -1

    @classmethod
    def of(cls, driver: Driver) -> SurfaceLoops | None:
        """The loops of a driver; None where it does not compile."""
        names = (
            junction_loops.face_spans,
            junction_loops.junction_spans,
            junction_loops.net_spans,
            junction_loops.side_pieces,
            junction_loops.corner_pieces,
            point_loops.fill_points,
        )
        *loops, fill = [driver.compiled(one) for one in names]
        found = [one for one in loops if one is not None]
        return None if fill is None or len(found) < len(loops) else cls(found, fill)

    def strips(self, x: FloatArray, faced: Faced) -> tuple[Strips, Strips, Strips]:
        """See :meth:`.loops.Near.strips`."""
        j = faced.junctions
        self._grow(MOST_PIECES * len(faced.rows) + 2 * len(j.sides) + len(j.corners))
        counts = np.zeros(3, dtype=np.int64)
        shared, rows = faced.shared, faced.rows
        reach, spans = faced.reach[rows], (*self._spans[0], *self._spans[1], counts)
        self._faces(
            x, faced.nodes, rows, reach, j.sides_of, j.corners_of, self._items[0], self._tables[0], *spans
        )
        self._junctions(x, j.sides, shared.side_times, j.ends, shared.corner_times, *spans)
        whole = self._laid(0, int(counts[0]), rows, reach, faced.factor[rows])
        return (
            whole,
            self._shared(1, self._sides, x, j.sides, int(counts[1]), shared.side_owner, faced),
            self._shared(2, self._corners, x, j.corners, int(counts[2]), shared.corner_owner, faced),
        )

    def _shared(
        self, kind: int, find: Loop, x: FloatArray, nodes: IntArray, count: int, owner: IntArray, faced: Faced
    ) -> Strips:
        """Parts that touch sides or corners."""
        group, span = self._spans[kind - 1]
        found = self._net(group, span, count, len(nodes), self._group, self._span)
        group, span = self._group[:found].copy(), self._span[:found]
        row = owner[group]
        reach, factor = faced.reach[row], faced.factor[row]
        pieces = find(x, nodes, group, span, reach, self._items[kind], self._tables[kind])
        return self._laid(kind, pieces, group, reach, factor * span[:, 2])

    def _laid(self, kind: int, count: int, rows: IntArray, reach: FloatArray, factor: FloatArray) -> Strips:
        """The first pieces of a kind."""
        item, pieces = self._items[kind][:count], self._tables[kind][:count]
        return Laid(Table(rows, item, pieces, reach, factor), self._fill[kind])

    def _grow(self, capacity: int) -> None:
        """Make room for so many pieces or spans; pages that are never written cost nothing."""
        if capacity <= self._capacity:
            return
        self._capacity = size = 2 * capacity
        self._items = tuple(np.empty(2 * size, dtype=np.int64) for _ in range(3))
        self._tables = tuple(np.empty((2 * size, line_loops.piece_columns(faced))) for faced in (3, 2, 1))
        self._spans = tuple((np.empty(size, dtype=np.int64), np.empty((size, 3))) for _ in range(2))
        self._group, self._span = np.empty(2 * size, dtype=np.int64), np.empty((2 * size, 3))


@frozen
class Looked:
    """Lines and triangles that may be near; implements :class:`.loops.Near`.

    Attributes:
        x: The nodes [m], shape (N, 3).
        nodes: Of all pairs, shape (P, 5).
        kept: Which of the pairs these are, shape (K,).
        bound: What their distances are no less than [m], shape (K,).
        loops: Find the parts that touch.
        measure: Distances of lines from triangles.
    """

    x: FloatArray
    nodes: IntArray
    kept: IntArray
    bound: FloatArray
    loops: SurfaceLoops
    measure: Callable[[FloatArray, IntArray], FloatArray]
    # of those that were asked for; not a number of all others
    _known: FloatArray = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_known", np.full(len(self.kept), np.nan))

    def distances(self, which: IntArray) -> FloatArray:
        """Distances of some of them [m], shape (W,)."""
        new = which[np.isnan(self._known[which])]
        if len(new):
            self._known[new] = self.measure(self.x, self.nodes[self.kept[new]])
        return self._known[which]

    def strips(self, faced: Faced) -> tuple[Strips, Strips, Strips]:
        """Points of contact with triangles, and with the sides and corners that these share."""
        return self.loops.strips(self.x, faced)
