"""Finds lines that touch shells."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np

from ..arrays import FloatArray, IntArray
from ..model.term import Memory
from .advance import longest_way
from .candidates import among
from .faces import Faces
from .facing import Facing
from .loops import Loops, Near
from .placed import Placed
from .source import Depths
from .stencils import Stencils
from .stiffness import impact_force
from .touching import Touching

LISTED: Final = "contact.faces"

# In units of the distance at which things touch: how far the search goes beyond it at least, and how far the
# pairs that are given places in the matrix, once one that touches has none.
_SKIN, _MARGIN = 0.5, 0.1
# Of what moved between two searches, the next one goes so many times farther.
_AHEAD = 4.0
# Motion within a step may bring lines to half the distance at which they touch, or half as near as they are.
_NEAREST = 0.5
# A line that comes with a hair's breadth only would ask for any stiffness; no impact asks for more than this.
_LARGEST = 1e9


@dataclass(frozen=True, slots=True)
class _Candidates:
    """Pairs that may be near.

    Attributes:
        keys: Of the pairs, ascending, shape (P,).
        nodes: Of their lines and triangles, shape (P, 5).
        reach: Distance at which they touch [m], shape (P,).
    """

    keys: IntArray
    nodes: IntArray
    reach: FloatArray

    @classmethod
    def of(cls, faces: Faces, keys: IntArray) -> _Candidates:
        """Pairs by their keys."""
        pairs = faces.pairs(keys)
        return cls(keys, faces.nodes(pairs), faces.reach(pairs))

    def some(self, kept: IntArray) -> _Candidates:
        """Those of some indices."""
        return _Candidates(self.keys[kept], self.nodes[kept], self.reach[kept])


@dataclass(frozen=True, slots=True)
class _Seen:
    """Pairs that are near at some places of the nodes.

    Attributes:
        x: The nodes [m], shape (N, 3).
        keys: Of the pairs, ascending, shape (P,).
        reach: Distance at which they touch [m], shape (P,).
        near: What was measured of them.
    """

    x: FloatArray
    keys: IntArray
    reach: FloatArray
    near: Near

    @property
    def distance(self) -> FloatArray:
        """Of the pairs [m], shape (P,)."""
        return self.near.distance

    def within(self, margin: float) -> IntArray:
        """Keys of those within reach and a margin in units of it."""
        return self.keys[self.distance < (1.0 + margin) * self.reach]


class SurfacePairs:
    """Finds lines that touch triangles of shells; implements :class:`.source.Source`."""

    steady = True

    def __init__(self, faces: Faces, loops: Loops) -> None:
        """Find none yet.

        Args:
            faces: Who may touch.
            loops: What is done to many pairs at once.
        """
        self._all, self._loops = faces, loops
        self._searched: FloatArray | None = None
        self._candidates = _Candidates.of(faces, np.empty(0, dtype=np.int64))
        self._skin = 0.0
        self._thick = 2.0 * max(
            float(faces.lines.radii[faces.numbers].max(initial=0.0)), float(faces.surface.halves.max())
        )
        self._used = np.union1d(faces.lines.nodes[faces.numbers], faces.surface.nodes)
        self._seen: _Seen | None = None
        self._placed = Placed(LISTED, self._lay_out)

    def recall(self, memory: Memory) -> None:
        """Take up the pairs that have places."""
        self._placed.recall(memory)

    def memory(self, x: FloatArray) -> Memory:
        """The pairs that have places; if too many of them are far apart, those that are near."""
        return self._placed.memory(self._look(x).within(_MARGIN))

    def detect(self, x: FloatArray) -> bool:
        """Give places to all pairs nearby if one that touches has none."""
        seen = self._look(x)
        return self._placed.detect(seen.within(0.0), lambda: seen.within(_MARGIN))

    def touching(self, x: FloatArray, v: FloatArray, t: float, factor: float) -> Iterator[Touching]:
        """Lines against triangles, and what sides and corners of these count too much."""
        facing = self._facing
        seen = self._look(x)
        placed = facing.keys
        which = np.flatnonzero((seen.distance < seen.reach) & among(seen.keys, placed))
        rows = np.searchsorted(placed, seen.keys[which])
        scale = factor * self._scale[rows]
        for kind, points, owner in facing.points(seen.near, which, rows, seen.reach[which], scale):
            stencils = self._stencils[kind]
            yield Touching(
                kind=kind,
                stencils=stencils,
                points=points,
                friction=self._friction[owner],
                moving=partial(stencils.relative, points, v),
                label=self._labels[owner],
                sign=self._signs[owner],
            )

    def velocities(self, touching: Touching, x: FloatArray, v: FloatArray, t: float) -> FloatArray:
        """Relative velocities at points of contact [m/s], shape (3, K)."""
        return touching.stencils.relative(touching.points, v)

    @property
    def stencils(self) -> tuple[Stencils, ...]:
        """Nodes of lines with triangles, sides and corners."""
        return self._stencils

    def depths(self, x: FloatArray, t: float) -> Depths:
        """Penetration of each line into each body, its deepest."""
        every, seen = self._all, self._look(x)
        near = np.flatnonzero(seen.distance < seen.reach)
        pairs = every.pairs(seen.keys[near])
        shares = (seen.reach - seen.distance)[near] / every.thickness(pairs)
        labels = every.labels[every.bodies(pairs)]
        both, of = np.unique(np.column_stack((pairs[:, 0], labels)), axis=0, return_inverse=True)
        deepest = np.zeros(len(both))
        np.maximum.at(deepest, of.reshape(-1), shares)
        return Depths(both[:, 0], deepest, both[:, 1])

    def needed(self, x: FloatArray, ahead: FloatArray, t: float, dt: float, tolerance: float) -> float:
        """Factor of the stiffness that stops what comes.

        Each line must be stopped by all that it faces together.
        """
        every = self._all
        found = self._reaching(x, ahead)
        keys, nodes, pairs = found.keys, found.nodes, every.pairs(found.keys)
        later = self._loops.face_distances(ahead, nodes)
        coming = np.flatnonzero(later < found.reach)
        if not len(coming):
            return 0.0
        lines, of = np.unique(pairs[coming, 0], return_inverse=True)
        fellows = np.flatnonzero(np.isin(pairs[:, 0], lines))
        near = self._loops.look(x, nodes[fellows], np.full(len(fellows), np.inf))
        now = np.zeros(len(pairs))
        now[fellows] = near.distance
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
        for _, points, owner in facing.points(near, inside, rows, reach[inside], scale):
            np.add.at(held, facing.pairs[owner, 0], points.load)
        return float((force / np.maximum(held[lines], force / _LARGEST + np.finfo(float).tiny)).max())

    def longest_step(self, x0: FloatArray, x1: FloatArray, t0: float, t1: float) -> float:
        """Part of the way on which no line passes through a triangle."""
        found, way = self._reaching(x0, x1), x1 - x0
        if not len(found.keys):
            return 1.0

        def gap_at(part: float, which: IntArray) -> FloatArray:
            return self._loops.face_distances(x0 + part * way, found.nodes[which])

        return longest_way(gap_at, self._loops.closing(way, found.nodes), _NEAREST * found.reach)

    def _reaching(self, x0: FloatArray, x1: FloatArray) -> _Candidates:
        """Pairs that may come within reach of each other on a straight way."""
        moved = _farthest((x1 - x0)[self._used])
        self._search(x0)
        found = self._candidates
        if 2.0 * moved + 2.0 * self._strayed(x0) > self._skin:
            found = self._find(x0, 2.0 * moved)
        return found.some(np.flatnonzero(self._loops.boxes_apart(x0, x1, found.nodes) < found.reach))

    def _look(self, x: FloatArray) -> _Seen:
        """What is near; kept until other places are asked for."""
        if self._seen is None or not np.array_equal(self._seen.x, x):
            self._search(x)
            x = x.copy()
            every = self._candidates
            near = self._loops.look(x, every.nodes, (1.0 + _MARGIN) * every.reach)
            self._seen = _Seen(x, every.keys[near.kept], every.reach[near.kept], near)
        return self._seen

    def _find(self, x: FloatArray, more: float) -> _Candidates:
        """Pairs within reach and ``more`` [m]."""
        every = self._all
        return _Candidates.of(every, every.allowed(self._loops.near_boxes(*every.boxes(x, more))))

    def _search(self, x: FloatArray) -> None:
        """Search anew if nodes have moved so far that pairs may be missing."""
        spare = self._skin - _MARGIN * self._thick
        strayed = 0.0 if self._searched is None else self._strayed(x)
        if self._searched is not None and 2.0 * strayed <= spare:
            return
        self._skin = _SKIN * self._thick + min(_AHEAD * strayed, _AHEAD * self._thick)
        self._searched = x.copy()
        self._candidates = self._find(x, self._skin)

    def _strayed(self, x: FloatArray) -> float:
        """How far a node has moved since the last search [m]."""
        assert self._searched is not None
        return _farthest((x - self._searched)[self._used])

    def _lay_out(self, keys: IntArray) -> None:
        """What pairs with these keys touch with."""
        self._facing = Facing.of(self._all, keys)
        every, junctions = self._all, self._facing.junctions
        self._scale = every.factor(self._facing.pairs)
        line, face = every.bodies(self._facing.pairs)
        self._friction, self._labels = every.friction[line, face], every.labels[line, face]
        self._signs = every.signs[line, face]
        kinds = (self._facing.nodes, junctions.sides, junctions.corners)
        self._stencils = tuple(Stencils(self._all.map, nodes) for nodes in kinds)


def _farthest(way: FloatArray) -> float:
    return float(np.sqrt((way * way).sum(axis=1).max(initial=0.0)))
