"""What of contact with shells is doubtful: bodies within shells, and lines that pass through them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from ...arrays import FloatArray, IntArray, distinct
from ...contact.contact import Contact
from ...contact.crossing import crossings
from ...contact.nearby.faces import Faces
from ...frozen import frozen
from ...kinematics.dofs import DofMap
from ...run.observables.snapshot import Snapshot
from ...run.validity import Check
from ..scene import Scene
from .words import ROUNDING, nearer_than_thick, starts_through, starts_within


@frozen
class Crossed:
    """How many triangles each line of two bodies passes through, of the other.

    Attributes:
        map: Numbering of the DOFs.
        passes: Ends of lines (K, 2) and corners of triangles (T, 3), once for either body.
    """

    map: DofMap
    passes: tuple[tuple[IntArray, IntArray], ...]

    def __call__(self, s: Snapshot) -> FloatArray:
        """Look at a state."""
        return self.count(self.map.space_positions(s.state.q))

    def count(self, x: FloatArray) -> FloatArray:
        """Look at places of the nodes (N, 3) [m]."""
        return np.concatenate(
            [
                np.bincount(crossings(x, edges, triangles)[:, 0], minlength=len(edges))
                for edges, triangles in self.passes
            ]
        ).astype(np.float64)


def crossing_checks(contact: Contact) -> Iterator[Check]:
    """That no line passes through a shell, each pair of bodies by itself."""
    for label, crossed in _crossed(contact):
        yield Check(
            crossed,
            0.5,
            np.concatenate([edges[:, 0] for edges, _ in crossed.passes]),
            partial(_told, *contact.pairs[label]),
            "what follows is not to be trusted; reduce numerics.dt, and let nothing start that way",
        )


def _told(one: str, other: str, count: float) -> str:
    triangles = f"{count:.0f} triangles" if count > 1.0 else "a triangle"
    return f"an edge of '{one}' or '{other}' passes through {triangles} of the other"


def _crossed(contact: Contact) -> Iterator[tuple[int, Crossed]]:
    faces = contact.faces
    if faces is None:
        return
    nodes, bodies = faces.lines.nodes, faces.lines.bodies
    for label in distinct(faces.labels[faces.labels >= 0]).tolist():
        passes = tuple(
            (nodes[bodies == line], faces.surface.nodes[faces.surface.bodies == face])
            for line, face in np.argwhere(faces.labels == label).tolist()
        )
        yield label, Crossed(faces.map, passes)


def face_doubts(scene: Scene, contact: Contact, faces: Faces, x: FloatArray) -> Iterator[str]:
    """Bodies that start within shells, through them, or nearer to themselves than they are thick."""
    names = contact.lines.names
    for body in distinct(contact.lines.bodies[np.isfinite(faces.own_reach)]).tolist():
        nearest = float(faces.own_reach[contact.lines.bodies == body].min())
        yield scene.loaded.warning(("contact",), nearer_than_thick(names[body], nearest))
    for label, crossed in _crossed(contact):
        if crossed.count(x).any():
            yield scene.loaded.warning(("contact",), starts_through(*contact.pairs[label]))
    pairs = faces.pairs(faces.search(x, 0.0))
    distance = faces.distances(x, pairs)
    shares = (faces.reach(pairs) - distance) / faces.thickness(pairs)
    labels = faces.labels[faces.bodies(pairs)]
    deep = shares > contact.rule.tolerance * (1.0 + ROUNDING)
    for label in distinct(labels[deep]).tolist():
        share = float(shares[deep & (labels == label)].max())
        one, other = contact.pairs[label]
        yield scene.loaded.warning(("contact",), starts_within(one, other, share))
