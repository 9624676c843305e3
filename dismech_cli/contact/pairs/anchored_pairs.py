"""Lines that stick to what they touch without creep: friction grows with the way from an anchor.

What holds on obstacles, see :mod:`..obstacles.anchored_wall`, holds between bodies: a line drags an anchor
along all that it faces in one place. It is kept for each pair of a line and a segment or triangle, and handed
on to pairs beside those that touch, so that nothing is forgotten where contact comes to the next edge.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Protocol

import numpy as np

from ...arrays import FloatArray, IntArray, without
from ...model.term import Memory
from ..gather.source import Depths, Source
from ..gather.stencils import Stencils
from ..gather.touching import Touching
from ..law.anchors import Anchors, Moved, cut, turned


class Paired(Source, Protocol):
    """What finds lines of bodies with what they face of bodies."""

    @property
    def placed(self) -> IntArray:
        """Numbers of lines and what they face, of all pairs that have places, shape (P, 2)."""

    def faced_nodes(self, faced: IntArray) -> IntArray:
        """Nodes of what is faced, by its number, shape (K, n)."""

    def line_nodes(self, lines: IntArray) -> IntArray:
        """Nodes of lines, shape (K, 2)."""

    def owners(self, kind: int) -> IntArray:
        """A pair that each item of a kind that touches belongs to, by its row in ``placed``, shape (S,)."""


class AnchoredPairs:
    """Implements :class:`.source.Source`; slips are ways [m] in place of velocities.

    What a step leaves to the next are the ways of pairs, and the places of all nodes from which they go on.
    """

    def __init__(self, pairs: Paired, name: str, length: float) -> None:
        """Begin without anchors.

        Args:
            pairs: What touches.
            name: Under which checkpoints have the anchors.
            length: Way on which friction becomes full [m].
        """
        self._pairs, self._length = pairs, length
        self._name, self._from = f"contact.anchored.{name}", f"contact.anchored_from.{name}"
        self._anchors = Anchors.none()
        self._start: FloatArray | None = None

    def recall(self, memory: Memory) -> None:
        """Take up anchors and places; at the start of a run there are none."""
        self._pairs.recall(memory)
        kept = memory.get(self._name)
        self._anchors = Anchors.none() if kept is None else Anchors.unpacked(kept)
        self._start = memory.get(self._from)

    def memory(self, x: FloatArray) -> Memory:
        """Those at the end of a step."""
        return {
            **self._pairs.memory(x),
            self._name: self._after(x).packed(),
            self._from: x.copy(),
        }

    def detect(self, x: FloatArray) -> bool:
        """Find the items at a trial point."""
        return self._pairs.detect(x)

    def touching(self, x: FloatArray, v: FloatArray, t: float, factor: float) -> Iterator[Touching]:
        """Points of contact, with the ways from their anchors."""
        for touching in self._pairs.touching(x, v, t, factor):
            owners = self._pairs.owners(touching.kind)
            yield replace(touching, moving=partial(self._ways, touching, owners, x))

    def velocities(self, touching: Touching, x: FloatArray, v: FloatArray, t: float) -> FloatArray:
        """Relative velocities at points of contact [m/s], shape (3, K)."""
        return self._pairs.velocities(touching, x, v, t)

    @property
    def stencils(self) -> tuple[Stencils, ...]:
        """Nodes of all items that have places in the matrix, by kind."""
        return self._pairs.stencils

    @property
    def steady(self) -> bool:
        """Whether the energy of a shape is the same at all times."""
        return self._pairs.steady

    def depths(self, x: FloatArray, t: float) -> Depths:
        """How deep what touches is."""
        return self._pairs.depths(x, t)

    def needed(self, x: FloatArray, ahead: FloatArray, t: float, dt: float, tolerance: float) -> float:
        """Factor of the stiffness that stops in time what comes in the next step."""
        return self._pairs.needed(x, ahead, t, dt, tolerance)

    def longest_step(self, x0: FloatArray, x1: FloatArray, t0: float, t1: float) -> float:
        """Part of the way on which nothing passes through anything."""
        return self._pairs.longest_step(x0, x1, t0, t1)

    def _ways(self, touching: Touching, owners: IntArray, x: FloatArray) -> FloatArray:
        """From the anchors, at points of contact [m], shape (3, K)."""
        keys = self._keys(self._pairs.placed[owners[touching.points.item]])
        ends, _ = self._anchors.of(keys)
        s = touching.points.s[:, None]
        before = (1.0 - s) * ends[:, 0] + s * ends[:, 1]
        return np.asarray(before.T + self._moved(touching, x))

    def _moved(self, touching: Touching, x: FloatArray) -> FloatArray:
        """Ways in this step at points of contact, shape (3, K)."""
        if self._start is None:
            self._start = x
        return touching.stencils.relative(touching.points, x - self._start)

    def _keys(self, pairs: IntArray) -> IntArray:
        return (pairs[:, 0] << 32) + pairs[:, 1]

    def _after(self, x: FloatArray) -> Anchors:
        """Anchors at the end of a step, of which all touching pairs and those beside them have one."""
        owners, parts = [np.empty(0, dtype=np.int64)], []
        for touching in self._pairs.touching(x, np.zeros_like(x), 0.0, 1.0):
            points = touching.points
            owners.append(self._pairs.owners(touching.kind)[points.item])
            parts.append((points.s, points.load, points.normal.T, self._moved(touching, x).T))
        if not parts:
            return Anchors.none()
        owner = np.concatenate(owners)
        s, load, normal, way = (np.concatenate(part) for part in zip(*parts, strict=True))
        rows, of = np.unique(owner, return_inverse=True)
        placed = self._pairs.placed
        groups = self._places(placed[rows])
        ways, known = self._anchors.of(self._keys(placed[owner]))
        group = groups[of]
        # what came to a place in this step goes by what was there
        strange = np.ones(len(owner), dtype=np.bool_)
        strange[known] = False
        ways[strange] = _mean_of_known(ways, group, known)[group[strange]]
        ends = Moved(group, s, load, normal, way).ends(ways)
        lines = np.zeros(len(ends), dtype=np.int64)
        lines[groups] = placed[rows, 0]
        ends = cut(self._turned(lines, ends, x), self._length)
        return self._handed_on(rows, ends[groups])

    def _places(self, pairs: IntArray) -> IntArray:
        """Numbers of the places where lines touch something: of what they face that hangs together."""
        from scipy.sparse import coo_matrix
        from scipy.sparse.csgraph import connected_components

        nodes = self._pairs.faced_nodes(pairs[:, 1])
        _, number = np.unique((pairs[:, :1] << 32) + nodes, return_inverse=True)
        count, rows = len(pairs), np.repeat(np.arange(len(pairs)), nodes.shape[1])
        size = count + int(number.max()) + 1
        graph = coo_matrix((np.ones(len(rows)), (rows, count + number.reshape(-1))), shape=(size, size))
        _, found = connected_components(graph, directed=False)
        _, places = np.unique(found[:count], return_inverse=True)
        return np.asarray(places.reshape(-1))

    def _turned(self, lines: IntArray, ends: FloatArray, x: FloatArray) -> FloatArray:
        """Ways carried along with the lines, as they turned in the step."""
        nodes = self._pairs.line_nodes(lines)
        assert self._start is not None
        before, after = (_directions(places[nodes]) for places in (self._start, x))
        return turned(ends, before, after)

    def _handed_on(self, rows: IntArray, ways: FloatArray) -> Anchors:
        """Anchors of some of the pairs that have places, and of all pairs beside them."""
        placed = self._pairs.placed
        others = without(np.arange(len(placed)), rows)
        faced, line = self._pairs.faced_nodes(placed[:, 1]), self._pairs.line_nodes(placed[:, 0])
        found, missing = [(rows, ways)], others
        # of the same line first; of the line beside it, which has an end in common, as far as its middle is
        even = np.repeat(ways.mean(axis=1, keepdims=True), 2, axis=1)
        for own, given in ((placed[:, :1], ways), (line, even)):
            marks = ((own[:, :, None] << 32) + faced[:, None]).reshape(len(placed), -1)
            have = np.repeat(np.arange(len(rows)), marks.shape[1])
            order = np.argsort(marks[rows].reshape(-1), kind="stable")
            marked = marks[rows].reshape(-1)[order]
            place = np.minimum(np.searchsorted(marked, marks[missing]), len(marked) - 1)
            hit = marked[place] == marks[missing]
            some = hit.any(axis=1)
            first = place[np.arange(len(missing)), hit.argmax(axis=1)][some]
            found.append((missing[some], given[have[order[first]]]))
            missing = missing[~some]
        every = np.concatenate([which for which, _ in found])
        keys = self._keys(placed[every])
        order = np.argsort(keys)
        return Anchors(keys[order], np.concatenate([way for _, way in found])[order])


def _directions(ends: FloatArray) -> FloatArray:
    """Unit vectors along lines with ends (K, 2, 3), shape (K, 3)."""
    along = ends[:, 1] - ends[:, 0]
    return np.asarray(along / np.linalg.norm(along, axis=1, keepdims=True))


def _mean_of_known(ways: FloatArray, group: IntArray, known: IntArray) -> FloatArray:
    """Means of the ways (K, 2, 3) that are known over their groups, zero where there are none, (G, 2, 3)."""
    count = int(group.max()) + 1
    sums, times = np.zeros((count, 2, 3)), np.bincount(group[known], minlength=count)
    np.add.at(sums, group[known], ways[known])
    return np.asarray(sums / np.maximum(times, 1)[:, None, None])
