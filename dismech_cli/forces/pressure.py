"""Pressure along the normals of a shell: follows its faces and grows with their area.

On a surface without rim, pressure is conservative, E = -p V, and its tangent symmetric; with a rim
it is neither.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..geometry.kernel import kernel
from ..geometry.vectors import cross, scale
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Linearization, Pattern
from ..kernels.shape import LoadKernel
from ..kinematics.dofs import DofMap
from ..laws.signal import Signal
from ..mesh.topology.sides import rim_sides
from ..model.configuration import Configuration
from ..model.load import BoundLoad
from ..model.term import BoundTerm, Term


def pressure(name: str, dofs: DofMap, triangles: IntArray, signal: Signal) -> Term:
    """Build a pressure, conservative where it can be.

    Args:
        name: Unique name.
        dofs: Numbering; three dimensions.
        triangles: Faces under pressure, shape (T, 3).
        signal: Pressure [Pa] over time; positive pushes along the normals.
    """
    corners = dofs.of_nodes(triangles).reshape(len(triangles), 9)
    if not len(rim_sides(triangles)):
        return VolumePressure(name, corners, signal)
    return FollowerPressure(name, corners, signal)


@kernel
def face_pressure(y: Any, a: Any, p: Any) -> Any:
    """Residual at unit pressure on the three corners, and its slopes to (x1 - x0, x2 - x0)."""
    u, v = scale(1.0 / 6.0, y[0:3]), scale(1.0 / 6.0, y[3:6])
    m = cross(u, y[3:6])
    z = 0.0 * m[0]
    r = (-m[0], -m[1], -m[2])
    rows = (
        z, -v[2], v[1], z, u[2], -u[1],
        v[2], z, -v[0], -u[2], z, u[0],
        -v[1], v[0], z, u[1], -u[0], z,
    )  # fmt: skip
    return r + r + r, rows + rows + rows


FACE_PRESSURE = LoadKernel(face_pressure, dimension=3, nodes=3, vectors=((0, 1), (0, 2)), constants=())


@frozen
class FollowerPressure:
    """A third of p times the face's normal area on each of its corners.

    Attributes:
        name: Unique name.
        corners: Position DOFs of each triangle, shape (T, 9).
        signal: Pressure [Pa] over time.
    """

    name: str
    corners: IntArray
    signal: Signal
    velocity_dependent: ClassVar[bool] = False

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """The corners of each triangle, unsymmetric."""
        return (Coupling(self.corners, symmetric=False),)

    def bind(self, pattern: Pattern, driver: Driver) -> BoundTerm:
        """Make the loop."""
        return BoundLoad.of(self.name, FACE_PRESSURE, self.corners, {}, self.signal, pattern, driver)


@frozen
class VolumePressure:
    """E = -p V with V the signed volume between the faces and a fixed point.

    Attributes:
        name: Unique name.
        corners: Position DOFs of each triangle, shape (T, 9).
        signal: Pressure [Pa] over time.
    """

    name: str
    corners: IntArray
    signal: Signal
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


@frozen
class _BoundVolume:
    """Conservative pressure bound to a pattern; implements BoundEnergy."""

    name: str
    load: VolumePressure
    slots: IntArray

    @property
    def shares(self) -> tuple[str]:
        """One energy, that of the load."""
        return (self.name,)

    @property
    def steady(self) -> bool:
        """Whether the pressure never changes."""
        return self.load.signal.constant

    @property
    def potential(self) -> _BoundVolume:
        """Itself."""
        return self

    def energy(self, c: Configuration) -> FloatArray:
        """-p times each face's share of the volume [J], shape (1, T)."""
        x0, x1, x2 = self._corners(c)
        shares = np.einsum("ti,ti->t", x0, np.cross(x1, x2))
        return np.asarray(shares * (-self._pressure(c) / 6.0))[None]

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        """Subtract the force."""
        x0, x1, x2 = self._corners(c)
        shares = np.concatenate((np.cross(x1, x2), np.cross(x2, x0), np.cross(x0, x1)), axis=1)
        np.add.at(r, self.load.corners, shares * (-self._pressure(c) / 6.0))

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Subtract the force and add its tangent."""
        self.add_residual(c, into.residual)
        x0, x1, x2 = (_cross_matrix(x) for x in self._corners(c))
        tangent = np.zeros((len(x0), 9, 9))
        tangent[:, 0:3, 3:6], tangent[:, 0:3, 6:9], tangent[:, 3:6, 6:9] = x2, -x1, x0
        i, j = np.triu_indices(9)
        np.add.at(into.stiffness, self.slots, tangent[:, i, j] * (self._pressure(c) / 6.0))

    def _pressure(self, c: Configuration) -> float:
        return float(self.load.signal.value(c.t, c.inputs))

    def _corners(self, c: Configuration) -> tuple[FloatArray, FloatArray, FloatArray]:
        x = c.q[self.load.corners]
        return x[:, 0:3], x[:, 3:6], x[:, 6:9]


def _cross_matrix(a: FloatArray) -> FloatArray:
    """Matrices [a]x with [a]x b = a x b, shape (T, 3, 3)."""
    out = np.zeros((len(a), 3, 3))
    out[:, 2, 1], out[:, 0, 2], out[:, 1, 0] = a[:, 0], a[:, 1], a[:, 2]
    return out - out.transpose(0, 2, 1)
