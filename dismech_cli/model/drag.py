"""From a pure drag kernel to a term: forces that depend on velocity and on edge directions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..kernels.driver import DragLoop, Driver
from ..kernels.linearization import Coupling, Linearization, Pattern
from ..kernels.shape import DragKernel
from .configuration import Configuration


@frozen
class DragForce:
    """Many stencils of one drag force.

    Attributes:
        name: Unique name.
        kernel: The force.
        dofs: Global DOFs of each stencil, shape (S, D).
        parameters: Constants in the order of the kernel, shape (P, S).
    """

    name: str
    kernel: DragKernel
    dofs: IntArray
    parameters: FloatArray
    velocity_dependent: ClassVar[bool] = True

    @classmethod
    def of(
        cls, name: str, kernel: DragKernel, dofs: IntArray, parameters: Mapping[str, FloatArray | float]
    ) -> DragForce:
        """Build from constants by name, each one number or one per stencil.

        Raises:
            KeyError: A constant of the kernel is missing, or a name is none of its constants.
        """
        return cls(name, kernel, dofs, kernel.parameters.stack(parameters, len(dofs)))

    def parameter(self, name: str) -> FloatArray:
        """A constant by name, shape (S,); a view."""
        row: FloatArray = self.parameters[self.kernel.parameters.row(name)]
        return row

    @property
    def loaded(self) -> IntArray:
        """DOFs of the nodes that the force acts on, shape (S, F)."""
        chosen: IntArray = self.dofs[:, self.kernel.loaded_dofs]
        return chosen

    def resistance(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """Slope -df/dv to the velocities of these nodes [N s/m], shape (S, F, F)."""
        kernel, at = self.kernel, self.dofs.T
        within = np.arange(kernel.dimension)
        vectors = [kernel.dimension * np.array(ends)[:, None] + within for ends in kernel.vectors]
        y = np.concatenate([q[at[head]] - q[at[tail]] for tail, head in vectors])
        _, _, slope = kernel.function(y, v[at[kernel.loaded_dofs]], self.parameters)
        rows = np.stack([np.broadcast_to(one, len(self.dofs)) for one in slope], axis=1)
        return rows.reshape(len(self.dofs), kernel.forces, kernel.forces)

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """One clique per stencil; the tangent is not symmetric."""
        return (Coupling(self.dofs, symmetric=False),)

    def bind(self, pattern: Pattern, driver: Driver) -> BoundDrag:
        """Make the gather-evaluate-scatter loop."""
        return BoundDrag(self.name, driver.drag(self.kernel, self.dofs, pattern), self.parameters)


@frozen
class BoundDrag:
    """A drag force bound to a pattern."""

    name: str
    loop: DragLoop
    parameters: FloatArray
    potential: ClassVar[None] = None

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        """Add -f."""
        self.loop.add_residual(c.q, c.v, self.parameters, r)

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Add -f, -df/dq, -df/dv."""
        self.loop.add_linearization(c.q, c.v, self.parameters, into)
