"""One shell on the way to its energies, and what all shells stand on."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...kinematics.dofs import DofMap
from ...kinematics.shell_frames import ShellFrames
from ...mesh.measure import adjacent_areas, triangle_areas
from ...mesh.topology.shells import ShellTopology
from ...scenario.language.geometry import Shell
from ..bodies.shell import ShellProperties


@frozen
class ShellBody:
    """What belongs to one shell alone.

    Attributes:
        shell: As in the scenario.
        sheet: Its stiffness.
        triangles: Its triangles, shape (T, 3).
        topology: Its edges and hinges, in the scene's node numbers.
        first: Number of its first edge among those that carry a normal.
        share: Part of the stiffness of each hinge that is left beside sheets welded to it, shape (H,).
        times: Relaxation time of each hinge [s], shape (H,).
    """

    shell: Shell
    sheet: ShellProperties
    triangles: IntArray
    topology: ShellTopology
    first: int
    share: FloatArray
    times: FloatArray

    def on_edges(self, positions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Young's modulus [Pa] and thickness [m] at each edge, shape (B,): stretched side by side."""
        modulus, thickness, area = self.sides(positions)
        share = area / area.sum(axis=1, keepdims=True)
        mean = (share * thickness).sum(axis=1)
        tension = (share * thickness * modulus).sum(axis=1)
        # without the rounding of a mean where both sides are the same
        alike = (modulus[:, 0] == modulus[:, 1]) & (thickness[:, 0] == thickness[:, 1])
        return np.where(alike, modulus[:, 0], tension / mean), np.where(alike, thickness[:, 0], mean)

    def sides(self, positions: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Modulus [Pa], thickness [m] and area [m^2] on both sides of edges, a rim's twice, shape (B, 2)."""
        faces = self.topology.edge_faces
        faces = np.where(faces >= 0, faces, faces[:, :1])
        area = triangle_areas(positions, self.triangles)[faces]
        return self.sheet.youngs_modulus[faces], self.sheet.thickness[faces], area

    def adjacent_areas(self, positions: FloatArray) -> FloatArray:
        """Area of the triangles at each edge [m^2], shape (B,)."""
        return adjacent_areas(self.topology.edge_faces, triangle_areas(positions, self.triangles))


class Ground(Protocol):
    """What the makers of energies may look at beside the shell: a part of the structure."""

    @property
    def dofs(self) -> DofMap:
        """Numbering."""

    @property
    def positions(self) -> FloatArray:
        """Rest positions of all nodes with DOFs [m], shape (n_nodes, 3)."""

    @property
    def normals(self) -> ShellFrames:
        """Frames of the edges that carry a normal."""
