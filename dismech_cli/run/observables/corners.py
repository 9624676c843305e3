"""What the corners of rods add to fields: the turn from rest, over the halves of both edges."""

from __future__ import annotations

from dataclasses import field
from typing import Protocol

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...kinematics.strains import corner_turns, joint_frames, planar_turns
from .snapshot import Snapshot


class CornerStrains(Protocol):
    """Strains of the joints of two edges at an angle."""

    @property
    def nodes(self) -> IntArray:
        """Node of each, shape (K,)."""

    def curvature(self, s: Snapshot) -> FloatArray:
        """Curvature by which each has bent from rest [1/m], shape (K,)."""

    def twist(self, s: Snapshot) -> FloatArray:
        """Twist from rest per length [rad/m], shape (K,)."""

    def moment(self, s: Snapshot) -> FloatArray:
        """Magnitude of the bending moment, the larger one of both edges [N m], shape (K,)."""


@frozen
class NoCorners:
    """Where rods meet straight."""

    nodes: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))

    def curvature(self, s: Snapshot) -> FloatArray:
        """No values."""
        return np.empty(0)

    def twist(self, s: Snapshot) -> FloatArray:
        """No values."""
        return np.empty(0)

    def moment(self, s: Snapshot) -> FloatArray:
        """No values."""
        return np.empty(0)


@frozen
class FramedCorners:
    """In space.

    Attributes:
        triples: Nodes, shape (K, 3).
        voronoi: Length over which each bends [m], shape (K,).
        places: Of the directors in the auxiliary array, shape (K, 12).
        signs: Of the edges, shape (K, 2).
        cosines: Between the frames of both edges at rest, by rows, shape (9, K).
        stiffness: S [N m], shape (3, 3, K).
        energy: Name of their energy.
    """

    triples: IntArray
    voronoi: FloatArray
    places: IntArray
    signs: FloatArray
    cosines: FloatArray
    stiffness: FloatArray
    energy: str

    @property
    def nodes(self) -> IntArray:
        """Node of each."""
        nodes: IntArray = self.triples[:, 1]
        return nodes

    def curvature(self, s: Snapshot) -> FloatArray:
        """Across the first edge."""
        w = self._turns(s)
        curvature: FloatArray = np.hypot(w[1], w[2]) / self.voronoi
        return curvature

    def twist(self, s: Snapshot) -> FloatArray:
        """Along the first edge."""
        twist: FloatArray = self._turns(s)[0] / self.voronoi
        return twist

    def moment(self, s: Snapshot) -> FloatArray:
        """What is not torsion of the one edge, or of the other."""
        m = np.einsum("ijk,jk->ik", self.stiffness, self._turns(s) - s.natural(self.energy))
        of_e, of_f = m[0], (m * self.cosines[0::3]).sum(axis=0)
        # the less torsion, the more bending
        bending: FloatArray = np.sqrt(
            np.maximum((m * m).sum(axis=0) - np.minimum(of_e * of_e, of_f * of_f), 0.0)
        )
        return bending

    def _turns(self, s: Snapshot) -> FloatArray:
        frames = joint_frames(s.positions, self.triples, s.frames.auxiliary, self.places, self.signs)
        return corner_turns(frames, self.cosines)


@frozen
class PlanarCorners:
    """In a plane.

    Attributes:
        triples: Nodes, shape (K, 3).
        voronoi: Length over which each bends [m], shape (K,).
        rest: Angle at rest [rad], shape (K,).
        stiffness: EI [N m^2], shape (K,).
        energy: Name of their energy.
    """

    triples: IntArray
    voronoi: FloatArray
    rest: FloatArray
    stiffness: FloatArray
    energy: str

    @property
    def nodes(self) -> IntArray:
        """Node of each."""
        nodes: IntArray = self.triples[:, 1]
        return nodes

    def curvature(self, s: Snapshot) -> FloatArray:
        """Within the plane."""
        curvature: FloatArray = np.abs(self._turns(s)) / self.voronoi
        return curvature

    def twist(self, s: Snapshot) -> FloatArray:
        """None in a plane."""
        return np.zeros(len(self.rest))

    def moment(self, s: Snapshot) -> FloatArray:
        """Within the plane."""
        elastic = np.abs(self._turns(s) - s.natural(self.energy)[0])
        moment: FloatArray = self.stiffness * elastic / self.voronoi
        return moment

    def _turns(self, s: Snapshot) -> FloatArray:
        return planar_turns(s.dofs.positions(s.state.q), self.triples, self.rest)
