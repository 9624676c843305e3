"""What of contact is doubtful: bodies that start within others, and those that come too deep."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...arrays import FloatArray, distinct
from ...contact.contact import DEEPEST, Contact
from ...contact.nearby.neighbours import Neighbours
from ...frozen import frozen
from ...run.observables.snapshot import Snapshot
from ...run.validity import Check
from ...scenario.language.contact import BarrierLaw
from ..scene import Scene
from ..structure.structure import Structure
from .face_doubts import face_doubts
from .kept import kept_check, refuse_too_near
from .surface_doubts import surface_doubts
from .words import ROUNDING, nearer_than_thick, starts_within


@frozen
class Depth:
    """Deepest penetration so far of each line, as a share of the thickness.

    Attributes:
        count: Number of lines.
    """

    count: int

    def __call__(self, s: Snapshot) -> FloatArray:
        """Read what the steps left."""
        return s.state.memory.get(DEEPEST, np.zeros(self.count))


def depth_check(scene: Scene, contact: Contact) -> Check:
    """That no body comes deeper than the tolerance, or nearer than a barrier allows."""
    spec = scene.scenario.contact
    if spec is not None and isinstance(spec.law, BarrierLaw):
        return kept_check(scene, contact)
    allowed = contact.rule.tolerance
    return Check(
        Depth(len(contact.lines.nodes)),
        allowed * (1.0 + ROUNDING),
        contact.lines.nodes[:, 0],
        lambda value: (
            f"bodies press into each other by {value:.1%} of their thickness, not {allowed:.3g}"
            if value < 0.5
            else f"bodies press into each other by {value:.0%} of their thickness: they pass through"
        ),
        "reduce numerics.dt, or make contact stiffer: see contact.law",
    )


def start_doubts(scene: Scene, structure: Structure, contact: Contact) -> Iterator[str]:
    """Bodies that start within obstacles, each pair with how deep.

    Raises:
        ScenarioError: Some start nearer than a barrier allows.
    """
    spec = scene.scenario.contact
    if spec is not None and isinstance(spec.law, BarrierLaw):
        # what is not refused lies at most in the gap
        refuse_too_near(scene, structure, contact)
        yield from surface_doubts(scene, contact, structure.dofs.space_positions(structure.rest))
        return
    x = structure.dofs.space_positions(structure.rest)
    thickness = 2.0 * contact.lines.radii
    for wall in contact.walls:
        depth = np.maximum(wall.lines.radii - wall.gaps(x, 0.0), 0.0)
        for label in distinct(wall.labels).tolist():
            mine = wall.labels == label
            share = float((depth / thickness[wall.numbers])[mine].max(initial=0.0))
            if share > contact.rule.tolerance * (1.0 + ROUNDING):
                body, obstacle = contact.pairs[label]
                deep = float(depth[mine].max())
                yield scene.loaded.warning(
                    ("contact",),
                    f"'{body}' starts {deep:.3g} m within '{obstacle}', {share:.0%} of its thickness: "
                    "it will be thrown out; move one of them",
                )
    if contact.neighbours is not None:
        yield from _bodies_within(scene, contact, contact.neighbours, x)
    yield from surface_doubts(scene, contact, x)
    if contact.faces is not None:
        yield from face_doubts(scene, contact, contact.faces, x)


def _bodies_within(scene: Scene, contact: Contact, found: Neighbours, x: FloatArray) -> Iterator[str]:
    """Bodies that start within others, and those that are nearer to themselves than they are thick."""
    names, bodies, radii = contact.lines.names, contact.lines.bodies, contact.lines.radii
    if len(found.tight):
        pairs = found.pairs(found.tight)
        for body in distinct(bodies[pairs[:, 0]]).tolist():
            nearest = float(found.tight_reach[bodies[pairs[:, 0]] == body].min())
            yield scene.loaded.warning(("contact",), nearer_than_thick(names[body], nearest))
    near = found.search(x, 0.0)
    shares = (found.reach(near) - found.distances(x, near)) / radii[near].sum(axis=1)
    labels = found.labels[bodies[near[:, 0]], bodies[near[:, 1]]]
    deep = shares > contact.rule.tolerance * (1.0 + ROUNDING)
    for label in distinct(labels[deep]).tolist():
        share = float(shares[deep & (labels == label)].max())
        one, other = contact.pairs[label]
        yield scene.loaded.warning(("contact",), starts_within(one, other, share))
