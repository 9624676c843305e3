"""Elastic energy of hinges between shells, and between the branches of one."""

from __future__ import annotations

from ...energies.hinge import hinge_term
from ...model.stencil import StencilEnergy
from ..structure.structure import Structure

SEAMS = "seams"
"""Name of the energy."""


def seam_energies(structure: Structure) -> tuple[StencilEnergy, ...]:
    """The energy of hinges that are no shell's own, stress-free at rest; nothing without them."""
    seams = structure.shell_edges.seams
    if not len(seams.hinges):
        return ()
    return (hinge_term(SEAMS, structure.dofs, structure.positions, seams.hinges, seams.stiffness),)
