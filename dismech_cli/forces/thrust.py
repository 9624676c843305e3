"""Thrust of a bell that expels water: F = -k dV/dt along a direction while its volume shrinks.

The force on one node depends on the velocities of all: the tangent is a full matrix of rank one.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Linearization, Pattern, RankOne
from ..kinematics.dofs import DofMap
from ..model.configuration import Configuration
from .enclosed_volume import EnclosedVolume


@frozen
class Thrust:
    """Thrust on the nodes of a shell; implements both Term and BoundTerm.

    Attributes:
        name: Unique name.
        volume: What shrinks.
        n_positions: Position DOFs, three to a node.
        sense: +1 where the normals of the rest shape point outward, -1 where inward.
        push: Force on each node per rate of volume expelled [N s/m^3], shape (N, 3).
    """

    name: str
    volume: EnclosedVolume
    n_positions: int
    sense: float
    push: FloatArray
    velocity_dependent: ClassVar[bool] = True
    potential: ClassVar[None] = None

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """None: the tangent is not sparse."""
        return ()

    def bind(self, pattern: Pattern, driver: Driver) -> Thrust:
        """Return itself: nothing to look up."""
        return self

    def rate(self, c: Configuration) -> float:
        """dV/dt [m^3/s]."""
        x, v = self._moving(c)
        return self._rate(self.volume.gradient(x), v)

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        """Subtract the thrust."""
        self._add(self.rate(c), r)

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Subtract the thrust and add its tangent."""
        x, v = self._moving(c)
        corners = self.volume.at(x)
        gradient = self.volume.gradient_of(corners)
        rate = self._rate(gradient, v)
        self._add(rate, into.residual)
        if rate < 0.0:
            column, by_q, by_v = (np.zeros_like(c.q) for _ in range(3))
            column[: self.n_positions] = self.push.reshape(-1)
            by_q[: self.n_positions] = self.sense * self.volume.gradient_change(corners, v).reshape(-1)
            by_v[: self.n_positions] = self.sense * gradient.reshape(-1)
            into.rank_ones.append(RankOne(column, by_q, by_v))

    def _moving(self, c: Configuration) -> tuple[FloatArray, FloatArray]:
        """Nodes [m] and their velocities [m/s], each of shape (N, 3)."""
        return c.q[: self.n_positions].reshape(-1, 3), c.v[: self.n_positions].reshape(-1, 3)

    def _rate(self, gradient: FloatArray, v: FloatArray) -> float:
        return self.sense * float(np.vdot(gradient, v))

    def _add(self, rate: float, r: FloatArray) -> None:
        r[: self.n_positions] += min(rate, 0.0) * self.push.reshape(-1)


def thrust(
    name: str,
    dofs: DofMap,
    nodes: FloatArray,
    triangles: IntArray,
    *,
    coefficient: float,
    direction: FloatArray,
    shares: FloatArray,
) -> Thrust:
    """Build the thrust of a bell.

    Args:
        name: Unique name.
        dofs: Numbering; three dimensions.
        nodes: Rest positions of all nodes [m], shape (n_nodes, 3).
        triangles: The bell, shape (T, 3).
        coefficient: k [N s/m^3].
        direction: Direction of the thrust, any length but zero, shape (3,).
        shares: Weight of each node, any scale, shape (n_nodes,): nodal masses, or ones on the
            bell's nodes as the DiSMech family does.
    """
    volume = EnclosedVolume.of(len(nodes), triangles)
    sense = 1.0 if volume.value(nodes) >= 0.0 else -1.0
    along = direction / np.linalg.norm(direction)
    push = coefficient * np.outer(shares / shares.sum(), along)
    return Thrust(name, volume, dofs.n_positions, sense, push)
