"""Follower loads: forces given at rest that turn with the part of the body that carries them.

A carrier (an edge of a rod, a triangle of a shell) has a right-handed frame with the unit vectors g_i,
G_i at rest. A force F at rest is f = sum_i (F.G_i) g_i in the bent state, so a change of the carrier's
shape, which turns the frame by the small angles w = S dq, changes it by w x f: the tangent is -f x S,
unsymmetric. Follower loads have no potential: they may drive flutter.

Frames of rod edges turn as if parallel-transported from the trial point on (S of an edge with an angle
has no part of its nodes about the tangent), as in the elastic energies. The load does no work on the angles,
so it balances no torque there, and the skew term of ``forces/moment.py`` vanishes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from ..arrays import FloatArray, IntArray
from ..geometry.face_rotation import face_axes, face_frame
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Pattern
from ..kinematics.dofs import DofMap
from ..kinematics.rod_frames import RodFrames
from ..laws.laws import Law
from ..model.clique import BoundCliques
from ..model.configuration import Configuration
from ..model.term import BoundTerm


class Carrier(Protocol):
    """What loads turn with: K parts of the body."""

    @property
    def dofs(self) -> IntArray:
        """DOFs of each part, positions of its nodes first, shape (K, D)."""

    @property
    def axes(self) -> tuple[int, ...]:
        """Space axes of the position DOFs."""

    @property
    def rest(self) -> FloatArray:
        """Frames at rest, one unit vector per row, shape (K, 3, 3)."""

    def turned(self, c: Configuration) -> tuple[FloatArray, FloatArray]:
        """Frames (K, 3, 3), and the small angles by which each DOF turns them, shape (K, D, 3)."""


@dataclass(frozen=True, slots=True)
class PlanarEdges:
    """Rod edges of a planar scene: tangent, the normal in the plane, and that of the plane.

    Attributes:
        dofs: DOFs of tail and head, shape (K, 4).
        axes: Space axes of the plane.
        rest: Frames at rest, shape (K, 3, 3).
    """

    dofs: IntArray
    axes: tuple[int, ...]
    rest: FloatArray

    @classmethod
    def of(cls, dofs: DofMap, edges: IntArray, nodes: FloatArray) -> PlanarEdges:
        """Build for the edges (K, 2) between nodes at rest (N, 3)."""
        frames = _planar_frames(dofs.axes, nodes[edges[:, 1]] - nodes[edges[:, 0]])
        return cls(dofs.of_nodes(edges).reshape(len(edges), 4), dofs.axes, frames)

    def turned(self, c: Configuration) -> tuple[FloatArray, FloatArray]:
        """See :class:`Carrier`."""
        x = c.q[self.dofs]
        e = np.zeros((len(x), 3))
        e[:, list(self.axes)] = x[:, 2:] - x[:, :2]
        spin = _spin_of_head(e)[:, list(self.axes)]
        return _planar_frames(self.axes, e), np.concatenate((-spin, spin), axis=1)


@dataclass(frozen=True, slots=True)
class FramedEdges:
    """Rod edges with material frames: tangent, m1, m2.

    Attributes:
        dofs: DOFs of tail, head and angle, shape (K, 7).
        axes: All three.
        rest: Frames at rest, shape (K, 3, 3).
        directors: Places of m1 (3) and m2 (3) in the auxiliary array of the frames, shape (K, 6).
    """

    dofs: IntArray
    axes: tuple[int, ...]
    rest: FloatArray
    directors: IntArray

    @classmethod
    def of(cls, dofs: DofMap, frames: RodFrames, edges: IntArray, q: FloatArray) -> FramedEdges:
        """Build for some edges (K,) at rest at ``q`` (n,)."""
        ends = (frames.tails[:, edges], frames.heads[:, edges], frames.angles[edges][None])
        at_rest = frames.rest(q)
        t, m1 = at_rest.tangent[:, edges].T, at_rest.director[:, edges].T
        rest = np.stack((t, m1, np.cross(t, m1)), axis=1)
        return cls(np.concatenate(ends).T, dofs.axes, rest, frames.director_places(edges))

    def turned(self, c: Configuration) -> tuple[FloatArray, FloatArray]:
        """See :class:`Carrier`."""
        x = c.q[self.dofs]
        e = x[:, 3:6] - x[:, :3]
        t = e / np.linalg.norm(e, axis=1)[:, None]
        directors = c.frames.auxiliary[self.directors].reshape(-1, 2, 3)
        spin = _spin_of_head(e)
        frames = np.concatenate((t[:, None], directors), axis=1)
        return frames, np.concatenate((-spin, spin, t[:, None]), axis=1)


@dataclass(frozen=True, slots=True)
class Faces:
    """Triangles: unit vectors along, across and normal, turned by their polar rotation.

    Attributes:
        dofs: DOFs of the corners, shape (K, 9).
        axes: All three.
        rest: Frames at rest, shape (K, 3, 3).
        gauge: Constants of ``geometry/face_rotation.py`` [1/m], shape (3, K).
    """

    dofs: IntArray
    axes: tuple[int, ...]
    rest: FloatArray
    gauge: FloatArray

    @classmethod
    def of(cls, dofs: DofMap, triangles: IntArray, nodes: FloatArray) -> Faces:
        """Build for triangles (K, 3) between nodes at rest (N, 3)."""
        x = nodes[triangles]
        gauge, frames = face_axes(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
        return cls(dofs.of_nodes(triangles).reshape(len(triangles), 9), dofs.axes, frames, gauge)

    def turned(self, c: Configuration) -> tuple[FloatArray, FloatArray]:
        """See :class:`Carrier`."""
        x = np.ascontiguousarray(c.q[self.dofs].T)
        u, v = x[3:6] - x[0:3], x[6:9] - x[0:3]
        f, h, n, _, area, pu, pv = face_frame(u, v, *self.gauge)
        # about n as the polar rotation says, across it as n turns: w = n (p.d) + (u n.dv - v n.du)/area
        by_u = np.einsum("ik,jk->kij", pu, n) - np.einsum("ik,jk->kij", n, v / area)
        by_v = np.einsum("ik,jk->kij", pv, n) + np.einsum("ik,jk->kij", n, u / area)
        frames = np.stack((f, h, n)).transpose(2, 0, 1)
        return frames, np.concatenate((-by_u - by_v, by_u, by_v), axis=1)


@dataclass(frozen=True, slots=True)
class FollowerForce:
    """Forces on the nodes of carriers, turning with them.

    Attributes:
        name: Unique name.
        carrier: What the forces turn with.
        shares: Weight of the force on each node of each carrier [1 or m], shape (K, m).
        local: Force at unit scale in the frames of the carriers [N or N/m], shape (K, 3).
        law: Scale over time [1].
    """

    name: str
    carrier: Carrier
    shares: FloatArray
    local: FloatArray
    law: Law
    velocity_dependent: ClassVar[bool] = False

    @classmethod
    def of(
        cls, name: str, carrier: Carrier, shares: FloatArray, force: FloatArray, law: Law
    ) -> FollowerForce:
        """Build from the force at rest, shape (3,)."""
        return cls(name, carrier, shares, carrier.rest @ force, law)

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """All DOFs of each carrier, unsymmetric."""
        return (Coupling(self.carrier.dofs, symmetric=False),)

    def bind(self, pattern: Pattern, driver: Driver) -> BoundTerm:
        """Look the entries up."""
        return BoundCliques.of(self.name, self.carrier.dofs, pattern, self._evaluate)

    def _evaluate(self, c: Configuration) -> tuple[FloatArray, FloatArray]:
        axes = list(self.carrier.axes)
        frames, spin = self.carrier.turned(c)
        force = float(self.law(c.t)) * np.einsum("ki,kij->kj", self.local, frames)
        slope = np.cross(spin, force[:, None, :])  # of the force, by DOF
        count, nodes = self.shares.shape
        size = spin.shape[1]
        residual, tangent = np.zeros((count, size)), np.zeros((count, size, size))
        moved = nodes * len(axes)
        residual[:, :moved] = -(self.shares[:, :, None] * force[:, None, axes]).reshape(count, moved)
        by_node = self.shares[:, :, None, None] * slope.transpose(0, 2, 1)[:, None, axes]
        tangent[:, :moved] = -by_node.reshape(count, moved, size)
        return residual, tangent


def _planar_frames(axes: tuple[int, ...], e: FloatArray) -> FloatArray:
    """Tangent, normal in the plane, normal of the plane, shape (K, 3, 3)."""
    t = e / np.linalg.norm(e, axis=1)[:, None]
    across = np.zeros_like(t)
    across[:, [axis for axis in range(3) if axis not in axes]] = 1.0
    return np.stack((t, np.cross(across, t), across), axis=1)


def _spin_of_head(e: FloatArray) -> FloatArray:
    """Small angles t x de / l by which each component of the head turns an edge, shape (K, 3, 3)."""
    spin: FloatArray = np.cross(e[:, None, :], np.eye(3)) / (e * e).sum(axis=1)[:, None, None]
    return spin
