"""All that keeps a distance in a scene, and a look at whether it does."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ..drivers.loops import Loops
from ..gather.source import Source
from ..nearby.searches import Searches
from ..obstacles.walls import Wall
from ..points.barrier import Stop
from .guard import Guard
from .guarded import Pairing
from .wall_guard import WallGuard


@frozen
class Shortfall:
    """How much nearer things are than they may be.

    Attributes:
        nodes: A node of each, shape (K,).
        labels: Numbers of the pairs of bodies, shape (K,).
        shares: Of the distance that is kept; below 0 where there is room, shape (K,).
        distances: [m], shape (K,).
        least: The distances that are kept [m], shape (K,).
    """

    nodes: IntArray
    labels: IntArray
    shares: FloatArray
    distances: FloatArray
    least: FloatArray


@frozen
class Guarding:
    """Pairs and obstacles that are kept at a distance.

    Attributes:
        pairings: Pairs by kind.
        walls: Obstacles with their lines.
        stop: The distance.
    """

    pairings: tuple[Pairing, ...]
    walls: tuple[Wall, ...]
    stop: Stop

    def sources(self, searches: Searches, loops: Loops) -> tuple[Source, ...]:
        """What guards them in a run."""
        return (
            *(Guard(pairing, self.stop, pairing.nearby(searches), loops) for pairing in self.pairings),
            *(WallGuard(wall, self.stop) for wall in self.walls),
        )

    def shortfall(self, x: FloatArray, t: float) -> Shortfall:
        """Look at places of the nodes (N, 3) [m] at a time [s], with nothing that a run remembers."""
        nodes, labels = [np.empty(0, dtype=np.int64)], [np.empty(0, dtype=np.int64)]
        distances, least = [np.empty(0)], [np.empty(0)]
        for pairing in self.pairings:
            keys = pairing.search(x, 0.0)
            at, traits = pairing.nodes(keys), pairing.traits(keys)
            nodes.append(at[:, 0])
            labels.append(traits.between.labels)
            distances.append(pairing.closest(np.ascontiguousarray(x[at].transpose(1, 2, 0))).distance)
            least.append(self.stop.least * traits.thickness)
        for wall in self.walls:
            nodes.append(wall.lines.nodes[:, 0])
            labels.append(wall.labels)
            distances.append(wall.gaps(x, t))
            least.append(self.stop.least * wall.lines.radii)
        found, kept = np.concatenate(distances), np.concatenate(least)
        return Shortfall(np.concatenate(nodes), np.concatenate(labels), 1.0 - found / kept, found, kept)
