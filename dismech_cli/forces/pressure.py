"""Pressure along the normals of a shell: follows its faces and grows with their area.

On a surface without rim, pressure is conservative, E = -p V, and its tangent symmetric; with a rim
it is neither.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..arrays import FloatArray, IntArray
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Linearization, Pattern
from ..kinematics.dofs import DofMap
from ..laws.laws import Law
from ..mesh.topology.sides import rim_sides
from ..model.clique import BoundCliques
from ..model.configuration import Configuration
from ..model.term import BoundTerm, Term


def pressure(name: str, dofs: DofMap, triangles: IntArray, law: Law) -> Term:
    """Build a pressure, conservative where it can be.

    Args:
        name: Unique name.
        dofs: Numbering; three dimensions.
        triangles: Faces under pressure, shape (T, 3).
        law: Pressure [Pa] over time; positive pushes along the normals.
    """
    corners = dofs.of_nodes(triangles).reshape(len(triangles), 9)
    if not len(rim_sides(triangles)):
        return VolumePressure(name, corners, law)
    return FollowerPressure(name, corners, law)


@dataclass(frozen=True, slots=True)
class FollowerPressure:
    """A third of p times the face's normal area on each of its corners.

    Attributes:
        name: Unique name.
        corners: Position DOFs of each triangle, shape (T, 9).
        law: Pressure [Pa] over time.
    """

    name: str
    corners: IntArray
    law: Law
    velocity_dependent: ClassVar[bool] = False

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """The corners of each triangle, unsymmetric."""
        return (Coupling(self.corners, symmetric=False),)

    def bind(self, pattern: Pattern, driver: Driver) -> BoundTerm:
        """Look the entries up."""
        return BoundCliques.of(self.name, self.corners, pattern, self._evaluate)

    def _evaluate(self, c: Configuration) -> tuple[FloatArray, FloatArray]:
        x = c.q[self.corners]
        a, b = x[:, 3:6] - x[:, 0:3], x[:, 6:9] - x[:, 0:3]
        scale = float(self.law(c.t)) / 6.0
        by_a, by_b = scale * _cross_matrix(b), -scale * _cross_matrix(a)
        row = np.concatenate((-by_a - by_b, by_a, by_b), axis=2)
        return np.tile(-scale * np.cross(a, b), (1, 3)), np.tile(row, (1, 3, 1))


@dataclass(frozen=True, slots=True)
class VolumePressure:
    """E = -p V with V the signed volume between the faces and a fixed point.

    Attributes:
        name: Unique name.
        corners: Position DOFs of each triangle, shape (T, 9).
        law: Pressure [Pa] over time.
    """

    name: str
    corners: IntArray
    law: Law
    velocity_dependent: ClassVar[bool] = False

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """The corners of each triangle."""
        return (Coupling(self.corners),)

    def bind(self, pattern: Pattern, driver: Driver) -> BoundTerm:
        """Look the entries up."""
        i, j = np.triu_indices(9)
        slots = pattern.symmetric_slots(self.corners[:, i], self.corners[:, j])
        return _BoundVolume(self.name, self, slots)


@dataclass(frozen=True, slots=True)
class _BoundVolume:
    """Conservative pressure bound to a pattern; implements BoundEnergy."""

    name: str
    load: VolumePressure
    slots: IntArray

    @property
    def shares(self) -> tuple[str]:
        """One energy, that of the load."""
        return (self.name,)

    def energy(self, c: Configuration) -> FloatArray:
        """-p times each face's share of the volume [J], shape (1, T)."""
        x0, x1, x2 = self._corners(c)
        shares = np.einsum("ti,ti->t", x0, np.cross(x1, x2))
        return np.asarray(shares * (-float(self.load.law(c.t)) / 6.0))[None]

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        """Subtract the force."""
        x0, x1, x2 = self._corners(c)
        shares = np.concatenate((np.cross(x1, x2), np.cross(x2, x0), np.cross(x0, x1)), axis=1)
        np.add.at(r, self.load.corners, shares * (-float(self.load.law(c.t)) / 6.0))

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Subtract the force and add its tangent."""
        self.add_residual(c, into.residual)
        x0, x1, x2 = (_cross_matrix(x) for x in self._corners(c))
        tangent = np.zeros((len(x0), 9, 9))
        tangent[:, 0:3, 3:6], tangent[:, 0:3, 6:9], tangent[:, 3:6, 6:9] = x2, -x1, x0
        i, j = np.triu_indices(9)
        np.add.at(into.stiffness, self.slots, tangent[:, i, j] * (float(self.load.law(c.t)) / 6.0))

    def _corners(self, c: Configuration) -> tuple[FloatArray, FloatArray, FloatArray]:
        x = c.q[self.load.corners]
        return x[:, 0:3], x[:, 3:6], x[:, 6:9]


def _cross_matrix(a: FloatArray) -> FloatArray:
    """Matrices [a]x with [a]x b = a x b, shape (T, 3, 3)."""
    out = np.zeros((len(a), 3, 3))
    out[:, 2, 1], out[:, 0, 2], out[:, 1, 0] = a[:, 0], a[:, 1], a[:, 2]
    return out - out.transpose(0, 2, 1)
