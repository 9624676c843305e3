"""Elastic energies of shells."""

from __future__ import annotations

from collections.abc import Mapping

from ...frozen import frozen
from ...model.stencil import StencilEnergy
from ..shells.bending import bending_of
from ..shells.membrane import MEMBRANES
from ..structure.structure import Structure
from .seams import seam_energies


@frozen
class ShellEnergies:
    """What the shells give to the model.

    Attributes:
        membrane: Stretching energy of each shell by its name.
        bending: Bending energy of each shell by its name.
        seams: Bending energy between them, and between the branches of one.
    """

    membrane: Mapping[str, StencilEnergy]
    bending: Mapping[str, StencilEnergy]
    seams: tuple[StencilEnergy, ...]

    @property
    def terms(self) -> tuple[StencilEnergy, ...]:
        """All that there are."""
        return (*self.membrane.values(), *self.bending.values(), *self.seams)


def shell_energies(structure: Structure) -> ShellEnergies:
    """Make the energies of all shells."""
    membrane: dict[str, StencilEnergy] = {}
    bending: dict[str, StencilEnergy] = {}
    for name, body in structure.shell_edges.bodies.items():
        membrane[name] = MEMBRANES[body.shell.membrane](body, structure)
        bent = bending_of(body.shell).term(body, structure)
        bending[name] = _flattened(bent) if body.shell.natural.shape == "flat" else bent
    return ShellEnergies(membrane, bending, seam_energies(structure))


def _flattened(energy: StencilEnergy) -> StencilEnergy:
    """The same energy, unbent where all its angles vanish."""
    return energy.having({name: 0.0 for name in energy.kernel.naturals})
