"""Finds lines that touch shells."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Final

import numpy as np

from ...arrays import FloatArray, IntArray
from ...model.term import Memory
from ..gather.source import Depths
from ..gather.stencils import Stencils
from ..gather.touching import Touching
from ..law.between import Between
from ..law.stiffness import asked_for, impact_force
from ..nearby.candidates import among
from ..nearby.placed import Placed
from ..points.strips import Strips
from .facing import Facing
from .surface_search import MARGIN, Candidates, FaceSearch, Seen

LISTED: Final = "contact.faces"

# Motion within a step may bring lines to half the distance at which they touch, or half as near as they are.
_NEAREST = 0.5


class SurfacePairs:
    """Finds lines that touch triangles of shells; implements :class:`.source.Source`."""

    steady = True
    _lent: dict[int, tuple[IntArray, Between]]

    def __init__(self, search: FaceSearch) -> None:
        """Find none yet."""
        self._all, self._loops, self._search = search.faces, search.loops, search
        self._known: tuple[IntArray, IntArray, IntArray] | None = None
        self._placed = Placed(LISTED, self._lay_out)

    def recall(self, memory: Memory) -> None:
        """Take up the pairs that have places."""
        self._placed.recall(memory)

    def memory(self, x: FloatArray) -> Memory:
        """The pairs that have places; if too many of them are far apart, those that are near."""
        return self._placed.memory(self._search.look(x).within(MARGIN))

    def detect(self, x: FloatArray) -> bool:
        """Give places to all pairs nearby if one that touches has none."""
        seen = self._search.look(x)
        without = np.flatnonzero((seen.near.bound < seen.reach) & (self._rows(seen) < 0))
        touching = seen.nearer_of(without, seen.reach)
        return self._placed.detect(seen.keys[touching], lambda: seen.within(MARGIN))

    def touching(self, x: FloatArray, v: FloatArray, t: float, factor: float) -> Iterator[Touching]:
        """Lines against triangles, and what sides and corners of these count too much."""
        facing = self._facing
        seen = self._search.look(x)
        rows = self._rows(seen)
        which = np.flatnonzero((seen.near.bound < seen.reach) & (rows >= 0))
        rows = rows[which]
        for kind, strips, of in facing.strips(seen.near, which, rows, self._reach, factor * self._scale):
            stencils = self._stencils[kind]
            yield Touching(
                kind=kind,
                stencils=stencils,
                strips=strips,
                between=self._shared(kind, of),
                moving=partial(_relative, stencils, strips, v),
            )

    def velocities(self, touching: Touching, x: FloatArray, v: FloatArray, t: float) -> FloatArray:
        """Relative velocities at points of contact [m/s], shape (3, K)."""
        return touching.stencils.relative(touching.points, v)

    @property
    def stencils(self) -> tuple[Stencils, ...]:
        """Nodes of lines with triangles, sides and corners."""
        return self._stencils

    @property
    def placed(self) -> IntArray:
        """Numbers of lines and triangles of all pairs that have places, shape (P, 2)."""
        return self._facing.pairs

    def faced_nodes(self, faced: IntArray) -> IntArray:
        """Corners of triangles, shape (K, 3)."""
        return self._all.surface.nodes[faced]

    def line_nodes(self, lines: IntArray) -> IntArray:
        """Nodes of lines, shape (K, 2)."""
        return self._all.lines.nodes[lines]

    def owners(self, kind: int) -> IntArray:
        """A pair that each item of a kind that touches belongs to, by its row in ``placed``, shape (S,)."""
        return self._facing.owners(kind)

    def depths(self, x: FloatArray, t: float) -> Depths:
        """Penetration of each line into each body, its deepest."""
        every, seen = self._all, self._search.look(x)
        near = seen.nearer(seen.reach)
        pairs = every.pairs(seen.keys[near])
        shares = (seen.reach[near] - seen.near.distances(near)) / every.thickness(pairs)
        labels = every.labels[every.bodies(pairs)]
        both, of = np.unique(np.column_stack((pairs[:, 0], labels)), axis=0, return_inverse=True)
        deepest = np.zeros(len(both))
        np.maximum.at(deepest, of.reshape(-1), shares)
        return Depths(both[:, 0], deepest, both[:, 1])

    def needed(self, x: FloatArray, ahead: FloatArray, t: float, dt: float, tolerance: float) -> float:
        """Factor of the stiffness that stops what comes.

        All lines of a body must be stopped by all that they face together.
        """
        every = self._all
        found = self._search.reaching(x, ahead)
        keys, nodes, pairs = found.keys, found.nodes, every.pairs(found.keys)
        later = self._loops.face_distances(ahead, nodes)
        coming = np.flatnonzero(later < found.reach)
        if not len(coming):
            return 0.0
        lines, of = np.unique(pairs[coming, 0], return_inverse=True)
        fellows = np.flatnonzero(np.isin(pairs[:, 0], lines))
        near = self._loops.look(x, nodes[fellows], np.full(len(fellows), np.inf))
        now = np.zeros(len(pairs))
        now[fellows] = near.distances(np.arange(len(fellows)))
        mass, other = every.masses[pairs[coming, 0]], every.surface.masses[pairs[coming, 1]]
        depth = tolerance * every.thickness(pairs)
        approach = np.maximum(now - later, 0.0)[coming] / dt
        force, nearest = np.zeros(len(lines)), np.full(len(lines), np.inf)
        np.maximum.at(force, of, impact_force(mass * other / (mass + other), approach, depth[coming], dt))
        np.minimum.at(nearest, of, (now + depth)[coming])
        # of lines so thick that they are as deep as they may be
        reach = nearest[np.searchsorted(lines, pairs[fellows, 0])]
        inside = np.flatnonzero(now[fellows] < reach)
        facing = Facing.of(every, keys[fellows[inside]])
        rows = np.arange(len(inside))
        held = np.zeros(len(every.lines.nodes))
        scale = every.factor(facing.pairs)
        for _, strips, owner in facing.strips(near, inside, rows, reach[inside], scale):
            points = strips.points
            np.add.at(held, facing.pairs[owner[points.item], 0], points.load)
        # where a side takes off all that a line faces, it holds what it would if it stood on its end
        upright = every.factor(pairs) * depth**2 / every.lines.lengths[pairs[:, 0]]
        least = np.full(len(lines), np.inf)
        np.minimum.at(least, of, upright[coming])
        return asked_for(force, np.maximum(held[lines], least), every.lines.bodies[lines])

    def longest_step(self, x0: FloatArray, x1: FloatArray, t0: float, t1: float) -> float:
        """Part of the way on which no line passes through a triangle."""
        keys = self._search.coming(x0, x1, _NEAREST)
        if not len(keys):
            return 1.0
        found = Candidates.of(self._all, keys)
        return self._loops.safe_way(x0, x1 - x0, found.nodes, np.zeros(len(keys)), _NEAREST * found.reach)

    def _rows(self, seen: Seen) -> IntArray:
        """Which of the pairs that have places those seen are, -1 if none, shape (P,)."""
        candidates, placed = self._search.candidates.keys, self._placed.keys
        if self._known is None or self._known[0] is not candidates or self._known[1] is not placed:
            rows = np.where(among(candidates, placed), np.searchsorted(placed, candidates), -1)
            self._known = candidates, placed, rows
        return np.asarray(self._known[2][seen.near.kept])

    def _shared(self, kind: int, of: IntArray) -> Between:
        """What the bodies of the items of a kind are to each other, which belong to some pairs."""
        if kind not in self._lent or self._lent[kind][0] is not of:
            self._lent[kind] = of, self._between.some(of)
        return self._lent[kind][1]

    def _lay_out(self, keys: IntArray) -> None:
        """What pairs with these keys touch with."""
        self._facing = Facing.of(self._all, keys)
        every, junctions = self._all, self._facing.junctions
        pairs = self._facing.pairs
        self._reach, self._scale = every.reach(pairs), every.factor(pairs)
        self._between = every.between(*every.bodies(pairs))
        self._lent = {}
        kinds = (self._facing.nodes, junctions.sides, junctions.corners)
        self._stencils = tuple(Stencils(self._all.map, nodes, squares=True) for nodes in kinds)


def _relative(stencils: Stencils, strips: Strips, v: FloatArray) -> FloatArray:
    """Velocities of lines against what they face at points of contact [m/s], shape (3, K)."""
    return stencils.relative(strips.points, v)
