"""Whether a barrier keeps what it promises: at the start, where a scene is refused, and on every frame."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray
from ...contact.contact import Contact
from ...contact.guards.guarding import Guarding
from ...frozen import frozen
from ...kinematics.dofs import DofMap
from ...run.observables.snapshot import Snapshot
from ...run.validity import Check
from ..scene import Scene
from ..structure.structure import Structure


@frozen
class Nearer:
    """How much nearer to anything than it may be each node is, as a share of that distance.

    Attributes:
        map: Numbering of the DOFs.
        guards: What keeps a distance.
        count: Number of visible nodes.
    """

    map: DofMap
    guards: Guarding
    count: int

    def __call__(self, s: Snapshot) -> FloatArray:
        """Look at a state."""
        found = self.guards.shortfall(self.map.space_positions(s.state.q), s.state.law_time)
        out = np.zeros(self.count)
        np.maximum.at(out, found.nodes, found.shares)
        return out


def kept_check(scene: Scene, contact: Contact) -> Check:
    """That nothing is nearer than a barrier allows."""
    count = len(scene.geometry.nodes)
    return Check(
        Nearer(contact.map, contact.guards, count),
        0.0,
        np.arange(count),
        lambda value: f"a pair is nearer than its barrier allows by {value:.1%} of that distance",
        "what holds one of them moves it there: prescribe less in a step",
    )


def refuse_too_near(scene: Scene, structure: Structure, contact: Contact) -> None:
    """Refuse bodies that start nearer than a barrier allows.

    Raises:
        ScenarioError: Naming the worst pair.
    """
    found = contact.guards.shortfall(structure.dofs.space_positions(structure.rest), 0.0)
    if not len(found.shares) or found.shares.max() < 0.0:
        return
    worst = int(np.argmax(found.shares))
    one, other = contact.pairs[found.labels[worst]]
    distance, least = found.distances[worst], found.least[worst]
    raise scene.error(
        ("contact", "law"),
        f"'{one}' starts {distance:.4g} m from '{other}', but a barrier keeps them more than {least:.4g} m "
        "apart, from middle to middle or surface; move one of them, lower `stop`, or take type: penalty",
    )
