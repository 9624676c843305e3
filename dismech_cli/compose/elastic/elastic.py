"""All elastic energies of a scene, and the damping of its materials."""

from __future__ import annotations

from ...frozen import frozen
from ...model.driven import DrivenEnergy
from ...model.rate import ViscousStress
from ...model.stencil import StencilEnergy
from ...model.term import Term
from ..scene import Scene
from ..structure.structure import Structure
from .damping import damping_terms
from .following import Ports
from .halves import Halves
from .rod_drives import driven_rods
from .rods import RodEnergies, rod_energies
from .shell_drives import driven_shells
from .shells import ShellEnergies, shell_energies
from .stubs import stub_springs
from .welds import weld_energies


@frozen
class Passive:
    """Elastic energies before anything drives them.

    Attributes:
        rods: Those of the rods.
        shells: Those of the shells.
        welds: Those of rods with shells, and what natural strains do to them.
        damping: What their materials resist rates of strain with.
    """

    rods: RodEnergies
    shells: ShellEnergies
    welds: tuple[tuple[StencilEnergy, Halves], ...]
    damping: tuple[ViscousStress, ...]

    @property
    def terms(self) -> tuple[Term, ...]:
        """All that there is."""
        welds = (energy for energy, _ in self.welds)
        return (*self.rods.terms, *self.shells.terms, *welds, *self.damping)


@frozen
class Elastic:
    """Elastic energies.

    Attributes:
        rods: Those of the rods at rest, as stiff as feedback makes them.
        terms: All of them, driven where the scenario actuates them.
        surplus: What they store beyond the energies in the balance, which feedback makes stiffer.
    """

    rods: RodEnergies
    terms: tuple[StencilEnergy | DrivenEnergy, ...]
    surplus: tuple[DrivenEnergy, ...]


def make_passive(scene: Scene, structure: Structure) -> Passive:
    """Make the elastic energies, undriven.

    Raises:
        ScenarioError: A section, a list of natural strains or a weld does not fit.
    """
    rods, shells = rod_energies(scene, structure), shell_energies(structure)
    welds = weld_energies(scene, structure)
    return Passive(rods, shells, welds, damping_terms(scene, structure, rods, shells, welds))


def make_elastic(scene: Scene, structure: Structure, passive: Passive, ports: Ports) -> Elastic:
    """Drive the elastic energies.

    Raises:
        ScenarioError: An actuation does not fit.
    """
    rods = driven_rods(scene, structure, passive.rods, passive.welds, ports)
    shells = driven_shells(scene, structure, passive.shells, ports)
    terms = (*rods.terms, *stub_springs(scene, structure), *shells.terms, *passive.shells.seams)
    return Elastic(rods.rods, terms, (*rods.surplus, *shells.surplus))
