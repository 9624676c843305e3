"""The table of bending models of shells: all that the rest of the house knows of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ...arrays import FloatArray
from ...energies.hinge import hinge_term
from ...energies.midedge import midedge_term
from ...energies.midedge_averaged import midedge_averaged_term
from ...frozen import frozen
from ...mesh.measure import edge_lengths
from ...model.stencil import StencilEnergy
from ...scenario.language.geometry import Shell
from ...sections.shells import hinge_springs, midedge_springs
from .body import Ground, ShellBody
from .hinges import hinge_stiffnesses


@frozen
class ShellBending:
    """A bending model.

    Attributes:
        term: Makes the energy of a shell, stress-free in its rest shape.
        springs: Stiffness of the springs that the DiSMech programs put on its edges, see
            :mod:`.membrane`: at its rest positions (n_nodes, 3), shape (B,).
        has_normals: Whether every edge has a normal with an angle of its own.
        at_hinges: Whether its stencils are the hinges between two triangles, rather than the triangles.
        dihedral_factor: Change of the natural angles at a hinge when it is driven by 1: those of triangles
            count from the face and so have the other sign, and that of a normal of its own is half of it.
        curvature_factor: Change of the natural angles of a triangle per angle from its normal to that of an
            edge; None if the model knows no curvature.
        converges: Whether it is a plate on every mesh, rather than on nearly equilateral triangles.
        plate: What it is, for the plan.
    """

    term: Callable[[ShellBody, Ground], StencilEnergy]
    springs: Callable[[ShellBody, FloatArray], FloatArray]
    has_normals: bool
    at_hinges: bool
    dihedral_factor: float
    curvature_factor: float | None
    converges: bool
    plate: str


def bending_of(shell: Shell) -> ShellBending:
    """The bending model of a shell."""
    return SHELL_BENDING[shell.bending]


def _name(body: ShellBody) -> str:
    return f"{body.shell.name}.bending"


def _midedge(body: ShellBody, ground: Ground) -> StencilEnergy:
    return midedge_term(
        _name(body),
        ground.dofs,
        ground.positions,
        body.triangles,
        body.topology.face_edges + body.first,
        body.topology.face_signs,
        ground.normals,
        youngs_modulus=body.sheet.youngs_modulus,
        poisson_ratio=body.sheet.poisson_ratio,
        thickness=body.sheet.thickness,
    )


def _averaged(body: ShellBody, ground: Ground) -> StencilEnergy:
    return midedge_averaged_term(
        _name(body),
        ground.dofs,
        ground.positions,
        body.triangles,
        body.topology.face_edges,
        body.topology.edge_faces,
        youngs_modulus=body.sheet.youngs_modulus,
        poisson_ratio=body.sheet.poisson_ratio,
        thickness=body.sheet.thickness,
    )


def _hinge(body: ShellBody, ground: Ground) -> StencilEnergy:
    stiffness = body.share * hinge_stiffnesses(body, ground.positions)
    return hinge_term(_name(body), ground.dofs, ground.positions, body.topology.hinges, stiffness)


def _family_of_hinges(body: ShellBody, positions: FloatArray) -> FloatArray:
    return hinge_springs(*body.on_edges(positions), edge_lengths(positions, body.topology.edges))


def _family_of_normals(body: ShellBody, positions: FloatArray) -> FloatArray:
    modulus, thickness = body.on_edges(positions)
    lengths = edge_lengths(positions, body.topology.edges)
    return midedge_springs(modulus, body.sheet.poisson_ratio, thickness, lengths)


SHELL_BENDING: Mapping[str, ShellBending] = {
    "midedge": ShellBending(
        term=_midedge,
        springs=_family_of_normals,
        has_normals=True,
        at_hinges=False,
        dihedral_factor=-0.5,
        curvature_factor=1.0,
        converges=True,
        plate="converges on every mesh",
    ),
    "hinge": ShellBending(
        term=_hinge,
        springs=_family_of_hinges,
        has_normals=False,
        at_hinges=True,
        dihedral_factor=1.0,
        curvature_factor=None,
        converges=False,
        plate="between equilateral triangles a plate of Poisson's ratio -1/3, whatever the material",
    ),
    "averaged": ShellBending(
        term=_averaged,
        springs=_family_of_normals,
        has_normals=False,
        at_hinges=False,
        dihedral_factor=-1.0,
        curvature_factor=2.0,
        converges=False,
        plate="a plate on nearly equilateral triangles",
    ),
}
