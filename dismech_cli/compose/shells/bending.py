"""The table of bending models of shells: all that the rest of the house knows of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from ...arrays import FloatArray
from ...energies.hinge import hinge_term
from ...energies.midedge import midedge_term
from ...energies.midedge_averaged import midedge_averaged_term
from ...model.stencil import StencilEnergy
from ...scenario.language.geometry import Shell
from ...sections.shells import (
    edge_lengths,
    hinge_springs,
    hinge_stiffness,
    midedge_springs,
    weighted_hinge_stiffness,
)
from .parts import ShellParts


@dataclass(frozen=True, slots=True)
class ShellBending:
    """A bending model.

    Attributes:
        term: Makes the energy of a shell, stress-free in its rest shape.
        springs: Stiffness of the springs that the DiSMech programs put on its edges, see
            :mod:`.shell_membrane`: of a shell with edges of these lengths [m], shape (B,).
        free_normals: Whether every edge has a normal with an angle of its own.
        at_hinges: Whether its stencils are the hinges between two triangles, rather than the triangles.
        dihedral_factor: Change of the natural angles at a hinge when it is driven by 1: those of triangles
            count from the face and so have the other sign, and that of a free normal is half of it.
        curvature_factor: Change of the natural angles of a triangle per angle from its normal to that of an
            edge; None if the model knows no curvature.
        converges: Whether it is a plate on every mesh, rather than on nearly equilateral triangles.
        plate: What it is, for the plan.
    """

    term: Callable[[ShellParts], StencilEnergy]
    springs: Callable[[ShellParts, FloatArray], FloatArray]
    free_normals: bool
    at_hinges: bool
    dihedral_factor: float
    curvature_factor: float | None
    converges: bool
    plate: str


def bending_of(shell: Shell) -> ShellBending:
    """The bending model of a shell."""
    return SHELL_BENDING[shell.bending]


def _name(parts: ShellParts) -> str:
    return f"{parts.shell.name}.bending"


def _midedge(parts: ShellParts) -> StencilEnergy:
    assert parts.normals is not None
    return midedge_term(
        _name(parts),
        parts.dofs,
        parts.positions,
        parts.triangles,
        parts.topology.face_edges + parts.first,
        parts.topology.face_signs,
        parts.normals,
        youngs_modulus=parts.sheet.youngs_modulus,
        poisson_ratio=parts.sheet.poisson_ratio,
        thickness=parts.sheet.thickness,
    )


def _averaged(parts: ShellParts) -> StencilEnergy:
    return midedge_averaged_term(
        _name(parts),
        parts.dofs,
        parts.positions,
        parts.triangles,
        parts.topology.face_edges,
        parts.topology.edge_faces,
        youngs_modulus=parts.sheet.youngs_modulus,
        poisson_ratio=parts.sheet.poisson_ratio,
        thickness=parts.sheet.thickness,
    )


def _hinge(parts: ShellParts) -> StencilEnergy:
    stiffness = HINGES[parts.shell.hinges or "equal"](parts)
    return hinge_term(_name(parts), parts.dofs, parts.positions, parts.topology.hinges, stiffness)


def _equal_hinges(parts: ShellParts) -> FloatArray:
    return hinge_stiffness(parts.sheet.youngs_modulus, parts.sheet.thickness, len(parts.topology.hinges))


def _weighted_hinges(parts: ShellParts) -> FloatArray:
    edges = parts.topology.hinge_edges
    lengths = edge_lengths(parts.positions, parts.topology.edges)[edges]
    around = parts.adjacent_areas()[edges]
    return weighted_hinge_stiffness(parts.sheet.youngs_modulus, parts.sheet.thickness, lengths, around)


def _family_of_hinges(parts: ShellParts, lengths: FloatArray) -> FloatArray:
    return hinge_springs(parts.sheet.youngs_modulus, parts.sheet.thickness, lengths)


def _family_of_normals(parts: ShellParts, lengths: FloatArray) -> FloatArray:
    sheet = parts.sheet
    return midedge_springs(sheet.youngs_modulus, sheet.poisson_ratio, sheet.thickness, lengths)


SHELL_BENDING: Mapping[str, ShellBending] = {
    "midedge": ShellBending(
        term=_midedge,
        springs=_family_of_normals,
        free_normals=True,
        at_hinges=False,
        dihedral_factor=-0.5,
        curvature_factor=1.0,
        converges=True,
        plate="converges on every mesh",
    ),
    "hinge": ShellBending(
        term=_hinge,
        springs=_family_of_hinges,
        free_normals=False,
        at_hinges=True,
        dihedral_factor=1.0,
        curvature_factor=None,
        converges=False,
        plate="between equilateral triangles a plate of Poisson's ratio -1/3, whatever the material",
    ),
    "averaged": ShellBending(
        term=_averaged,
        springs=_family_of_normals,
        free_normals=False,
        at_hinges=False,
        dihedral_factor=-1.0,
        curvature_factor=2.0,
        converges=False,
        plate="a plate on nearly equilateral triangles",
    ),
}

HINGES: Mapping[str, Callable[[ShellParts], FloatArray]] = {
    "equal": _equal_hinges,
    "weighted": _weighted_hinges,
}
"""Stiffness of the hinges of a shell [N m], shape (H,)."""
