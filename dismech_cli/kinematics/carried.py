"""Held nodes, edges and normals that a rigid motion carries with it.

Positions follow at once. The angle of an edge counts from a director that is transported in time, so what
it must be depends on the frames of the last accepted state: the director there, transported to the new
tangent and turned on by the spin of the step, is compared with the one that the motion carries.
"""

from __future__ import annotations

from math import inf
from typing import ClassVar

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..frozen import frozen
from ..geometry.rotation import orthonormal_to, parallel_transport, rotate_about, signed_angle
from ..laws.laws import Law
from .motion import Since
from .rigid import Rigid


@frozen
class CarriedNodes:
    """Positions that turn about lines and are displaced then.

    Attributes:
        name: Label for messages.
        dofs: Their DOFs, node by node, shape (K * d,).
        rest: Their rest positions [m], shape (K, 3).
        rigid: The rotations.
        displacement: Law of each space axis.
        places: Where the displacement is asked for, as its laws take it: 0, or shape (K,).
        axes: Space axes that the model carries, d of them.
        release: Time [s] from which they are free.
    """

    name: str
    dofs: IntArray
    rest: FloatArray
    rigid: Rigid
    displacement: tuple[Law, Law, Law]
    places: FloatArray | float
    axes: tuple[int, ...]
    release: float = inf
    remembers: ClassVar[bool] = False

    def stays(self, q: FloatArray, v: FloatArray) -> BoolArray:
        """None: they move."""
        return np.zeros(len(self.dofs), dtype=np.bool_)

    def values(self, t: float, q: FloatArray, since: Since) -> FloatArray:
        """Positions at a time, shape (K * d,)."""
        self.rigid.refuse_leaps(since.t, t)
        x = self.rigid.moved(t, self.rest)
        d = np.stack([np.broadcast_to(law(t, self.places), len(x)) for law in self.displacement], axis=1)
        return np.ascontiguousarray((x + d)[:, list(self.axes)]).reshape(-1)


@frozen
class CarriedEdges:
    """Angles of rod edges whose directors a rigid motion carries, both their nodes with them.

    Attributes:
        name: Label for messages.
        dofs: Their angles, shape (K,).
        edges: Their places in the frames, shape (K,).
        tails: Position DOFs of their first nodes, shape (3, K).
        heads: Position DOFs of their second nodes, shape (3, K).
        tangent: Unit tangents at rest, shape (3, K).
        director: First material directors at rest, shape (3, K).
        rigid: The rotations.
        twist: Angle of the directors about the edge, before those [rad].
        release: Time [s] from which they are free.
    """

    name: str
    dofs: IntArray
    edges: IntArray
    tails: IntArray
    heads: IntArray
    tangent: FloatArray
    director: FloatArray
    rigid: Rigid
    twist: Law
    release: float = inf
    remembers: ClassVar[bool] = True

    def stays(self, q: FloatArray, v: FloatArray) -> BoolArray:
        """None: they move."""
        return np.zeros(len(self.dofs), dtype=np.bool_)

    def values(self, t: float, q: FloatArray, since: Since) -> FloatArray:
        """Angles at a time, shape (K,); ``q`` has the positions of then."""
        start = since.frames.tangent[:, self.edges]
        angle = since.q[self.dofs]
        material = rotate_about(since.frames.director[:, self.edges], start, angle)
        twist = float(self.twist(t))
        wanted = self.rigid.rotation(t) @ rotate_about(self.director, self.tangent, twist)
        expected = self.rigid.spin(since.t, t, self.tangent) + twist - float(self.twist(since.t))
        along = q[self.heads] - q[self.tails]
        return angle + _turned(start, material, along, wanted, expected)


@frozen
class CarriedNormals:
    """Angles of mid-edge normals that a rigid motion carries.

    Attributes:
        name: Label for messages.
        dofs: Their angles, shape (K,).
        edges: Their places in the frames, shape (K,).
        tails: Position DOFs of the first nodes of their edges, shape (3, K).
        heads: Position DOFs of the second nodes, shape (3, K).
        tangent: Unit tangents at rest, shape (3, K).
        normal: Normals at rest, shape (3, K).
        rigid: The rotations.
        release: Time [s] from which they are free.
    """

    name: str
    dofs: IntArray
    edges: IntArray
    tails: IntArray
    heads: IntArray
    tangent: FloatArray
    normal: FloatArray
    rigid: Rigid
    release: float = inf
    remembers: ClassVar[bool] = True

    def stays(self, q: FloatArray, v: FloatArray) -> BoolArray:
        """None: they move."""
        return np.zeros(len(self.dofs), dtype=np.bool_)

    def values(self, t: float, q: FloatArray, since: Since) -> FloatArray:
        """Angles at a time, shape (K,); ``q`` has the positions of then."""
        start = since.frames.edge_tangent[:, self.edges]
        stored = since.frames.edge_normal[:, self.edges]
        expected = self.rigid.spin(since.t, t, self.tangent)
        wanted = self.rigid.rotation(t) @ self.normal
        along = q[self.heads] - q[self.tails]
        return since.frames.edge_angle[self.edges] + _turned(start, stored, along, wanted, expected)


def _turned(
    start: FloatArray, director: FloatArray, along: FloatArray, wanted: FloatArray, expected: FloatArray
) -> FloatArray:
    """Angle from a transported director to the one wanted, the one next to what is expected, shape (K,)."""
    tangent = along / np.sqrt((along * along).sum(axis=0))
    there = np.stack(orthonormal_to(parallel_transport(director, start, tangent), tangent))
    ahead = np.stack(rotate_about(there, tangent, expected))
    angle: FloatArray = expected + signed_angle(ahead, wanted, tangent)
    return angle
