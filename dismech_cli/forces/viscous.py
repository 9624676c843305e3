"""Linear viscous damping per length of rod or area of shell: f = -eta l v on each node."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field
from typing import ClassVar

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..geometry.kernel import loop
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Linearization, Pattern
from ..model.configuration import Configuration


@loop
def add_viscous(
    v: FloatArray,
    coefficients: FloatArray,
    dofs: IntArray,
    r: FloatArray,
    damping: FloatArray,
    slots: IntArray,
) -> None:
    """Add c v to the residual and c to the tangent, one DOF after the other."""
    for s in range(len(dofs)):
        r[dofs[s]] += coefficients[s] * v[dofs[s]]
        damping[slots[s]] += coefficients[s]


def _add_batch(
    v: FloatArray,
    coefficients: FloatArray,
    dofs: IntArray,
    r: FloatArray,
    damping: FloatArray,
    slots: IntArray,
) -> None:
    """The same at once."""
    r[dofs] += coefficients * v[dofs]
    np.add.at(damping, slots, coefficients)


@frozen
class ViscousDamping:
    """Damping proportional to velocity.

    Attributes:
        name: Unique name.
        dofs: Position DOFs of the damped nodes, shape (K, d).
        coefficients: eta times the length or area of each node [N s/m], shape (K,).
    """

    name: str
    dofs: IntArray
    coefficients: FloatArray
    velocity_dependent: ClassVar[bool] = True

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """Diagonal entries only."""
        return (Coupling(self.dofs.reshape(-1, 1)),)

    @property
    def loaded(self) -> IntArray:
        """DOFs of each node, shape (K, d)."""
        return self.dofs

    def resistance(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """Slope -df/dv [N s/m], shape (K, d, d)."""
        return self.coefficients[:, None, None] * np.eye(self.dofs.shape[1])

    def bind(self, pattern: Pattern, driver: Driver) -> BoundViscousDamping:
        """Look the diagonal entries up."""
        dofs = self.dofs.reshape(-1)
        each = np.repeat(self.coefficients, self.dofs.shape[1])
        add = driver.compiled(add_viscous) or _add_batch
        return BoundViscousDamping(self.name, dofs, each, pattern.symmetric_slots(dofs, dofs), add)


@frozen
class BoundViscousDamping:
    """Viscous damping bound to a pattern."""

    name: str
    dofs: IntArray
    coefficients: FloatArray
    slots: IntArray = field(repr=False)
    add: Callable[..., None] = field(repr=False)
    potential: ClassVar[None] = None

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        """Add eta l v."""
        r[self.dofs] += self.coefficients * c.v[self.dofs]

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Add eta l v and its constant tangent."""
        self.add(c.v, self.coefficients, self.dofs, into.residual, into.damping, self.slots)
