"""Lines and triangles near each other, found anew only when nodes have moved."""

from __future__ import annotations

from typing import Final

import numpy as np

from ...arrays import FloatArray, IntArray, union
from ...frozen import frozen
from ..drivers.loops import Loops, Near
from ..nearby.faces import Faces

# In units of the distance at which things touch: how far the search goes beyond it at least, and how far
# beyond it distances are asked for.
_SKIN: Final = 0.5
MARGIN: Final = 0.1
# Of what moved between two searches, the next one goes so many times farther; no farther than so many times
# the thickness, or half of a line.
_AHEAD: Final = 4.0
_HALF: Final = 0.5


@frozen
class Candidates:
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
    def of(cls, faces: Faces, keys: IntArray) -> Candidates:
        """Pairs by their keys."""
        pairs = faces.pairs(keys)
        return cls(keys, faces.nodes(pairs), faces.reach(pairs))

    def some(self, kept: IntArray) -> Candidates:
        """Those of some indices."""
        return Candidates(self.keys[kept], self.nodes[kept], self.reach[kept])


@frozen
class Seen:
    """Pairs that are near at some places of the nodes.

    Attributes:
        x: The nodes [m], shape (N, 3).
        keys: Of the pairs, ascending, shape (P,).
        reach: Distance at which they touch [m], shape (P,).
        near: What a look told of them; what it kept are candidates.
    """

    x: FloatArray
    keys: IntArray
    reach: FloatArray
    near: Near

    def nearer(self, limit: FloatArray) -> IntArray:
        """Which of the pairs are nearer than limits (P,) [m]."""
        return self.nearer_of(np.flatnonzero(self.near.bound < limit), limit)

    def nearer_of(self, some: IntArray, limit: FloatArray) -> IntArray:
        """Which of some of the pairs are nearer than limits of all (P,) [m]."""
        return some[self.near.distances(some) < limit[some]]

    def within(self, margin: float) -> IntArray:
        """Keys of those within reach and a margin in units of it."""
        return self.keys[self.nearer((1.0 + margin) * self.reach)]


class FaceSearch:
    """Finds pairs by distance; what it finds does not depend on when it last looked around.

    Attributes:
        faces: Who may touch.
        loops: What is done to many pairs at once.
        candidates: Pairs that may be near.
        skin: How far beyond touching they were searched for [m].
    """

    def __init__(self, faces: Faces, loops: Loops) -> None:
        self.faces, self.loops = faces, loops
        self._thick = 2.0 * max(
            float(faces.lines.radii[faces.numbers].max(initial=0.0)), float(faces.surface.halves.max())
        )
        self._least = min(
            float(faces.own_reach[faces.numbers].min(initial=np.inf)),
            float(faces.lines.radii[faces.numbers].min(initial=np.inf) + faces.surface.halves.min()),
        )
        self._most = max(_AHEAD * self._thick, _HALF * float(np.median(faces.lines.lengths[faces.numbers])))
        self._used = union(faces.lines.nodes[faces.numbers], faces.surface.nodes)
        self.candidates = Candidates.of(faces, np.empty(0, dtype=np.int64))
        self.skin = 0.0
        self._searched: FloatArray | None = None
        self._seen: Seen | None = None
        self._way: tuple[FloatArray, FloatArray, Candidates, FloatArray] | None = None

    def look(self, x: FloatArray) -> Seen:
        """What is near; kept until other places are asked for."""
        if self._seen is None or not np.array_equal(self._seen.x, x):
            self._search(x)
            x = x.copy()
            every = self.candidates
            near = self.loops.look(x, every.nodes, (1.0 + MARGIN) * every.reach)
            self._seen = Seen(x, every.keys[near.kept], every.reach[near.kept], near)
        return self._seen

    def closer(self, x: FloatArray, share: float) -> IntArray:
        """Keys of pairs that are nearer than a share of the distance at which they touch, 1.1 at most."""
        seen = self.look(x)
        return seen.keys[seen.nearer(share * seen.reach)]

    def coming(self, x0: FloatArray, x1: FloatArray, share: float) -> IntArray:
        """Keys of pairs that may come nearer than that on a straight way, ascending."""
        seen = self.look(x0)
        moved = 2.0 * self._farthest(x1 - x0)
        # what was not seen is farther away than its reach and the margin
        if moved < (1.0 + MARGIN - share) * self._least:
            return seen.keys[seen.nearer(share * seen.reach + moved)]
        found, apart = self._on_way(x0, x1, moved)
        return found.keys[apart < share * found.reach]

    def reaching(self, x0: FloatArray, x1: FloatArray) -> Candidates:
        """Pairs that may come within reach of each other on a straight way."""
        found, apart = self._on_way(x0, x1, 2.0 * self._farthest(x1 - x0))
        return found.some(np.flatnonzero(apart < found.reach))

    def find(self, x: FloatArray, more: float) -> Candidates:
        """Pairs within reach and ``more`` [m]."""
        every = self.faces
        keys = every.allowed(self.loops.near_boxes(*every.boxes(x, more)))
        return Candidates.of(every, keys)

    def _on_way(self, x0: FloatArray, x1: FloatArray, moved: float) -> tuple[Candidates, FloatArray]:
        """Pairs of which some come near, and no more than their distances on the way; kept as a look is."""
        if self._way is None or not (np.array_equal(self._way[0], x0) and np.array_equal(self._way[1], x1)):
            self._search(x0, moved)
            found = self.candidates
            if moved + 2.0 * self._strayed(x0) > self.skin:
                found = self.find(x0, moved)
            apart = self.loops.boxes_apart(x0, x1, found.nodes)
            self._way = x0.copy(), x1.copy(), found, apart
        return self._way[2], self._way[3]

    def _search(self, x: FloatArray, ahead: float = 0.0) -> None:
        """Search anew if nodes have moved, or will move ahead [m], so far that pairs may be missing."""
        ahead = min(ahead, self._most)
        room = max(MARGIN * self._thick, ahead)
        strayed = 0.0 if self._searched is None else self._strayed(x)
        if self._searched is not None and 2.0 * strayed <= self.skin - room:
            return
        self.skin = _SKIN * self._thick + max(ahead, min(_AHEAD * strayed, self._most))
        self._searched = x.copy()
        self._seen = self._way = None
        self.candidates = self.find(x, self.skin)

    def _strayed(self, x: FloatArray) -> float:
        """How far a node has moved since the last search [m]."""
        assert self._searched is not None
        return self._farthest(x - self._searched)

    def _farthest(self, way: FloatArray) -> float:
        """Longest of the ways of nodes that matter (N, 3) [m]."""
        own = way[self._used]
        return float(np.sqrt((own * own).sum(axis=1).max(initial=0.0)))
