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

from collections.abc import Mapping
from typing import ClassVar, Protocol

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..geometry.face_rotation import face_axes
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Pattern
from ..kernels.shape import LoadKernel
from ..kinematics.dofs import DofMap
from ..kinematics.rod_frames import RodFrames
from ..laws.signal import Signal
from ..model.load import BoundLoad
from ..model.term import BoundTerm
from .follower_kernels import FOLLOWER_FACE, FOLLOWER_FRAMED, FOLLOWER_PLANAR


class Carrier(Protocol):
    """What loads turn with: K parts of the body."""

    @property
    def kernel(self) -> LoadKernel:
        """The force: it names the components ``force_`` in the frame, and the ``share_`` of each node."""

    @property
    def dofs(self) -> IntArray:
        """DOFs of each part, positions of its nodes first, shape (K, D)."""

    @property
    def rest(self) -> FloatArray:
        """Frames at rest, one unit vector per row, shape (K, 2 or 3, 3)."""

    @property
    def constants(self) -> Mapping[str, FloatArray]:
        """What else the kernel reads of each part, shape (K,)."""

    @property
    def places(self) -> IntArray:
        """Auxiliary inputs of each part, shape (K, A)."""


@frozen
class PlanarEdges:
    """Rod edges of a planar scene: tangent and the normal in the plane.

    Attributes:
        dofs: DOFs of tail and head, shape (K, 4).
        rest: Frames at rest, shape (K, 2, 3).
    """

    dofs: IntArray
    rest: FloatArray
    kernel: ClassVar[LoadKernel] = FOLLOWER_PLANAR
    constants: ClassVar[Mapping[str, FloatArray]] = {}

    @classmethod
    def of(cls, dofs: DofMap, edges: IntArray, nodes: FloatArray) -> PlanarEdges:
        """Build for the edges (K, 2) between nodes at rest (N, 3)."""
        e = dofs.project(nodes[edges[:, 1]] - nodes[edges[:, 0]])
        t = e / np.linalg.norm(e, axis=1)[:, None]
        normal = np.stack((-t[:, 1], t[:, 0]), axis=1)
        rest = np.stack((dofs.embed(t), dofs.embed(normal)), axis=1)
        return cls(dofs.of_nodes(edges).reshape(len(edges), 4), rest)

    @property
    def places(self) -> IntArray:
        """None."""
        return np.empty((len(self.dofs), 0), dtype=np.int64)


@frozen
class FramedEdges:
    """Rod edges with material frames: tangent, m1, m2.

    Attributes:
        dofs: DOFs of tail, head and angle, shape (K, 7).
        rest: Frames at rest, shape (K, 3, 3).
        places: Places of m1 (3) and m2 (3) in the auxiliary array of the frames, shape (K, 6).
    """

    dofs: IntArray
    rest: FloatArray
    places: IntArray
    kernel: ClassVar[LoadKernel] = FOLLOWER_FRAMED
    constants: ClassVar[Mapping[str, FloatArray]] = {}

    @classmethod
    def of(cls, dofs: DofMap, frames: RodFrames, edges: IntArray, q: FloatArray) -> FramedEdges:
        """Build for some edges (K,) at rest at ``q`` (n,)."""
        ends = (frames.tails[:, edges], frames.heads[:, edges], frames.angles[edges][None])
        at_rest = frames.rest(q)
        t, m1 = at_rest.tangent[:, edges].T, at_rest.director[:, edges].T
        rest = np.stack((t, m1, np.cross(t, m1)), axis=1)
        return cls(np.concatenate(ends).T, rest, frames.director_places(edges).reshape(-1, 6))


@frozen
class Faces:
    """Triangles: unit vectors along, across and normal, turned by their polar rotation.

    Attributes:
        dofs: DOFs of the corners, shape (K, 9).
        rest: Frames at rest, shape (K, 3, 3).
        constants: Those of ``geometry/face_rotation.py`` [1/m].
    """

    dofs: IntArray
    rest: FloatArray
    constants: Mapping[str, FloatArray]
    kernel: ClassVar[LoadKernel] = FOLLOWER_FACE

    @classmethod
    def of(cls, dofs: DofMap, triangles: IntArray, nodes: FloatArray) -> Faces:
        """Build for triangles (K, 3) between nodes at rest (N, 3)."""
        x = nodes[triangles]
        gauge, frames = face_axes(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
        constants = dict(zip(("alpha", "beta_u", "beta_v"), gauge, strict=True))
        return cls(dofs.of_nodes(triangles).reshape(len(triangles), 9), frames, constants)

    @property
    def places(self) -> IntArray:
        """None."""
        return np.empty((len(self.dofs), 0), dtype=np.int64)


@frozen
class FollowerForce:
    """Forces on the nodes of carriers, turning with them.

    Attributes:
        name: Unique name.
        carrier: What the forces turn with.
        shares: Weight of the force on each node of each carrier [1 or m], shape (K, m).
        local: Force at unit scale in the frames of the carriers [N or N/m], shape (K, 2 or 3).
        signal: Scale over time [1].
    """

    name: str
    carrier: Carrier
    shares: FloatArray
    local: FloatArray
    signal: Signal
    velocity_dependent: ClassVar[bool] = False

    @classmethod
    def of(
        cls, name: str, carrier: Carrier, shares: FloatArray, force: FloatArray, signal: Signal
    ) -> FollowerForce:
        """Build from the force at rest, shape (3,)."""
        return cls(name, carrier, shares, carrier.rest @ force, signal)

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """All DOFs of each carrier, unsymmetric."""
        return (Coupling(self.carrier.dofs, symmetric=False),)

    def bind(self, pattern: Pattern, driver: Driver) -> BoundTerm:
        """Make the loop."""
        on = self.carrier
        parameters = {
            **{f"force_{k}": component for k, component in enumerate(self.local.T)},
            **on.constants,
            **{f"share_{k}": share for k, share in enumerate(self.shares.T)},
        }
        return BoundLoad.of(
            self.name, on.kernel, on.dofs, parameters, self.signal, pattern, driver, on.places
        )
