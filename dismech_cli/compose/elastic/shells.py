"""Shells as frames and elastic energies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from ...arrays import FloatArray
from ...kernels.driver import Driver
from ...kinematics.rod_frames import Frames
from ...kinematics.shell_frames import ShellFrames
from ...model.stencil import StencilEnergy
from ..bodies.geometry import Geometry
from ..shells.bending import bending_of
from ..shells.membrane import MEMBRANES
from ..shells.parts import ShellParts
from ..shells.topology import ShellEdges
from ..structure.numbering import Numbering


@dataclass(frozen=True, slots=True)
class ShellSystem:
    """What the shells give to the model.

    Attributes:
        frames: Frames of the whole scene.
        normals: Those of them that carry the free mid-edge normals, or None.
        membrane: Stretching energy of each shell by its name.
        bending: Bending energy of each shell by its name.
    """

    frames: Frames
    normals: ShellFrames | None
    membrane: Mapping[str, StencilEnergy]
    bending: Mapping[str, StencilEnergy]


def build_shells(
    geometry: Geometry,
    numbering: Numbering,
    free: ShellEdges,
    rod_frames: Frames,
    positions: FloatArray,
    driver: Driver,
) -> ShellSystem:
    """Make the energies of all shells.

    Args:
        geometry: The bodies.
        numbering: DOFs.
        free: Edges of the shells, and those with a free normal.
        rod_frames: Frames of the rods, or their absence.
        positions: Rest positions of all nodes with DOFs [m], shape (n_nodes, 3).
        driver: Runs the kernels.
    """
    dofs = numbering.dofs
    frames = rod_frames
    normals: ShellFrames | None = None
    if len(free.edges):
        frames = normals = ShellFrames.of(
            dofs, rod_frames, free.edges, free.edge_faces, free.triangles, driver
        )
    membrane: dict[str, StencilEnergy] = {}
    bending: dict[str, StencilEnergy] = {}
    for shell, sheet in zip(geometry.shells, geometry.sheets, strict=True):
        parts = ShellParts(
            shell,
            sheet,
            positions,
            geometry.triangles[geometry.triangles_of(shell.name)],
            free.topologies[shell.name],
            dofs,
            normals,
            free.first.get(shell.name, 0),
        )
        membrane[shell.name] = MEMBRANES[shell.membrane](parts)
        bent = bending_of(shell).term(parts)
        bending[shell.name] = _flattened(bent) if shell.natural.shape == "flat" else bent
    return ShellSystem(frames, normals, membrane, bending)


def _flattened(energy: StencilEnergy) -> StencilEnergy:
    """The same energy, unbent where all its angles vanish."""
    parameters = energy.parameters.copy()
    parameters[: energy.kernel.naturals] = 0.0
    return replace(energy, parameters=parameters)
