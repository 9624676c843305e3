"""All elastic energies of a scene, and the damping of its materials."""

from __future__ import annotations

from dataclasses import dataclass

from ...model.driven import DrivenEnergy
from ...model.rate import ViscousStress
from ...model.stencil import StencilEnergy
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


@dataclass(frozen=True, slots=True)
class Passive:
    """Elastic energies before anything drives them.

    Attributes:
        rods: Those of the rods.
        shells: Those of the shells.
        welds: Those of rods with shells, and what natural strains do to them.
    """

    rods: RodEnergies
    shells: ShellEnergies
    welds: tuple[tuple[StencilEnergy, Halves], ...]


@dataclass(frozen=True, slots=True)
class Elastic:
    """Elastic energies.

    Attributes:
        rods: Those of the rods at rest, as stiff as feedback makes them.
        terms: All of them, driven where the scenario actuates them.
        damping: What their materials resist rates of strain with.
        surplus: What they store beyond the energies in the balance, which feedback makes stiffer.
    """

    rods: RodEnergies
    terms: tuple[StencilEnergy | DrivenEnergy, ...]
    damping: tuple[ViscousStress, ...]
    surplus: tuple[DrivenEnergy, ...]


def make_passive(scene: Scene, structure: Structure) -> Passive:
    """Make the elastic energies, undriven.

    Raises:
        ScenarioError: A section, a list of natural strains or a weld does not fit.
    """
    rods, shells = rod_energies(scene, structure), shell_energies(structure)
    return Passive(rods, shells, weld_energies(scene, structure))


def make_elastic(scene: Scene, structure: Structure, passive: Passive, ports: Ports) -> Elastic:
    """Drive the elastic energies.

    Raises:
        ScenarioError: An actuation does not fit.
    """
    rods = driven_rods(scene, structure, passive.rods, passive.welds, ports)
    shells = driven_shells(scene, structure, passive.shells, ports)
    terms = (*rods.terms, *stub_springs(scene, structure), *shells.terms, *passive.shells.seams)
    damping = damping_terms(scene, structure, passive.rods, passive.shells, passive.welds)
    return Elastic(rods.rods, terms, damping, (*rods.surplus, *shells.surplus))
