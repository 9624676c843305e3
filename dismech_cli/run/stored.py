"""Energies that a state holds [J], by the bound terms of one system."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from ..model.configuration import Configuration
from ..model.model import Model
from ..model.term import BoundEnergy
from ..solve.system import System
from .roles import Roles


@frozen
class Stored:
    """The bound terms that store energy, by their place in the account.

    Attributes:
        mass: Of each DOF, shape (n,).
        shares: Names of all parts of the elastic energy.
        elastic: Terms that store it.
        surplus: What elastic terms store beyond their energies in the balance.
        gravitational: Terms that store gravitational energy.
        contact: Terms that store the energy of contact.
    """

    mass: FloatArray
    shares: tuple[str, ...]
    elastic: tuple[BoundEnergy, ...]
    surplus: tuple[BoundEnergy, ...]
    gravitational: tuple[BoundEnergy, ...]
    contact: tuple[BoundEnergy, ...]

    @classmethod
    def of(cls, model: Model, roles: Roles, system: System) -> Stored:
        """Find them among the terms of a system."""
        elastic = {term.name for term in roles.elastic}
        surplus = (term.bind(system.pattern, model.driver).potential for term in roles.surplus)
        return cls(
            mass=model.mass,
            shares=roles.shares,
            elastic=tuple(term for term in system.energies if term.name in elastic),
            surplus=tuple(energy for energy in surplus if energy is not None),
            gravitational=tuple(term for term in system.energies if term.name in roles.gravitational),
            contact=tuple(term for term in system.energies if term.name in roles.contact),
        )

    def at(self, c: Configuration) -> dict[str, float]:
        """All of them at a state, by name, with the total."""
        parts = dict.fromkeys(self.shares, 0.0)
        for term in (*self.elastic, *self.surplus):
            for name, value in zip(term.shares, np.add.reduce(term.energy(c), axis=1).tolist(), strict=True):
                parts[name] += value
        entries = {"kinetic": 0.5 * float(self.mass @ (c.v * c.v)), **parts}
        entries["elastic"] = sum(parts.values())
        entries["gravitational"] = total(self.gravitational, c)
        entries["contact"] = total(self.contact, c)
        entries["total"] = sum(entries[name] for name in ("kinetic", "elastic", "gravitational", "contact"))
        return entries

    def fed(self, c: Configuration) -> float:
        """Energy of passive springs beyond that of the stiffer ones in the balance."""
        return total(self.surplus, c)


def total(terms: Sequence[BoundEnergy], c: Configuration) -> float:
    """Energy of terms together."""
    return sum(float(term.energy(c).sum()) for term in terms)
