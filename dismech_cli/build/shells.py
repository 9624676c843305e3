"""Shells as frames and elastic energies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from ..arrays import FloatArray, IntArray
from ..energies.hinge import hinge_term
from ..energies.membrane import membrane_term
from ..energies.membrane_springs import spring_term
from ..energies.midedge import midedge_term
from ..energies.midedge_averaged import midedge_averaged_term
from ..mesh.topology_shell import ShellTopology
from ..model.dofs import DofMap
from ..model.driver import Driver
from ..model.frames import Frames
from ..model.shell import (
    adjacent_areas,
    area_springs,
    edge_lengths,
    hinge_springs,
    hinge_stiffness,
    midedge_springs,
    triangle_areas,
    weighted_hinge_stiffness,
)
from ..model.shell_frames import ShellFrames
from ..model.stencil import StencilEnergy
from ..scenario.geometry import Shell
from .geometry import Geometry
from .numbering import Numbering
from .shell_body import ShellProperties
from .shell_edges import ShellEdges


@dataclass(frozen=True, slots=True)
class ShellSystem:
    """What the shells give to the model.

    Attributes:
        frames: Frames of the whole scene.
        membrane: Stretching energy of each shell by its name.
        bending: Bending energy of each shell by its name.
    """

    frames: Frames
    membrane: Mapping[str, StencilEnergy]
    bending: Mapping[str, StencilEnergy]


def build_shells(
    geometry: Geometry,
    numbering: Numbering,
    free: ShellEdges,
    rod_frames: Frames,
    offset: int,
    positions: FloatArray,
    driver: Driver,
) -> ShellSystem:
    """Make the energies of all shells.

    Args:
        geometry: The bodies.
        numbering: DOFs.
        free: Edges of the shells, and those with a free normal.
        rod_frames: Frames of the rods, or their absence.
        offset: Length of the rods' auxiliary array.
        positions: Rest positions of all nodes with DOFs [m], shape (n_nodes, 3).
        driver: Runs the kernels.
    """
    dofs = numbering.dofs
    frames = rod_frames
    normals: ShellFrames | None = None
    if len(free.edges):
        frames = normals = ShellFrames.of(
            dofs, rod_frames, offset, free.edges, free.edge_faces, free.triangles, driver
        )
    membrane: dict[str, StencilEnergy] = {}
    bending: dict[str, StencilEnergy] = {}
    for shell, sheet in zip(geometry.shells, geometry.sheets, strict=True):
        own = _Parts(
            shell,
            sheet,
            positions,
            geometry.triangles[geometry.triangles_of(shell.name)],
            free.topologies[shell.name],
            dofs,
        )
        membrane[shell.name] = own.membrane()
        bent = own.bending(normals, free.first.get(shell.name, 0))
        bending[shell.name] = _flattened(bent) if shell.natural.shape == "flat" else bent
    return ShellSystem(frames, membrane, bending)


@dataclass(frozen=True, slots=True)
class _Parts:
    """One shell on the way to its energies."""

    shell: Shell
    sheet: ShellProperties
    positions: FloatArray
    triangles: IntArray
    topology: ShellTopology
    dofs: DofMap

    def membrane(self) -> StencilEnergy:
        """The stretching energy asked for."""
        name, p, t = f"{self.shell.name}.membrane", self.sheet, self.topology
        if self.shell.membrane == "cst":
            return membrane_term(
                name,
                self.dofs,
                self.positions,
                self.triangles,
                youngs_modulus=p.youngs_modulus,
                poisson_ratio=p.poisson_ratio,
                thickness=p.thickness,
            )
        rest = edge_lengths(self.positions, t.edges)
        if self.shell.membrane == "springs":
            stiffness = area_springs(p.youngs_modulus, p.thickness, rest, self._adjacent_areas())
        elif self.shell.bending == "hinge":
            stiffness = hinge_springs(p.youngs_modulus, p.thickness, rest)
        else:
            stiffness = midedge_springs(p.youngs_modulus, p.poisson_ratio, p.thickness, rest)
        return spring_term(name, self.dofs, t.edges, rest, stiffness)

    def bending(self, normals: ShellFrames | None, first: int) -> StencilEnergy:
        """The bending energy asked for, stress-free in the rest shape."""
        name, p, t = f"{self.shell.name}.bending", self.sheet, self.topology
        if self.shell.bending == "hinge":
            stiffness = self._hinge_stiffness()
            return hinge_term(name, self.dofs, self.positions, t.hinges, stiffness)
        if self.shell.bending == "averaged":
            return midedge_averaged_term(
                name,
                self.dofs,
                self.positions,
                self.triangles,
                t.face_edges,
                t.edge_faces,
                youngs_modulus=p.youngs_modulus,
                poisson_ratio=p.poisson_ratio,
                thickness=p.thickness,
            )
        assert normals is not None
        return midedge_term(
            name,
            self.dofs,
            self.positions,
            self.triangles,
            t.face_edges + first,
            t.face_signs,
            normals,
            youngs_modulus=p.youngs_modulus,
            poisson_ratio=p.poisson_ratio,
            thickness=p.thickness,
        )

    def _hinge_stiffness(self) -> FloatArray:
        p, t = self.sheet, self.topology
        if self.shell.hinges != "weighted":
            return hinge_stiffness(p.youngs_modulus, p.thickness, len(t.hinges))
        lengths = edge_lengths(self.positions, t.edges)[t.hinge_edges]
        around = self._adjacent_areas()[t.hinge_edges]
        return weighted_hinge_stiffness(p.youngs_modulus, p.thickness, lengths, around)

    def _adjacent_areas(self) -> FloatArray:
        """Area of the triangles at each edge [m^2], shape (B,)."""
        return adjacent_areas(self.topology.edge_faces, triangle_areas(self.positions, self.triangles))


def _flattened(energy: StencilEnergy) -> StencilEnergy:
    """The same energy, unbent where all its angles vanish."""
    parameters = energy.parameters.copy()
    parameters[: energy.kernel.naturals] = 0.0
    return replace(energy, parameters=parameters)
