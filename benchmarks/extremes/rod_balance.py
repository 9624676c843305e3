"""Balance of forces of a planar rod from its nodes alone, by formulas written here and differentiated "
"numerically.

Nothing of the program is used: an answer that it holds for converged is put into

    E = sum EA/2 l (|e|/l - 1)^2 + sum EI/(2 l_v) (2 tan(phi/2))^2 + sum m g z

whose gradient, by complex steps, is the force on each node. The joint at the clamp is half as long as others.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Self

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# Far below any length: complex steps have no difference that could round.
_STEP = 1e-30
_EPS = float(np.finfo(float).eps)


@dataclass(frozen=True, slots=True, kw_only=True)
class Rod:
    """A rod along x, clamped at its first node.

    Attributes:
        axial: EA [N].
        bending: EI [N m^2].
        mass_per_length: Of the rod [kg/m].
        length: Of its axis [m].
        nodes: How many.
        gravity: Down z [m/s^2].
    """

    axial: float
    bending: float
    mass_per_length: float
    length: float
    nodes: int
    gravity: float = 0.0

    @classmethod
    def round(
        cls, *, modulus: float, radius: float, density: float, length: float, nodes: int, gravity: float
    ) -> Self:
        """Of a round section."""
        area = pi * radius**2
        return cls(
            axial=modulus * area,
            bending=modulus * area * radius**2 / 4.0,
            mass_per_length=density * area,
            length=length,
            nodes=nodes,
            gravity=gravity,
        )

    @property
    def edge(self) -> float:
        """Length of an edge at rest [m]."""
        return self.length / (self.nodes - 1)

    @property
    def masses(self) -> Array:
        """Of the nodes [kg], shape (N,)."""
        each = np.full(self.nodes, self.mass_per_length * self.edge)
        each[[0, -1]] *= 0.5
        return each

    def forces(self, x: Array) -> Array:
        """Of elasticity on the nodes (N, 2) of a shape (N, 2) [N]."""
        places = np.arange(x.size)
        moved = np.tile(x.ravel().astype(np.complex128), (x.size, 1))
        moved[places, places] += 1j * _STEP
        energy = self.elastic(moved.reshape(x.size, self.nodes, 2))
        return -(energy.imag / _STEP).reshape(x.shape)

    def elastic(self, x: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Energy of shapes (K, N, 2): shape (K,) [J]."""
        e = np.diff(x, axis=1)
        size = np.sqrt((e * e).sum(axis=2))
        stretch = 0.5 * self.axial * self.edge * ((size / self.edge - 1.0) ** 2).sum(axis=1)
        t = e / size[:, :, None]
        root = np.zeros_like(t[:, :1]) + np.array([1.0, 0.0])
        before = np.concatenate([root, t[:, :-1]], axis=1)
        cross = before[..., 0] * t[..., 1] - before[..., 1] * t[..., 0]
        turn = 2.0 * cross / (1.0 + (before * t).sum(axis=2))
        joints = np.full(turn.shape[1], self.edge)
        joints[0] *= 0.5
        energy: NDArray[np.complex128] = stretch + (0.5 * self.bending / joints * turn**2).sum(axis=1)
        return energy

    def unbalanced(
        self, x: Array, *, free: slice = slice(1, None), v: Array | None = None, dt: float = 0.0
    ) -> float:
        """The largest force on a free node that nothing balances, as a share of those that act.

        Args:
            x: Nodes, (N, 2).
            free: Which of them are.
            v: Change of their velocities in a step of implicit Euler, (N, 2) [m/s]; None at rest.
            dt: The step [s].
        """
        elastic, mass = self.forces(x), self.masses[:, None]
        weight = -mass * np.array([0.0, self.gravity])
        inertia = np.zeros_like(x) if v is None else mass * v / dt
        rest = np.abs(elastic + weight - inertia)[free]
        # what the neighbours of a node pull each, before they cancel, is the sum of all forces on one side
        acting = np.abs(elastic).max() + np.abs(np.cumsum(elastic[::-1], axis=0)).max()
        acting += np.abs(weight).max() + np.abs(inertia).max()
        stiffness = self.axial / self.edge + 16.0 * self.bending / self.edge**3
        if dt:
            stiffness += float(mass.max()) / dt**2
        # both ends of two edges, and the rounding of what the steps before added up
        floor = 32.0 * _EPS * float(np.abs(x).max()) * stiffness
        return float(np.maximum(rest - floor, 0.0).max() / max(acting, floor, 1e-300))
