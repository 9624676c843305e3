"""From a rate kernel to a term: viscous stresses, which the rates of strains meet."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..kernels.driver import Driver, RateLoop
from ..kernels.linearization import Coupling, Linearization, Pattern
from ..kernels.shape import RateKernel
from .configuration import Configuration


@frozen
class ViscousStress:
    """Many stencils of one viscous stress.

    Attributes:
        name: Unique name.
        kernel: Strains and viscosities.
        dofs: Global DOFs of each stencil, nodes first, angles last, shape (S, D).
        parameters: Constants in the order of the kernel, shape (P, S).
        auxiliaries: Indices into the auxiliary array of the trial frames, shape (S, A).
    """

    name: str
    kernel: RateKernel
    dofs: IntArray
    parameters: FloatArray
    auxiliaries: IntArray
    velocity_dependent: ClassVar[bool] = True

    @classmethod
    def of(
        cls,
        name: str,
        kernel: RateKernel,
        dofs: IntArray,
        parameters: Mapping[str, FloatArray | float],
        auxiliaries: IntArray | None = None,
    ) -> ViscousStress:
        """Build from constants by name, each one number or one per stencil.

        Raises:
            KeyError: A constant of the kernel is missing, or a name is none of its constants.
        """
        places = np.empty((len(dofs), 0), dtype=np.int64) if auxiliaries is None else auxiliaries
        return cls(name, kernel, dofs, kernel.parameters.stack(parameters, len(dofs)), places)

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """One clique per stencil; the tangent is not symmetric: rates change with the shape."""
        return (Coupling(self.dofs, symmetric=False),)

    def bind(self, pattern: Pattern, driver: Driver) -> BoundViscousStress:
        """Make the gather-evaluate-scatter loop."""
        loop = driver.rate(self.kernel, self.dofs, self.auxiliaries, pattern)
        return BoundViscousStress(self.name, loop, self.parameters)


@frozen
class BoundViscousStress:
    """A viscous stress bound to a pattern."""

    name: str
    loop: RateLoop
    parameters: FloatArray
    potential: ClassVar[None] = None

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        """Add the stresses on the slopes of their strains."""
        self.loop.add_residual(c.q, c.v, c.frames.auxiliary, self.parameters, r)

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Add these and both tangents."""
        self.loop.add_linearization(c.q, c.v, c.frames.auxiliary, self.parameters, into)
