"""Which pairs of a scene keep a distance."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...arrays import FloatArray, IntArray, union
from ...contact.guards.eased import eased
from ...contact.guards.guarded import Pairing, RodEdges
from ...contact.guards.guarded_sheets import SheetEdges, SheetNodes
from ...contact.guards.guarding import Guarding
from ...contact.nearby.faces import Faces
from ...contact.nearby.neighbours import Neighbours
from ...contact.obstacles.walls import Wall
from ...contact.points.barrier import Stop
from ...scenario.language.contact import BarrierLaw, CompatLaw, Law, PenaltyLaw

# The core of soft contact: nothing comes nearer than half the distance at which things touch.
_CORE = Stop(0.5, 0.75)


def make_guards(
    law: Law,
    walls: tuple[Wall, ...],
    neighbours: Neighbours | None,
    faces: Faces | None,
    sides: IntArray,
    x: FloatArray,
) -> Guarding:
    """What a law keeps at a distance.

    Args:
        law: As in the scenario.
        walls: Obstacles with their lines.
        neighbours: Rods that may touch each other.
        faces: What may touch shells.
        sides: Lines that are the sides of each triangle, shape (T, 3).
        x: Where nodes start (N, 3) [m].
    """
    rods, sheets = pairings(neighbours, faces, sides)
    match law:
        case BarrierLaw():
            # as shares of the distance at which lines begin to push
            stop = Stop(law.stop / law.reach, (law.stop + 0.5 * law.gap) / law.reach)
            return Guarding((*rods, *sheets), walls, stop)
        case PenaltyLaw(core="on"):
            return _core((*rods, *sheets), walls, x)
        case PenaltyLaw(core="auto"):
            return _core(sheets, (), x)
        case PenaltyLaw() | CompatLaw():
            return Guarding((), (), _CORE)


def pairings(
    neighbours: Neighbours | None, faces: Faces | None, sides: IntArray
) -> tuple[tuple[Pairing, ...], tuple[Pairing, ...]]:
    """All pairs of edges of rods, and those of edges, nodes and triangles with shells."""
    rods = (RodEdges(neighbours),) if neighbours is not None else ()
    return rods, tuple(_sheets(faces, sides)) if faces is not None else ()


def _core(pairings: tuple[Pairing, ...], walls: tuple[Wall, ...], x: FloatArray) -> Guarding:
    """A core that begins where things start, where that is nearer."""
    apart = (wall.some(np.flatnonzero(wall.gaps(x, 0.0) > _CORE.begin * wall.lines.radii)) for wall in walls)
    kept = tuple(eased(pairing, x, _CORE.begin) for pairing in pairings)
    return Guarding(kept, tuple(wall for wall in apart if len(wall.numbers)), _CORE)


def _sheets(faces: Faces, sides: IntArray) -> Iterator[Pairing]:
    """Edges and nodes with shells, less those that are near along a body to any triangle at hand."""
    lines, near = faces.lines, faces.pairs(faces.excluded)
    nothing = np.empty(0, dtype=np.int64)
    edges = SheetEdges(faces, sides, nothing)
    excluded = edges.keys(np.repeat(near[:, 0], 3), sides[near[:, 1]].reshape(-1))
    yield SheetEdges(faces, sides, excluded)
    ends = np.full(int(max(lines.nodes.max(), faces.surface.nodes.max())) + 1, -1)
    ends[lines.nodes] = np.arange(len(lines.nodes))[:, None]
    own_reach = np.full(len(ends), np.inf)
    np.minimum.at(own_reach, lines.nodes, faces.own_reach[:, None])
    nodes = SheetNodes(faces, ends, nothing, own_reach)
    excluded = nodes.keys(lines.nodes[near[:, 0]], near[:, 1][:, None])
    corners = nodes.keys(faces.surface.nodes, np.arange(len(sides))[:, None])
    yield SheetNodes(faces, ends, union(excluded, corners), own_reach)
