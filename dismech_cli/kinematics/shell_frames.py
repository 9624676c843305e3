"""Mid-edge normals of shells, carried from step to step like the frames of rods.

Each shell edge stores its tangent, its normal and the angle xi at the start of the step; at a trial
point the normal is parallel-transported with the edge and turned about it by the change of xi. The
kernels do this themselves from the stored values, which are therefore their auxiliary inputs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..geometry.rotation import rotate_about, signed_angle
from ..kernels.driver import Driver
from .dofs import DofMap
from .rod_frames import Frames, FrameState, TrialFrames, edge_frame
from .turning import TurningEdges


@frozen
class ShellFrames:
    """Frames of a scene with free mid-edge normals: those of its rods, then those of its shells.

    The auxiliary array is that of the rods, then the stored tangents and normals of all shell edges by
    component, then their stored angles.

    Attributes:
        rods: Frames of the rods, or ``NoFrames()``.
        tails: Position DOFs of the first node of each shell edge, shape (3, B).
        heads: Position DOFs of the second node, shape (3, B).
        angles: DOFs xi, shape (B,).
        corners: Position DOFs of the corners of the two triangles at each edge, the one triangle
            twice at a rim, shape (B, 2, 3, 3).
        driver: Runs the transport.
    """

    rods: Frames
    tails: IntArray
    heads: IntArray
    angles: IntArray
    corners: IntArray
    driver: Driver

    @classmethod
    def of(
        cls,
        dofs: DofMap,
        rods: Frames,
        edges: IntArray,
        normals: IntArray,
        edge_faces: IntArray,
        triangles: IntArray,
        driver: Driver,
    ) -> ShellFrames:
        """Build for the edges of a shell.

        Args:
            dofs: Numbering; carries one xi for each normal.
            rods: Frames of the rods, or ``NoFrames()``.
            edges: Shell edges, shape (B, 2).
            normals: Number of the normal of each edge, shape (B,): edges that turn as one share it.
            edge_faces: Triangles at each edge, -1 where there is no second, shape (B, 2).
            triangles: Shape (T, 3).
            driver: Runs the transport.
        """
        faces = np.where(edge_faces >= 0, edge_faces, edge_faces[:, :1])
        return cls(
            rods,
            np.ascontiguousarray(dofs.of_nodes(edges[:, 0]).T),
            np.ascontiguousarray(dofs.of_nodes(edges[:, 1]).T),
            dofs.of_normals(normals),
            dofs.of_nodes(triangles[faces]),
            driver,
        )

    @property
    def size(self) -> int:
        """Length of the auxiliary array."""
        return self.rods.size + 7 * len(self.angles)

    @property
    def tables(self) -> None:
        """None: normals of shells are carried too."""
        return None

    def edge_places(self, edges: IntArray) -> IntArray:
        """Places of the stored tangent (3), normal (3) and xi of each shell edge, shape (..., 7)."""
        return self.rods.size + edges[..., None] + np.arange(7) * len(self.angles)

    def rest(self, q: FloatArray) -> FrameState:
        """Normals of the rest shape: the mean of the two faces, and their angles."""
        e = q[self.heads] - q[self.tails]
        return replace(
            self.rods.rest(q),
            edge_tangent=e / np.sqrt((e * e).sum(axis=0)),
            edge_normal=self.mean_normals(q),
            edge_angle=q[self.angles].copy(),
        )

    def transport(self, stored: FrameState, q: FloatArray) -> TrialFrames:
        """Hand the stored normals to the kernels and find those at ``q``."""
        rods = self.rods.transport(stored, q)
        inputs = np.empty((10, len(self.angles)))
        np.subtract(q[self.heads], q[self.tails], out=inputs[0:3])
        inputs[3:6] = stored.edge_tangent
        inputs[6:9] = stored.edge_normal
        np.subtract(q[self.angles], stored.edge_angle, out=inputs[9])
        out = self.driver.map(edge_frame, inputs, 12)
        state = replace(
            rods.state, edge_tangent=out[6:9], edge_normal=out[0:3], edge_angle=q[self.angles].copy()
        )
        auxiliary = np.concatenate(
            (
                rods.auxiliary,
                stored.edge_tangent.reshape(-1),
                stored.edge_normal.reshape(-1),
                stored.edge_angle,
            )
        )
        return TrialFrames(state, auxiliary)

    @property
    def turning(self) -> tuple[TurningEdges, ...]:
        """Those of the rods, and the shell edges: their kernels transport the normals themselves."""
        return (*self.rods.turning, TurningEdges(self.tails, self.heads, self.angles, varied=True))

    def turned(self, stored: FrameState, q: FloatArray, turns: Sequence[FloatArray]) -> FrameState:
        """Frames at ``q``, turned about their edges."""
        at = self.transport(stored, q).state
        rods = self.rods.turned(stored, q, turns[:-1])
        normal = np.stack(rotate_about(at.edge_normal, at.edge_tangent, turns[-1]))
        return replace(at, director=rods.director, reference_twist=rods.reference_twist, edge_normal=normal)

    def turns(self, one: FrameState, other: FrameState) -> tuple[FloatArray, ...]:
        """Angles between the reference directors of rods, then between normals."""
        angle = signed_angle(one.edge_normal, other.edge_normal, one.edge_tangent)
        return (*self.rods.turns(one, other), angle)

    def run_by(self, driver: Driver) -> ShellFrames:
        """The same, carried by another driver."""
        return replace(self, rods=self.rods.run_by(driver), driver=driver)

    def turned_to_faces(self, state: FrameState, q: FloatArray) -> FloatArray:
        """Normals halfway between the faces of each edge at ``q``, shape (3, B).

        Edges that share a normal turn together, as they do in the mean, and keep their angles.
        """
        faces = self.mean_normals(q)
        _, inverse, counts = np.unique(self.angles, return_inverse=True, return_counts=True)
        shared = counts[inverse] > 1
        if not shared.any():
            return faces
        tangent, stored = state.edge_tangent, state.edge_normal
        mean = np.bincount(inverse, signed_angle(stored, faces, tangent)) / counts
        turn = mean[inverse]
        turned = np.cos(turn) * stored + np.sin(turn) * np.cross(tangent.T, stored.T).T
        return np.where(shared, turned, faces)

    def mean_normals(self, q: FloatArray) -> FloatArray:
        """Unit normals halfway between the faces of each edge, shape (3, B)."""
        x = q[self.corners]
        normal = np.cross(x[:, :, 1] - x[:, :, 0], x[:, :, 2] - x[:, :, 0])
        normal /= np.linalg.norm(normal, axis=2)[:, :, None]
        mean = normal.sum(axis=1)
        return np.ascontiguousarray((mean / np.linalg.norm(mean, axis=1)[:, None]).T)
