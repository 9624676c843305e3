"""Single numbers read from a snapshot."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...model.touch import Touch
from .snapshot import Snapshot


class Probe(Protocol):
    """A number with a unit."""

    @property
    def unit(self) -> str:
        """SI unit."""

    def __call__(self, s: Snapshot) -> float:
        """Read it."""


def _mean(vectors: FloatArray, nodes: IntArray) -> FloatArray:
    """Mean of the vectors of some nodes, shape (3,); of one node, as mostly, that of the node itself."""
    if len(nodes) == 1:
        return np.asarray(vectors[nodes[0]])
    return np.asarray(vectors[nodes].mean(axis=0))


def _component(vector: FloatArray, axis: int | None) -> float:
    """A component, or the magnitude for None."""
    return float(np.linalg.norm(vector)) if axis is None else float(vector[axis])


@frozen
class Position:
    """Mean position of nodes, less a reference: a displacement if that is the rest position.

    Attributes:
        nodes: Nodes, shape (K,).
        reference: Subtracted from the mean [m], shape (3,).
        axis: Component, or None for the magnitude.
    """

    nodes: IntArray
    reference: FloatArray
    axis: int | None
    unit: str = "m"

    def __call__(self, s: Snapshot) -> float:
        """Read it."""
        return _component(_mean(s.positions, self.nodes) - self.reference, self.axis)


@frozen
class Velocity:
    """Mean velocity of nodes."""

    nodes: IntArray
    axis: int | None
    unit: str = "m/s"

    def __call__(self, s: Snapshot) -> float:
        """Read it."""
        return _component(_mean(s.velocities, self.nodes), self.axis)


@frozen
class Distance:
    """Distance between the means of two sets of nodes."""

    first: IntArray
    second: IntArray
    unit: str = "m"

    def __call__(self, s: Snapshot) -> float:
        """Read it."""
        return _component(_mean(s.positions, self.first) - _mean(s.positions, self.second), None)


@frozen
class Energy:
    """An entry of the energy account."""

    name: str
    unit: str = "J"

    def __call__(self, s: Snapshot) -> float:
        """Read it."""
        return s.energies[self.name]


@frozen
class Reaction:
    """Sum of the forces that hold nodes, walls of their clamps included."""

    nodes: IntArray
    axis: int | None
    unit: str = "N"

    def __call__(self, s: Snapshot) -> float:
        """Read it."""
        return _component(s.forces[self.nodes].sum(axis=0), self.axis)


@frozen
class TwistAngle:
    """Mean angle of edges, from rest."""

    dofs: IntArray
    unit: str = "rad"

    def __call__(self, s: Snapshot) -> float:
        """Read it."""
        return float(s.state.q[self.dofs].mean())


@frozen
class Turn:
    """Angle between an edge and its direction at rest; the mean of several edges.

    Attributes:
        edges: Nodes of the edges, shape (K, 2).
        rest: Unit vectors at rest, shape (K, 3).
    """

    edges: IntArray
    rest: FloatArray
    unit: str = "rad"

    def __call__(self, s: Snapshot) -> float:
        """Read it."""
        e = s.positions[self.edges[:, 1]] - s.positions[self.edges[:, 0]]
        across = np.linalg.norm(np.cross(self.rest, e), axis=1)
        return float(np.arctan2(across, np.einsum("ij,ij->i", self.rest, e)).mean())


@frozen
class Bend:
    """Mean discrete curvature of a line through nodes, 2 tan(turn / 2), about a direction.

    Attributes:
        nodes: Along the line, shape (K,).
        about: Unit vector, shape (3,).
    """

    nodes: IntArray
    about: FloatArray
    unit: str = "1"

    def __call__(self, s: Snapshot) -> float:
        """Read it."""
        e = np.diff(s.positions[self.nodes], axis=0)
        size = np.linalg.norm(e, axis=1)
        along = np.einsum("ij,ij->i", e[:-1], e[1:])
        return float((2.0 * np.cross(e[:-1], e[1:]) @ self.about / (size[:-1] * size[1:] + along)).mean())


@frozen
class LoadFactor:
    """The load factor of a static run."""

    unit: str = "1"

    def __call__(self, s: Snapshot) -> float:
        """Read it."""
        return s.state.law_time


@frozen
class TouchForce:
    """Force of one body on another.

    Attributes:
        pair: Names of the two.
        sign: -1 where the force on the second is asked for.
        parts: What is summed of a pair of a :class:`~dismech_cli.model.touch.Touch`.
        axis: Component, or None for the magnitude.
    """

    pair: tuple[str, str]
    sign: float
    parts: tuple[Callable[[Touch], FloatArray], ...]
    axis: int | None
    unit: str = "N"

    def __call__(self, s: Snapshot) -> float:
        """Read it."""
        touch, k = s.touches[self.pair]
        return _component(self.sign * sum((part(touch)[k] for part in self.parts), np.zeros(3)), self.axis)


@frozen
class TouchNumber:
    """A number of a pair that touches.

    Attributes:
        pair: Names of the two.
        read: What of each pair.
        unit: SI unit.
    """

    pair: tuple[str, str]
    read: Callable[[Touch], FloatArray | IntArray]
    unit: str

    def __call__(self, s: Snapshot) -> float:
        """Read it."""
        touch, k = s.touches[self.pair]
        return float(self.read(touch)[k])


@frozen
class NegativeEigenvalues:
    """Negative eigenvalues of the stiffness: 0 for a stable equilibrium, NaN where it is singular."""

    unit: str = "1"

    def __call__(self, s: Snapshot) -> float:
        """Read it."""
        return s.negative_eigenvalues
