"""An obstacle on which bodies stick without creep: friction grows with the way from an anchor.

Each node that touches drags an anchor along the surface. Friction is full where the way from it is a small
length, and no anchor stays farther behind than that: what is held by less stands still for ever.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from ...arrays import FloatArray, distinct
from ...model.term import Memory
from ..gather.source import Depths
from ..gather.stencils import Stencils
from ..gather.touching import Touching
from .near_wall import NearWall
from .walls import Wall


class AnchoredWall:
    """An obstacle that remembers how far nodes are from their anchors; implements :class:`.source.Source`.

    Slips are the ways from the anchors [m] in place of velocities. What a step leaves to the next are the
    ways of the nodes and their places, in the frame of the obstacle.
    """

    def __init__(self, wall: Wall, length: float) -> None:
        """Begin without anchors.

        Args:
            wall: The obstacle and its lines.
            length: Way on which friction becomes full [m].
        """
        self._near, self._wall, self._length = NearWall(wall), wall, length
        self._nodes = distinct(wall.lines.nodes)
        self._name = f"contact.anchors.{wall.obstacle.name}"
        self._ways: FloatArray = np.zeros((len(self._nodes), 3))
        self._places: FloatArray | None = None
        self._t, self._factor = 0.0, 1.0

    def recall(self, memory: Memory) -> None:
        """Take up ways and places; at the start of a run there are none."""
        kept = memory.get(self._name)
        self._ways = np.zeros((len(self._nodes), 3)) if kept is None else kept[:, :3]
        self._places = None if kept is None else kept[:, 3:]

    def memory(self, x: FloatArray) -> Memory:
        """Ways and places at the end of a step, of which depths were asked last.

        Nodes that nothing presses on begin anew; ways are cut to the length.
        """
        normal, still = np.zeros_like(x), np.zeros_like(x)
        for touching in self._near.touching(x, still, self._t, self._factor):
            points = touching.points
            pressed = points.weights[:, None] * (points.load * points.normal)
            np.add.at(normal, touching.stencils.nodes[points.item].T, pressed.transpose(0, 2, 1))
        normal = normal[self._nodes]
        size = np.linalg.norm(normal, axis=1)
        n = normal / np.maximum(size, np.finfo(float).tiny)[:, None]
        frame = self._wall.obstacle.pose.at(self._t)
        ways = self._from_anchors(x, self._t)[self._nodes]
        ways = ways - (ways * n).sum(axis=1)[:, None] * n
        far = np.linalg.norm(ways, axis=1)
        ways *= np.minimum(1.0, self._length / np.maximum(far, np.finfo(float).tiny))[:, None]
        ways[size == 0.0] = 0.0
        own = frame.inward(x[self._nodes].T).T
        return {self._name: np.column_stack(((frame.turn.T @ ways.T).T, own))}

    def detect(self, x: FloatArray) -> bool:
        """All lines have places for ever."""
        return False

    def touching(self, x: FloatArray, v: FloatArray, t: float, factor: float) -> Iterator[Touching]:
        """Points of contact, with the ways from their anchors."""
        self._factor = factor
        for touching in self._near.touching(x, v, t, factor):
            ways = self._from_anchors(x, t)
            yield replace(touching, moving=partial(touching.stencils.relative, touching.points, ways))

    def velocities(self, touching: Touching, x: FloatArray, v: FloatArray, t: float) -> FloatArray:
        """Velocities of the lines against the surface at points of contact [m/s], shape (3, K)."""
        return self._near.velocities(touching, x, v, t)

    @property
    def stencils(self) -> tuple[Stencils, ...]:
        """The two nodes of each line."""
        return self._near.stencils

    @property
    def steady(self) -> bool:
        """Whether the obstacle never moves."""
        return self._near.steady

    def depths(self, x: FloatArray, t: float) -> Depths:
        """Penetration of the lines nearby."""
        self._t = t
        return self._near.depths(x, t)

    def needed(self, x: FloatArray, ahead: FloatArray, t: float, dt: float, tolerance: float) -> float:
        """Factor of the stiffness that stops in time what comes in the next step."""
        return self._near.needed(x, ahead, t, dt, tolerance)

    def longest_step(self, x0: FloatArray, x1: FloatArray, t0: float, t1: float) -> float:
        """Part of the way on which no line gets inside."""
        return self._near.longest_step(x0, x1, t0, t1)

    def _from_anchors(self, x: FloatArray, t: float) -> FloatArray:
        """Ways of all nodes from their anchors, in space [m], shape (N, 3); 0 of those that take no part."""
        frame = self._wall.obstacle.pose.at(t)
        own = frame.inward(x[self._nodes].T).T
        if self._places is None:
            self._places = own
        out = np.zeros_like(x)
        out[self._nodes] = frame.turned((self._ways + own - self._places).T).T
        return out
