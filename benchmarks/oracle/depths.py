"""How deep bodies are in each other and in obstacles, from frames alone.

Distances of all pairs whose boxes overlap; nothing is shared with what finds contact or makes its forces.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Self

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from dismech_cli import Report
from dismech_cli.arrays import BoolArray, FloatArray, IntArray
from dismech_cli.contact.contact import Contact

from .distances import between_segments, to_triangle
from .passing import near
from .rigid import Rigid

# Pairs of a body that are nearer at rest than they are thick touch from this share on.
_AT_REST: Final = 0.999


@dataclass(frozen=True, slots=True)
class Lines:
    """Edges of rods and of shells.

    Attributes:
        ends: Shape (E, 2).
        body: Of each, shape (E,).
        radius: Half of the thickness [m], shape (E,).
    """

    ends: IntArray
    body: IntArray
    radius: FloatArray

    @classmethod
    def of(cls, report: Report) -> Self:
        """Those of a run: all edges of its rods and triangles."""
        t = report.composition.simulation.topology
        parts = [(t.edges, t.edge_body, t.edge_radius)]
        parts += [
            (t.triangles[:, pair], t.triangle_body, 0.5 * t.triangle_thickness)
            for pair in ([0, 1], [1, 2], [2, 0])
        ]
        ends, body, radius = (np.concatenate(part) for part in zip(*parts, strict=True))
        rows = np.column_stack((np.sort(ends, axis=1), body))
        every, of, counts = np.unique(rows, axis=0, return_inverse=True, return_counts=True)
        return cls(every[:, :2], every[:, 2], np.bincount(of.reshape(-1), weights=radius) / counts)


class Depths:
    """Measures how deep bodies are in each other, as shares of the thickness.

    Triangles of obstacles are a body of their own for each, with the nodes after those of all bodies.
    """

    def __init__(self, report: Report, stop: float) -> None:
        """Find who may touch whom, and what lies too near along a body for that.

        Args:
            report: The run.
            stop: Distance that must be kept, as a share of that at which surfaces touch.
        """
        t = report.composition.simulation.topology
        self._rigid, self._lines, self._stop = Rigid.of(report), Lines.of(report), stop
        self._rest = np.concatenate((t.rest_positions, self._rigid.vertices(0.0)))
        self._triangles = np.concatenate((t.triangles, self._rigid.triangles + len(t.rest_positions)))
        bodies = len(t.bodies)
        body, half = [t.triangle_body], [0.5 * t.triangle_thickness]
        for k, (_, shape, _) in enumerate(self._rigid.surfaces):
            count = len(shape.triangles)
            body.append(np.full(count, bodies + k))
            half.append(np.full(count, shape.half))
        self._body, self._half = np.concatenate(body), np.concatenate(half)
        self._touches = self._pairs(report, bodies)
        self._along = self._ways()

    def _pairs(self, report: Report, bodies: int) -> BoolArray:
        """Who may touch whom, shape (bodies, bodies and obstacles)."""
        names = report.composition.simulation.topology.bodies
        touches = np.zeros((bodies, bodies + len(self._rigid.surfaces)), dtype=np.bool_)
        for contact in report.composition.simulation.model.changing:
            assert isinstance(contact, Contact)
            for first, second in contact.pairs:
                if second in names:
                    i, j = names.index(first), names.index(second)
                    touches[i, j] = touches[j, i] = True
        for k, (*_, touching) in enumerate(self._rigid.surfaces):
            touches[list(touching), bodies + k] = True
        return touches

    def _ways(self) -> FloatArray:
        """Shortest ways between nodes along edges [m], up to where contact begins, shape (N, N)."""
        first, second = self._lines.ends.T
        lengths = np.linalg.norm(self._rest[first] - self._rest[second], axis=1)
        thick = max(self._lines.radius.max(initial=0.0), self._half.max(initial=0.0))
        count = len(self._rest)
        graph = coo_matrix((lengths, (first, second)), shape=(count, count)).tocsr()
        return np.asarray(dijkstra(graph, directed=False, limit=np.pi * thick))

    def deepest(self, t: float, positions: FloatArray) -> float:
        """Of all pairs at time ``t`` [s], nodes at ``positions`` (N, 3) [m]; below zero if apart."""
        x = np.concatenate((positions, self._rigid.vertices(t)))
        lines = self._lines
        gaps = self._rigid.gaps(t, x[lines.ends].transpose(1, 2, 0), lines.body)
        walls = (self._stop * lines.radius - gaps) / (2.0 * lines.radius)
        return max(float(walls.max(initial=-np.inf)), self._rods(x), self._shells(x))

    def _rods(self, x: FloatArray) -> float:
        lines = self._lines
        rods = np.flatnonzero(~np.isin(lines.body, self._body))
        boxes = _around(x, lines.ends[rods], lines.radius[rods])
        i, j = near(boxes, boxes) if len(rods) else np.empty((2, 0), dtype=np.int64)
        i, j = rods[i[i < j]], rods[j[i < j]]
        nodes = np.concatenate((lines.ends[i], lines.ends[j]), axis=1)
        reach = lines.radius[i] + lines.radius[j]
        return self._share(between_segments, x, nodes, reach, lines.body[i], lines.body[j], reach)

    def _shells(self, x: FloatArray) -> float:
        lines = self._lines
        if not len(self._triangles):
            return -np.inf
        i, j = near(_around(x, lines.ends, lines.radius), _around(x, self._triangles, self._half))
        nodes = np.concatenate((lines.ends[i], self._triangles[j]), axis=1)
        reach = lines.radius[i] + self._half[j]
        # in obstacles depth is a share of the thickness of the line
        rigid = self._body[j] >= len(self._touches)
        thick = np.where(rigid, 2.0 * lines.radius[i], reach)
        return self._share(to_triangle, x, nodes, reach, lines.body[i], self._body[j], thick)

    def _share(
        self,
        distance: Callable[[FloatArray], FloatArray],
        x: FloatArray,
        nodes: IntArray,
        reach: FloatArray,
        one: IntArray,
        other: IntArray,
        thick: FloatArray,
    ) -> float:
        """The deepest of lines of some bodies (the first two of ``nodes``, (P, n)) in what others have."""
        ways = [self._along[nodes[:, a], nodes[:, b]] for a in (0, 1) for b in range(2, nodes.shape[1])]
        kept = self._touches[one, other] & (np.min(ways, axis=0) >= 0.5 * np.pi * reach)
        nodes, reach, thick, own = nodes[kept], reach[kept], thick[kept], (one == other)[kept]
        if not len(nodes):
            return -np.inf
        keep = self._stop * reach
        at_rest = _AT_REST * distance(_places(self._rest, nodes))
        least = np.where(own, np.minimum(keep, at_rest), keep)
        return float(((least - distance(_places(x, nodes))) / thick).max())


def _places(x: FloatArray, nodes: IntArray) -> FloatArray:
    return np.ascontiguousarray(x[nodes].transpose(1, 2, 0))


def _around(x: FloatArray, nodes: IntArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
    places = x[nodes]
    return places.min(axis=1) - radius[:, None], places.max(axis=1) + radius[:, None]
