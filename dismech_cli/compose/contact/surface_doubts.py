"""What of contact with rigid surfaces is doubtful: lines that pass through them, bodies inside of solids."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from ...arrays import FloatArray, IntArray, distinct
from ...contact.contact import Contact
from ...contact.crossing import crossings
from ...contact.obstacles.pose import Pose
from ...contact.obstacles.rigid_surface import RigidSurface
from ...contact.obstacles.walls import Wall
from ...contact.pieces.inside import inside
from ...frozen import frozen
from ...kinematics.dofs import DofMap
from ...mesh.topology.components import components
from ...mesh.topology.sides import half_edges
from ...run.observables.snapshot import Snapshot
from ...run.validity import Check
from ...scenario.language.obstacle import MeshObstacle
from ..scene import Scene
from .words import starts_through

_ADVICE = "what follows is not to be trusted; reduce numerics.dt, and let nothing start that way"


@frozen
class Pierced:
    """How many triangles of a surface each line passes through.

    Attributes:
        map: Numbering of the DOFs.
        lines: Ends, shape (E, 2).
        surface: The surface.
        pose: Where it is.
    """

    map: DofMap
    lines: IntArray
    surface: RigidSurface
    pose: Pose

    def __call__(self, s: Snapshot) -> FloatArray:
        """Look at a state."""
        return self.count(self.map.space_positions(s.state.q), s.state.law_time)

    def count(self, x: FloatArray, t: float) -> FloatArray:
        """Look at places of the nodes (N, 3) [m] at a time [s]."""
        own = self.pose.at(t).inward(x.T).T
        both = np.concatenate((own, self.surface.vertices))
        found = crossings(both, self.lines, self.surface.triangles + len(own))
        return np.bincount(found[:, 0], minlength=len(self.lines)).astype(np.float64)


@frozen
class Poked:
    """How many edges of a surface pass through each triangle of shells.

    Shells touch a surface by their edges: a corner of it that is sharper than they are fine may come through
    between these.

    Attributes:
        map: Numbering of the DOFs.
        triangles: Of the shells, shape (T, 3).
        edges: Of the surface, ends among its vertices, shape (E, 2).
        surface: The surface.
        pose: Where it is.
    """

    map: DofMap
    triangles: IntArray
    edges: IntArray
    surface: RigidSurface
    pose: Pose

    def __call__(self, s: Snapshot) -> FloatArray:
        """Look at a state."""
        x = self.map.space_positions(s.state.q)
        own = self.pose.at(s.state.law_time).inward(x.T).T
        found = crossings(np.concatenate((own, self.surface.vertices)), self.edges + len(own), self.triangles)
        return np.bincount(found[:, 1], minlength=len(self.triangles)).astype(np.float64)


@frozen
class Swallowed:
    """Whether bodies are inside of a solid: a node of each part that hangs together.

    Attributes:
        map: Numbering of the DOFs.
        nodes: Shape (K,).
        surface: Of the solid.
        pose: Where it is.
    """

    map: DofMap
    nodes: IntArray
    surface: RigidSurface
    pose: Pose

    def __call__(self, s: Snapshot) -> FloatArray:
        """Look at a state."""
        return self.count(self.map.space_positions(s.state.q), s.state.law_time)

    def count(self, x: FloatArray, t: float) -> FloatArray:
        """Look at places of the nodes (N, 3) [m] at a time [s]."""
        own = self.pose.at(t).inward(x[self.nodes].T).T
        found = inside(own, self.surface.vertices[self.surface.triangles])
        return found.astype(np.float64)


def surface_checks(scene: Scene, contact: Contact) -> Iterator[Check]:
    """That no line passes through a rigid surface, and nothing gets inside of a solid."""
    for wall, surface, solid in _surfaces(scene, contact):
        name = wall.obstacle.name
        lines = wall.lines.nodes
        yield Check(
            Pierced(wall.map, lines, surface, wall.obstacle.pose),
            0.5,
            lines[:, 0],
            partial(_passes, name),
            _ADVICE,
        )
        triangles = _of_shells(scene, contact, wall)
        if len(triangles):
            yield Check(
                Poked(wall.map, triangles, _edges(surface), surface, wall.obstacle.pose),
                0.5,
                triangles[:, 0],
                partial(_pokes, name),
                "shells touch a surface by their edges; give them finer ones there, or round the surface",
            )
        if solid:
            nodes = _of_each_part(lines)
            yield Check(
                Swallowed(wall.map, nodes, surface, wall.obstacle.pose),
                0.5,
                nodes,
                partial(_is_inside, name),
                _ADVICE,
            )


def surface_doubts(scene: Scene, contact: Contact, x: FloatArray) -> Iterator[str]:
    """Bodies that start through rigid surfaces, or inside of solids."""
    for wall, surface, solid in _surfaces(scene, contact):
        lines, pose = wall.lines.nodes, wall.obstacle.pose
        through = Pierced(wall.map, lines, surface, pose).count(x, 0.0) > 0.0
        for label in distinct(wall.labels[through]).tolist():
            yield scene.loaded.warning(("contact",), starts_through(*contact.pairs[label]))
        if not solid:
            continue
        for label in distinct(wall.labels).tolist():
            nodes = _of_each_part(lines[wall.labels == label])
            if Swallowed(wall.map, nodes, surface, pose).count(x, 0.0).any():
                body, obstacle = contact.pairs[label]
                yield scene.loaded.warning(
                    ("contact",),
                    f"'{body}' starts inside of '{obstacle}': contact will not bring it out; move one",
                )


def _passes(name: str, count: float) -> str:
    triangles = f"{count:.0f} triangles" if count > 1.0 else "a triangle"
    return f"an edge passes through {triangles} of '{name}'"


def _pokes(name: str, count: float) -> str:
    edges = f"{count:.0f} edges" if count > 1.0 else "an edge"
    return f"a triangle of a shell is pierced by {edges} of '{name}'"


def _is_inside(name: str, count: float) -> str:
    return f"a body is inside of '{name}'"


def _surfaces(scene: Scene, contact: Contact) -> Iterator[tuple[Wall, RigidSurface, bool]]:
    solid = {one.name: one.solid for one in scene.scenario.obstacles if isinstance(one, MeshObstacle)}
    for wall in contact.walls:
        shape = wall.obstacle.shape
        if isinstance(shape, RigidSurface):
            yield wall, shape, solid[wall.obstacle.name]


def _of_shells(scene: Scene, contact: Contact, wall: Wall) -> IntArray:
    """Triangles of the shells that may touch an obstacle, shape (T, 3)."""
    geometry = scene.geometry
    bodies = np.array(geometry.shell_keys, dtype=np.int64)[geometry.triangle_shell]
    return np.asarray(geometry.triangles[np.isin(bodies, wall.lines.bodies)])


def _edges(surface: RigidSurface) -> IntArray:
    return np.unique(np.sort(half_edges(surface.triangles), axis=1), axis=0)


def _of_each_part(lines: IntArray) -> IntArray:
    """A node of each part of lines (E, 2) that hangs together."""
    nodes, own = np.unique(lines, return_inverse=True)
    _, label = components(len(nodes), own.reshape(-1, 2))
    return np.asarray(nodes[np.unique(label, return_index=True)[1]])
