"""Reference and material frames of rod edges, transported in time (Bergou et al. 2010).

Frames are stored at the start of a step and transported to each trial point from there, never
chained over Newton iterates: a rejected step leaves no trace.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field, replace
from typing import Any, ClassVar, Protocol

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..geometry.kernel import kernel
from ..geometry.rotation import orthonormal_to, parallel_transport, rotate_about, signed_angle
from ..geometry.vectors import combine, cross, norm, scale
from ..kernels.driver import Driver
from .turning import TurningEdges

_NO_VECTORS, _NO_NUMBERS = np.empty((3, 0)), np.empty(0)


def _no_vectors() -> FloatArray:
    return _NO_VECTORS


def _no_numbers() -> FloatArray:
    return _NO_NUMBERS


@frozen
class FrameState:
    """Frames at an accepted state.

    Attributes:
        tangent: Unit tangents, shape (3, E).
        director: First reference directors a1, shape (3, E).
        reference_twist: Unwrapped reference twist of each joint [rad], shape (J,).
        edge_tangent: Unit tangents of shell edges with a free normal, shape (3, B).
        edge_normal: Their mid-edge normals, shape (3, B).
        edge_angle: Their angles xi [rad], shape (B,).
    """

    tangent: FloatArray
    director: FloatArray
    reference_twist: FloatArray
    edge_tangent: FloatArray = field(default_factory=_no_vectors)
    edge_normal: FloatArray = field(default_factory=_no_vectors)
    edge_angle: FloatArray = field(default_factory=_no_numbers)


@frozen
class TrialFrames:
    """Frames at a trial point.

    Attributes:
        state: What an accepted step will store.
        auxiliary: Inputs of kernels, shape (size,); the frames that made it know what is where.
    """

    state: FrameState
    auxiliary: FloatArray


class FramesAt(Protocol):
    """Frames at a trial point, carried there or yet to be."""

    @property
    def state(self) -> FrameState:
        """What an accepted step will store."""

    @property
    def auxiliary(self) -> FloatArray:
        """Inputs of kernels, shape (size,)."""


@frozen
class EdgeTables:
    """Where frames of edges are carried, for loops that carry them with all else.

    Attributes:
        tails: Position DOFs of the first node of each edge, shape (3, E).
        heads: Position DOFs of the second node, shape (3, E).
        angles: Angle DOFs, shape (E,).
        joint_edges: Edge pairs of the joints, shape (J, 2).
        joint_signs: -1 where a joint walks its edge backwards, shape (J, 2).
    """

    tails: IntArray
    heads: IntArray
    angles: IntArray
    joint_edges: IntArray
    joint_signs: FloatArray


class Frames(Protocol):
    """Kinematics of frames."""

    @property
    def tables(self) -> EdgeTables | None:
        """What is carried if that is edges of rods alone, or nothing; else None."""

    @property
    def size(self) -> int:
        """Length of the auxiliary array."""

    def rest(self, q: FloatArray) -> FrameState:
        """Frames of the rest shape."""

    def transport(self, stored: FrameState, q: FloatArray) -> TrialFrames:
        """Frames at ``q``, parallel-transported from the stored ones."""

    @property
    def turning(self) -> tuple[TurningEdges, ...]:
        """Edges whose frames are carried, those of rods before those of shells."""

    def turned(self, stored: FrameState, q: FloatArray, turns: Sequence[FloatArray]) -> FrameState:
        """Frames at ``q`` transported from the stored ones and turned about their edges.

        Args:
            stored: Where the transport starts.
            q: Where it ends, shape (n,).
            turns: Angles of the edges of each of ``turning`` [rad], each of shape (E,).
        """

    def turns(self, one: FrameState, other: FrameState) -> tuple[FloatArray, ...]:
        """Angles [rad] from frames to others about the same tangents, as :meth:`turned` takes them."""

    def run_by(self, driver: Driver) -> Frames:
        """The same, carried by another driver."""


_NOTHING = FrameState(_NO_VECTORS, _NO_VECTORS, _NO_NUMBERS)
_NO_FRAMES = TrialFrames(_NOTHING, _NO_NUMBERS)


class NoFrames:
    """For scenes without framed rods: nothing to carry, nothing to transport."""

    size: ClassVar[int] = 0

    @property
    def tables(self) -> EdgeTables:
        """Nothing is carried."""
        ends, none = np.empty((3, 0), dtype=np.int64), np.empty((0, 2))
        return EdgeTables(ends, ends, ends[0], none.astype(np.int64), none)

    def rest(self, q: FloatArray) -> FrameState:
        """Return the empty frames."""
        return _NOTHING

    def transport(self, stored: FrameState, q: FloatArray) -> TrialFrames:
        """Return the empty frames."""
        return _NO_FRAMES

    @property
    def turning(self) -> tuple[TurningEdges, ...]:
        """None."""
        return ()

    def turned(self, stored: FrameState, q: FloatArray, turns: Sequence[FloatArray]) -> FrameState:
        """Return the empty frames."""
        return _NOTHING

    def turns(self, one: FrameState, other: FrameState) -> tuple[FloatArray, ...]:
        """None."""
        return ()

    def run_by(self, driver: Driver) -> NoFrames:
        """The same: there is nothing to carry."""
        return self


@kernel
def edge_frame(x: Any) -> Any:
    """Tangent, transported a1, material m1 and m2 of one edge.

    Input: edge vector (3), stored tangent (3), stored a1 (3), theta.
    """
    e, t0, d0 = x[0:3], x[3:6], x[6:9]
    t = scale(1.0 / norm(e), e)
    a1 = orthonormal_to(parallel_transport(d0, t0, t), t)
    a2 = cross(t, a1)
    c, s = np.cos(x[9]), np.sin(x[9])
    m1, m2 = combine(c, a1, s, a2), combine(-s, a1, c, a2)
    return (
        m1[0], m1[1], m1[2], m2[0], m2[1], m2[2],
        t[0], t[1], t[2], a1[0], a1[1], a1[2],
    )  # fmt: skip


@kernel
def joint_reference_twist(x: Any) -> Any:
    """Reference twist of one joint, unwrapped against the stored value.

    Input: signed tangents of both edges (3 + 3), their a1 (3 + 3), stored reference twist. The
    transported director is first turned back by the stored twist, so only the change since then
    passes through atan2 and no 2 pi jump can occur while it stays below pi.
    """
    te, tf, ae, af, stored = x[0:3], x[3:6], x[6:9], x[9:12], x[12]
    u = rotate_about(parallel_transport(ae, te, tf), tf, stored)
    return (stored + signed_angle(u, af, tf),)


@frozen
class RodFrames:
    """Frames of the edges that carry an angle.

    The auxiliary array holds m1 and m2 of all edges by component, then the reference twists.

    Attributes:
        tails: Position DOFs of the first node of each edge, shape (3, E).
        heads: Position DOFs of the second node, shape (3, E).
        angles: Angle DOFs, shape (E,).
        joint_edges: Edge pairs of the joints, shape (J, 2).
        joint_signs: -1 where a joint walks its edge backwards, shape (J, 2).
        directors: First directors at rest, made unit and normal to the edges before use, shape (3, E).
        driver: Runs the two kernels.
    """

    tails: IntArray
    heads: IntArray
    angles: IntArray
    joint_edges: IntArray
    joint_signs: FloatArray
    directors: FloatArray
    driver: Driver
    _at_joints: IntArray = field(init=False, repr=False)
    _signs: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Look up once what each joint reads of (tangents, directors), shape (12, J), and with what sign."""
        edges, signs, row = self.joint_edges.T, self.joint_signs.T, np.arange(3)[:, None] * len(self.angles)
        both = np.concatenate((row + edges[0], row + edges[1]))
        object.__setattr__(self, "_at_joints", np.concatenate((both, both + 3 * len(self.angles))))
        object.__setattr__(self, "_signs", np.repeat(signs, 3, axis=0))

    @property
    def size(self) -> int:
        """Length of the auxiliary array."""
        return 6 * len(self.angles) + len(self.joint_edges)

    @property
    def tables(self) -> EdgeTables:
        """All edges."""
        return EdgeTables(self.tails, self.heads, self.angles, self.joint_edges, self.joint_signs)

    def director_places(self, edges: IntArray) -> IntArray:
        """Places of m1 (3) and m2 (3) of each edge in the auxiliary array, shape (..., 6)."""
        return edges[..., None] + np.arange(6) * len(self.angles)

    def twist_places(self, joints: IntArray) -> IntArray:
        """Places of the reference twist of each joint in the auxiliary array, shape (...)."""
        return 6 * len(self.angles) + joints

    def rest(self, q: FloatArray) -> FrameState:
        """Frames of the rest shape: the directors made normal, reference twist against zero."""
        e = q[self.heads] - q[self.tails]
        tangent = e / np.sqrt((e * e).sum(axis=0))
        director = orthonormal_to(self.directors, tangent)
        return FrameState(
            tangent, director, self.reference_twist(tangent, director, np.zeros(len(self.joint_edges)))
        )

    def transport(self, stored: FrameState, q: FloatArray) -> TrialFrames:
        """Frames at ``q``, parallel-transported from the stored ones."""
        inputs = np.empty((10, len(self.angles)))
        # mode="clip" lets NumPy gather without a second buffer; all indices are valid
        q.take(self.heads, out=inputs[0:3], mode="clip")
        inputs[0:3] -= q.take(self.tails, mode="clip")
        inputs[3:6] = stored.tangent
        inputs[6:9] = stored.director
        q.take(self.angles, out=inputs[9], mode="clip")
        out = self.driver.map(edge_frame, inputs, 12)
        beta = self._reference_twist(out[6:12], stored.reference_twist)
        return TrialFrames(FrameState(out[6:9], out[9:12], beta), np.concatenate((out[0:6].ravel(), beta)))

    @property
    def turning(self) -> tuple[TurningEdges, ...]:
        """All edges; kernels vary frames as if they were stored where they are."""
        return (TurningEdges(self.tails, self.heads, self.angles, varied=False),)

    def turned(self, stored: FrameState, q: FloatArray, turns: Sequence[FloatArray]) -> FrameState:
        """Frames at ``q``, turned about their edges."""
        at = self.transport(stored, q).state
        director = np.stack(rotate_about(at.director, at.tangent, turns[0]))
        twist = self.reference_twist(at.tangent, director, stored.reference_twist)
        return replace(at, director=director, reference_twist=twist)

    def turns(self, one: FrameState, other: FrameState) -> tuple[FloatArray, ...]:
        """Angles between the reference directors."""
        return (signed_angle(one.director, other.director, one.tangent),)

    def run_by(self, driver: Driver) -> RodFrames:
        """The same, carried by another driver."""
        return replace(self, driver=driver)

    def reference_twist(self, tangent: FloatArray, director: FloatArray, stored: FloatArray) -> FloatArray:
        """Reference twist of each joint, the one next to a stored one [rad], shape (J,)."""
        return self._reference_twist(np.concatenate((tangent, director)), stored)

    def _reference_twist(self, carried: FloatArray, stored: FloatArray) -> FloatArray:
        """The same of tangents over directors, shape (6, E)."""
        inputs = np.empty((13, len(stored)))
        carried.take(self._at_joints, out=inputs[0:12], mode="clip")
        inputs[0:6] *= self._signs
        inputs[12] = stored
        beta: FloatArray = self.driver.map(joint_reference_twist, inputs, 1)[0]
        return beta
