"""From a pure energy kernel to a term: which components go in, where the numbers go."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..kernels.driver import Driver, StencilLoop
from ..kernels.linearization import Coupling, Linearization, Pattern
from ..kernels.shape import Kernel
from .configuration import Configuration


@dataclass(frozen=True, slots=True)
class StencilEnergy:
    """Many stencils of one energy.

    Attributes:
        name: Unique name.
        kernel: The energy.
        dofs: Global DOFs of each stencil, nodes first, angles last, shape (S, D).
        parameters: Constants of each stencil, natural strains first, shape (P, S).
        auxiliaries: Indices into the auxiliary array of the trial frames, shape (S, A).
    """

    name: str
    kernel: Kernel
    dofs: IntArray
    parameters: FloatArray
    auxiliaries: IntArray
    velocity_dependent: ClassVar[bool] = False

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """One clique per stencil."""
        return (Coupling(self.dofs),)

    @property
    def shares(self) -> tuple[str, ...]:
        """Names of its parts in the energy account."""
        return self.kernel.shares or (self.name,)

    @property
    def natural(self) -> FloatArray:
        """Natural strains, shape (naturals, S); a view."""
        return self.parameters[: self.kernel.naturals]

    def touching(self, dofs: BoolArray) -> StencilEnergy:
        """The stencils that hold any of some DOFs, given as a mask (n,)."""
        some = dofs[self.dofs].any(axis=1)
        return replace(
            self,
            dofs=self.dofs[some],
            parameters=np.ascontiguousarray(self.parameters[:, some]),
            auxiliaries=self.auxiliaries[some],
        )

    def bind(self, pattern: Pattern, driver: Driver) -> BoundStencil:
        """Make the gather-evaluate-scatter loop."""
        loop = driver.stencil(self.kernel, self.dofs, self.auxiliaries, pattern)
        return BoundStencil(self.name, self.shares, self.kernel.naturals, loop, self.parameters)


@dataclass(frozen=True, slots=True)
class BoundStencil:
    """A stencil energy bound to a pattern; implements :class:`~.term.BoundEnergy`."""

    name: str
    shares: tuple[str, ...]
    naturals: int
    loop: StencilLoop
    parameters: FloatArray

    def natural(self, t: float) -> FloatArray:
        """Natural strains, the same at all times, shape (naturals, S); a view."""
        return self.parameters[: self.naturals]

    def energy(self, c: Configuration) -> FloatArray:
        """Energies [J], shape (shares, S)."""
        return self.loop.energy(c.q, c.frames.auxiliary, self.parameters)

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        """Add dE/dq."""
        self.loop.add_residual(c.q, c.frames.auxiliary, self.parameters, r)

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Add dE/dq and d2E/dq2."""
        self.loop.add_linearization(c.q, c.frames.auxiliary, self.parameters, into)

    def actuated(self, natural: FloatArray) -> BoundStencil:
        """Return the same energy with other natural strains, shape (naturals, S)."""
        parameters = self.parameters.copy()
        parameters[: self.naturals] = natural
        return replace(self, parameters=parameters)


def no_auxiliaries(stencils: int) -> IntArray:
    """Auxiliary indices of a kernel that takes none."""
    return np.empty((stencils, 0), dtype=np.int64)
