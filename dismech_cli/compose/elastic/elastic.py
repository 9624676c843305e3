"""All elastic energies of a scene, and the damping of its materials."""

from __future__ import annotations

from dataclasses import dataclass

from ...model.driven import DrivenEnergy
from ...model.rate import ViscousStress
from ...model.stencil import StencilEnergy
from ..scene import Scene
from ..structure.structure import Structure
from .damping import damping_terms
from .rod_drives import driven_rods
from .rods import RodEnergies, rod_energies
from .shell_drives import driven_shells
from .shells import shell_energies
from .stubs import stub_springs
from .welds import weld_energies


@dataclass(frozen=True, slots=True)
class Elastic:
    """Elastic energies.

    Attributes:
        rods: Those of the rods, at rest.
        terms: All of them, driven where the scenario actuates them.
        damping: What their materials resist rates of strain with.
    """

    rods: RodEnergies
    terms: tuple[StencilEnergy | DrivenEnergy, ...]
    damping: tuple[ViscousStress, ...]


def make_elastic(scene: Scene, structure: Structure) -> Elastic:
    """Make the elastic energies.

    Raises:
        ScenarioError: A section, a list of natural strains, a weld or an actuation does not fit.
    """
    rods, shells = rod_energies(scene, structure), shell_energies(structure)
    welds = weld_energies(scene, structure)
    terms = (
        *driven_rods(scene, structure, rods, welds),
        *stub_springs(scene, structure),
        *driven_shells(scene, structure, shells),
        *shells.seams,
    )
    return Elastic(rods, terms, damping_terms(scene, structure, rods, shells, welds))
