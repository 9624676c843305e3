"""Who counts as what in the energy account."""

from __future__ import annotations

from ..frozen import frozen
from ..model.elastic import Elastic


@frozen
class Roles:
    """The terms of a model by their place in the account.

    Attributes:
        elastic: Terms that store elastic energy.
        gravitational: Names of those that store gravitational energy.
        loads: Names of those whose work counts as external.
        dissipative: Names of those that take energy out.
        contact: Names of those that store the energy of contact.
        friction: Names of those that take energy out where bodies touch.
        surplus: What elastic terms store beyond their energies in the balance, under their names.
    """

    elastic: tuple[Elastic, ...]
    gravitational: tuple[str, ...]
    loads: tuple[str, ...]
    dissipative: tuple[str, ...]
    contact: tuple[str, ...] = ()
    friction: tuple[str, ...] = ()
    surplus: tuple[Elastic, ...] = ()

    @property
    def shares(self) -> tuple[str, ...]:
        """Names of all parts of the elastic energy; some are of several terms."""
        return tuple(dict.fromkeys(name for term in self.elastic for name in term.shares))
