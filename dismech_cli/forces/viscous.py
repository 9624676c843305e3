"""Linear viscous damping per length of rod: f = -eta l v on each node."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from ..arrays import FloatArray, IntArray
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Linearization, Pattern
from ..model.configuration import Configuration


@dataclass(frozen=True, slots=True)
class ViscousDamping:
    """Damping proportional to velocity.

    Attributes:
        name: Unique name.
        dofs: Damped position DOFs, shape (K,).
        coefficients: eta times Voronoi length [N s/m], shape (K,).
    """

    name: str
    dofs: IntArray
    coefficients: FloatArray
    velocity_dependent: ClassVar[bool] = True

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """Diagonal entries only."""
        return (Coupling(self.dofs[:, None]),)

    def bind(self, pattern: Pattern, driver: Driver) -> BoundViscousDamping:
        """Look the diagonal entries up."""
        return BoundViscousDamping(
            self.name, self.dofs, self.coefficients, pattern.symmetric_slots(self.dofs, self.dofs)
        )


@dataclass(frozen=True, slots=True)
class BoundViscousDamping:
    """Viscous damping bound to a pattern."""

    name: str
    dofs: IntArray
    coefficients: FloatArray
    slots: IntArray = field(repr=False)
    potential: ClassVar[None] = None

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        """Add eta l v."""
        r[self.dofs] += self.coefficients * c.v[self.dofs]

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Add eta l v and its constant tangent."""
        self.add_residual(c, into.residual)
        np.add.at(into.damping, self.slots, self.coefficients)
