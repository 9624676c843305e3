"""One shell on the way to its energies."""

from __future__ import annotations

from dataclasses import dataclass

from ...arrays import FloatArray, IntArray
from ...kinematics.dofs import DofMap
from ...kinematics.shell_frames import ShellFrames
from ...mesh.topology.shells import ShellTopology
from ...scenario.language.geometry import Shell
from ...sections.shells import adjacent_areas, triangle_areas
from ..bodies.shell import ShellProperties


@dataclass(frozen=True, slots=True)
class ShellParts:
    """What the makers of its energies may look at.

    Attributes:
        shell: As in the scenario.
        sheet: Its stiffness.
        positions: Rest positions of all nodes with DOFs [m], shape (n_nodes, 3).
        triangles: Its triangles, shape (T, 3).
        topology: Its edges and hinges.
        dofs: Numbering.
        normals: Free normals of the scene; None if it has none.
        first: Number of the shell's first free normal.
    """

    shell: Shell
    sheet: ShellProperties
    positions: FloatArray
    triangles: IntArray
    topology: ShellTopology
    dofs: DofMap
    normals: ShellFrames | None
    first: int

    def adjacent_areas(self) -> FloatArray:
        """Area of the triangles at each edge [m^2], shape (B,)."""
        return adjacent_areas(self.topology.edge_faces, triangle_areas(self.positions, self.triangles))
