"""Parts of bodies that nothing connects, and what a static scene leaves free to move."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...arrays import FloatArray, IntArray, shared
from ...frozen import frozen
from ...mesh.topology.components import components
from ...mesh.topology.sides import half_edges
from ..bodies.geometry import Geometry
from ..scene import Scene
from ..shells.bending import bending_of
from ..touching import named_pairs
from .holds import Hold

# A rigid motion is held that moves held nodes by more, in squares of its size.
_HELD = 1e-9
# So many nodes of a part are named.
_NAMED = 3


@frozen
class Parts:
    """Bodies by what hangs together in the scene as joined.

    Attributes:
        label: Part of each node of the scene, shape (N,).
        members: Nodes of each part.
        own: Own numbers of the nodes of each body, part by part, the largest first.
    """

    label: IntArray
    members: list[IntArray]
    own: dict[str, list[IntArray]]


def find_parts(geometry: Geometry) -> Parts:
    """What hangs together by edges and triangles."""
    sides = np.concatenate((geometry.edges, half_edges(geometry.triangles)))
    _, label = components(len(geometry.nodes), sides)
    return Parts(
        label,
        _split(label),
        {
            body: sorted(_split(label[nodes]), key=len, reverse=True)
            for body, nodes in geometry.body_nodes.items()
        },
    )


def _split(label: IntArray) -> list[IntArray]:
    """Places of each label."""
    order = np.argsort(label, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(label[order])) + 1)


def in_parts(scene: Scene, parts: Parts) -> Iterator[str]:
    """Bodies that are several, as a sheet that a slit cuts through."""
    for key, body in enumerate(scene.scenario.geometry):
        found = parts.own[body.name]
        if len(found) > 1:
            yield scene.loaded.warning(
                ("geometry", key),
                f"'{body.name}' falls in {len(found)} parts that nothing connects; the smallest has "
                f"{_words(scene.geometry, body.name, found[-1])}: what acts on one does not reach the "
                "others; if they belong together, weld the mesh or add joints",
            )


def adrift(scene: Scene, parts: Parts, holds: tuple[Hold, ...]) -> Iterator[str]:
    """Bodies, and parts of them, that a static scene leaves free to move or turn as a whole."""
    planar = scene.scenario.dimension == 2
    motions = _planar_motions(scene.scenario.plane) if planar else np.arange(6)
    touching = {name for pair in named_pairs(scene.scenario) for name in pair}
    told: set[int] = set()
    for key, body in enumerate(scene.scenario.geometry):
        nodes, found = scene.geometry.body_nodes[body.name], parts.own[body.name]
        loose: list[tuple[int, IntArray]] = []
        for own in found:
            label = int(parts.label[nodes[own[0]]])
            if label in told:
                continue
            told.add(label)
            held = _held_motions(scene.geometry, holds, parts.members[label], motions)
            if held < len(motions):
                loose.append((len(motions) - held, own))
        if loose:
            left, own = max(loose, key=lambda one: one[0])
            holder = "nothing but contact" if body.name in touching else "nothing"
            what = f"'{body.name}'"
            if len(found) > 1:
                what = f"a part of '{body.name}' with {_words(scene.geometry, body.name, own)}"
            more = f" ({len(loose) - 1} more like it)" if len(loose) > 1 else ""
            yield scene.loaded.warning(
                ("geometry", key),
                f"{holder} holds {what} in {left} of the {len(motions)} ways to move or turn as a whole{more}"
                ": where it rests is left to rounding, if it rests at all",
            )


def _words(geometry: Geometry, body: str, own: IntArray) -> str:
    """How many nodes of a body, which, and where the first is."""
    x, y, z = (f"{coordinate:.4g}" for coordinate in geometry.nodes[geometry.body_nodes[body][own[0]]])
    if own[-1] - own[0] == len(own) - 1:
        which = f"{own[0]} to {own[-1]}"
    else:
        which = ", ".join(map(str, own[:_NAMED])) + (", ..." if len(own) > _NAMED else "")
    return f"{len(own)} nodes ({which}; the first at ({x}, {y}, {z}) m)"


def _planar_motions(plane: str) -> IntArray:
    """Of three translations and three rotations, those within a plane."""
    inside = ["xyz".index(axis) for axis in plane]
    (normal,) = {0, 1, 2}.difference(inside)
    return np.array([*inside, 3 + normal])


def _held_motions(geometry: Geometry, holds: tuple[Hold, ...], nodes: IntArray, motions: IntArray) -> int:
    """Number of rigid motions of the nodes that the holds leave none of."""
    middle = geometry.nodes[nodes].mean(axis=0)
    size = float(np.linalg.norm(geometry.nodes[nodes] - middle, axis=1).max())
    rows: list[FloatArray] = []
    for hold in holds:
        held = shared(hold.nodes, nodes)
        arms = (geometry.nodes[held] - middle) / size
        for axis in hold.axes:
            unit = np.eye(3)[axis]
            rows.append(np.hstack((np.tile(unit, (len(held), 1)), np.cross(arms, unit))))
        rows += _held_turning(geometry, hold, held)
    if not rows:
        return 0
    matrix = np.concatenate(rows)[:, motions]
    return int((np.linalg.eigvalsh(matrix.T @ matrix) > _HELD).sum())


def _held_turning(geometry: Geometry, hold: Hold, held: IntArray) -> Iterator[FloatArray]:
    """Rows of the rotations that a hold of the held nodes prevents by itself."""
    still = np.zeros((3, 3))
    at_walls = np.isin(geometry.edges, shared(hold.walls, held)).any(axis=1)
    at_hubs = np.isin(geometry.turning.ends, hold.hubs) & np.isin(geometry.edges, held)
    if at_walls.any() or at_hubs.any() or np.isin(geometry.edges[hold.edges], held).all(axis=1).any():
        yield np.hstack((still, np.eye(3)))
    for k, shell in enumerate(geometry.shells):
        if not bending_of(shell).has_normals:
            continue
        triangles = geometry.triangles[geometry.triangle_shell == k]
        sides = half_edges(triangles)
        sides = sides[np.isin(sides, shared(hold.sloped, held)).all(axis=1)]
        if len(sides):
            # the normal at a side does not turn about it
            directions = geometry.nodes[sides[:, 1]] - geometry.nodes[sides[:, 0]]
            directions /= np.linalg.norm(directions, axis=1)[:, None]
            yield np.hstack((np.zeros_like(directions), directions))
