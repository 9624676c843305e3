"""Contact by the family's own law of pairs."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from ...arrays import IntArray
from ...contact.contact import Contact
from ...contact.gather.source import Source
from ...contact.law.loads import Implicit, Lagged, Loads
from ...contact.obstacles.family_floor import FamilyFloor
from ...contact.obstacles.obstacle import HalfSpace
from ...contact.pairs.family import FamilyPairs
from ...contact.points.softplus import Softplus
from ...frozen import frozen
from ...kernels.driver import Driver
from ...scenario.language.contact import CompatLaw
from .guards import pairings


def _implicit(name: str) -> Loads:
    return Implicit()


_LOADS: dict[str, Callable[[str], Loads]] = {"implicit": _implicit, "lagged": Lagged}


@frozen
class Family:
    """Makes what finds pairs that touch.

    Attributes:
        law: As in the scenario.
        sides: Lines that are the sides of each triangle, shape (T, 3).
    """

    law: CompatLaw
    sides: IntArray

    def __call__(self, contact: Contact, driver: Driver) -> Iterator[Source]:
        """One for each obstacle and each kind of pairs."""
        law, loads = Softplus(self.law.stiffness, self.law.width), _LOADS[self.law.normal_force]
        for wall in contact.walls:
            plane = wall.obstacle.shape
            assert isinstance(plane, HalfSpace), "checked with the scenario"
            yield FamilyFloor(wall, plane, law, loads(f"contact.lagged.{wall.obstacle.name}"))
        for kind in pairings(contact.neighbours, contact.faces, self.sides):
            for pairing in kind:
                yield FamilyPairs(pairing, law, loads(f"{pairing.name}.lagged"))
