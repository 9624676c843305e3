"""Lines of bodies that touch each other, either as a line against what the other is made of."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Final

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...model.term import Memory
from ..gather.source import Depths
from ..gather.stencils import Stencils
from ..gather.touching import Remake, Touching, at_points
from ..law.between import Between
from ..law.levels import from_here_on, of_next, shared
from ..law.stiffness import asked_for, impact_force
from ..nearby.candidates import among
from ..nearby.placed import Placed
from ..points.points import Points
from .search import MARGIN, Search

PAIRS: Final = "contact.pairs"

# Motion within a step may bring lines to half the distance at which they touch, or half as near as they are.
_NEAREST = 0.5


@frozen
class Rows:
    """Items of some pairs: either line against the other, and against vertices within that.

    Attributes:
        directed: Line and what it faces, shape (2 P, 2): all pairs one way, then the other.
        segments: Nodes of the line and of the segment, shape (2 P, 4).
        corners: Nodes of a line and a vertex where two segments that it faces may meet, once for each level
            of their reach, shape (V, 3).
        meeting: Of which corner each end of the segments is one side, -1 if of none, shape (2 P, 2).
        until: Where the levels of each corner end, which ascend, shape (V,).
    """

    directed: IntArray
    segments: IntArray
    corners: IntArray
    meeting: IntArray
    until: IntArray

    @classmethod
    def of(cls, nodes: IntArray, pairs: IntArray, reach: FloatArray) -> Rows:
        """Of pairs (P, 2) of lines with nodes (E, 2) that touch at some distances (P,) [m]."""
        directed = np.concatenate((pairs, pairs[:, ::-1]))
        segments = nodes[directed].reshape(-1, 4)
        count = int(nodes.max(initial=0)) + 1
        _, levels = np.unique(reach, return_inverse=True)
        meeting, first, until = shared(directed[:, :1] * count + segments[:, 2:], np.tile(levels, 2))
        of, end = np.divmod(first, 2)
        corners = np.column_stack((segments[of, :2], segments[of, 2 + end]))
        return cls(directed, segments, corners, meeting, until)


@frozen
class Active:
    """Rows of a kind that are looked at.

    Attributes:
        kind: Their kind.
        rows: The rows, ascending, shape (K,).
        between: What the bodies of each of all rows are to each other.
        reach: Distance at which they touch [m], shape (K,).
        scale: Stiffness times rest length times sign, at factor one [N/m], shape (K,).
        owners: A pair that each of all rows belongs to, shape (R,).
    """

    kind: int
    rows: IntArray
    between: Between
    reach: FloatArray
    scale: FloatArray
    owners: IntArray


class RodPairs:
    """Finds lines of bodies that touch; implements :class:`.source.Source`."""

    steady = True
    _last: IntArray
    _active: tuple[Active, ...]

    def __init__(self, search: Search) -> None:
        """Find none yet."""
        self._all, self._loops, self._search = search.neighbours, search.loops, search
        self._placed = Placed(PAIRS, self._lay_out)

    def recall(self, memory: Memory) -> None:
        """Take up the pairs that have places."""
        self._placed.recall(memory)

    def memory(self, x: FloatArray) -> Memory:
        """The pairs that have places; if too many of them are far apart, those that are near."""
        return self._placed.memory(self._search.within(x, MARGIN))

    def detect(self, x: FloatArray) -> bool:
        """Give places to all pairs nearby if one that touches has none."""
        return self._placed.detect(self._search.within(x, 0.0), lambda: self._search.within(x, MARGIN))

    def touching(self, x: FloatArray, v: FloatArray, t: float, factor: float) -> Iterator[Touching]:
        """Lines against segments, and what the vertices between these count too much."""
        near = self._search.within(x, 0.0)
        # they seldom change from one trial point to the next
        if not np.array_equal(near, self._last):
            active = np.flatnonzero(among(self._placed.keys, near))
            self._last, self._active = near, tuple(self._kinds(active)) if len(active) else ()
        for one in self._active:
            yield self._touching(one, factor, x, v)

    def _kinds(self, active: IntArray) -> Iterator[Active]:
        """Rows of some of the pairs that have places, and those of vertices that they count too often."""
        rows, count = self._rows, len(self._placed.keys)
        both = np.concatenate((active, active + count))
        reach, stiff = self._reach, self._stiff
        yield Active(0, both, self._between, reach[both], stiff[both], np.arange(2 * count))
        met = rows.meeting[both].reshape(-1)
        sides = from_here_on(np.bincount(met[met >= 0], minlength=len(rows.corners)), rows.until)
        over = np.maximum(sides - 1, 0)
        over = over - of_next(over, rows.until)
        corners = np.flatnonzero(over)
        if not len(corners):
            return
        # of the segments that meet there at a level any has its reach and stiffness: the last does
        last = np.zeros(len(rows.corners), dtype=np.int64)
        last[met[met >= 0]] = np.repeat(both, 2)[met >= 0]
        own = last[corners]
        scale = -over[corners] * stiff[own]
        yield Active(1, corners, self._between.some(last), reach[own], scale, last)

    def velocities(self, touching: Touching, x: FloatArray, v: FloatArray, t: float) -> FloatArray:
        """Relative velocities at points of contact [m/s], shape (3, K)."""
        return touching.stencils.relative(touching.points, v)

    @property
    def stencils(self) -> tuple[Stencils, ...]:
        """Nodes of lines and segments, and of lines and vertices."""
        return self._stencils

    @property
    def placed(self) -> IntArray:
        """Numbers of lines and of the segments that they face, of all pairs that have places, both ways."""
        return self._rows.directed

    def faced_nodes(self, faced: IntArray) -> IntArray:
        """Nodes of segments, shape (K, 2)."""
        return self._all.lines.nodes[faced]

    def line_nodes(self, lines: IntArray) -> IntArray:
        """Nodes of lines, shape (K, 2)."""
        return self._all.lines.nodes[lines]

    def owners(self, kind: int) -> IntArray:
        """A pair that each item of a kind that touches belongs to, by its row in ``placed``, shape (S,)."""
        return self._active[kind].owners

    def depths(self, x: FloatArray, t: float) -> Depths:
        """Penetration of pairs of lines, told of the first."""
        pairs = self._all.pairs(self._search.within(x, 0.0))
        lines, reach = self._all.lines, self._all.reach(pairs)
        depth = reach - self._loops.segment_distances(x, self._all.nodes(pairs))
        shares = depth / lines.radii[pairs].sum(axis=1)
        return Depths(
            pairs[:, 0], shares, self._all.labels[lines.bodies[pairs[:, 0]], lines.bodies[pairs[:, 1]]]
        )

    def needed(self, x: FloatArray, ahead: FloatArray, t: float, dt: float, tolerance: float) -> float:
        """Factor of the stiffness that stops what comes."""
        every, lines = self._all, self._all.lines
        pairs = self._search.reaching(x, ahead)
        reach, later = every.reach(pairs), self._loops.segment_distances(ahead, every.nodes(pairs))
        coming = np.flatnonzero(later < reach)
        if not len(coming):
            return 0.0
        pairs, later = pairs[coming], later[coming]
        now = self._loops.segment_distances(x, every.nodes(pairs))
        depth = tolerance * lines.radii[pairs].sum(axis=1)
        mass = lines.masses[pairs]
        reduced = mass.prod(axis=1) / mass.sum(axis=1)
        force = impact_force(reduced, np.maximum(now - later, 0.0) / dt, depth, dt)
        directed = np.concatenate((pairs, pairs[:, ::-1]))
        # of lines so thick that they are as deep as they may be
        reach = np.tile(now + depth, 2)
        points = self._loops.segment_strips(
            x, every.nodes(directed), np.arange(len(directed)), reach, every.factors(directed)
        ).points
        held = np.zeros(len(pairs))
        np.add.at(held, points.item % len(pairs), points.load)
        first, second = lines.bodies[pairs].T
        return asked_for(force, held, every.labels[first, second])

    def longest_step(self, x0: FloatArray, x1: FloatArray, t0: float, t1: float) -> float:
        """Part of the way on which no lines pass through each other."""
        every = self._all
        keys = self._search.coming(x0, x1, _NEAREST)
        if not len(keys):
            return 1.0
        pairs = every.pairs(keys)
        stop, nearest = np.zeros(len(pairs)), _NEAREST * every.reach(pairs)
        return self._loops.safe_way(x0, x1 - x0, every.nodes(pairs), stop, nearest)

    def _lay_out(self, keys: IntArray) -> None:
        """What pairs with these keys touch with."""
        every, lines = self._all, self._all.lines
        self._last, self._active = np.empty(0, dtype=np.int64), ()
        pairs = every.pairs(keys)
        touch = every.reach(pairs)
        self._rows = rows = Rows.of(lines.nodes, pairs, touch)
        self._stencils = (Stencils(every.map, rows.segments), Stencils(every.map, rows.corners))
        self._reach = np.tile(touch, 2)
        self._stiff = every.factors(rows.directed)
        first, second = lines.bodies[rows.directed].T
        self._between = every.between(first, second)

    def _touching(self, one: Active, factor: float, x: FloatArray, v: FloatArray) -> Touching:
        """Points of contact of some rows."""
        stencils = self._stencils[one.kind]
        find = (self._loops.segment_strips, self._loops.vertex_strips)[one.kind]
        strips = find(x, stencils.nodes, one.rows, one.reach, factor * one.scale)
        return Touching(
            kind=one.kind,
            stencils=stencils,
            strips=strips,
            between=one.between,
            moving=lambda: stencils.relative(strips.points, v),
            again=partial(self._again, one, factor),
        )

    def _again(self, one: Active, factor: float, items: IntArray) -> Remake:
        """What finds the points of some rows at other places."""
        own, size = np.searchsorted(one.rows, items), self._stencils[one.kind].nodes.shape[1]
        rows, nodes = np.arange(len(items)), np.arange(len(items) * size).reshape(-1, size)
        reach, scale = one.reach[own], factor * one.scale[own]
        find = (self._loops.segment_strips, self._loops.vertex_strips)[one.kind]

        def remake(x: FloatArray, v: FloatArray) -> tuple[Points, FloatArray]:
            points = find(np.ascontiguousarray(x).reshape(-1, 3), nodes, rows, reach, scale).points
            return points, at_points(points, v)

        return remake
