"""From a pure energy kernel to a term: which components go in, where the numbers go."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import ClassVar

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..frozen import frozen
from ..kernels.driver import Driver, StencilLoop
from ..kernels.linearization import Coupling, Linearization, Pattern
from ..kernels.shape import Kernel
from .configuration import Configuration


@frozen
class StencilEnergy:
    """Many stencils of one energy.

    Attributes:
        name: Unique name.
        kernel: The energy.
        dofs: Global DOFs of each stencil, nodes first, angles last, shape (S, D).
        parameters: Natural strains and constants in the order of the kernel, shape (P, S).
        auxiliaries: Indices into the auxiliary array of the trial frames, shape (S, A).
    """

    name: str
    kernel: Kernel
    dofs: IntArray
    parameters: FloatArray
    auxiliaries: IntArray
    velocity_dependent: ClassVar[bool] = False

    @classmethod
    def of(
        cls,
        name: str,
        kernel: Kernel,
        dofs: IntArray,
        parameters: Mapping[str, FloatArray | float],
        auxiliaries: IntArray | None = None,
    ) -> StencilEnergy:
        """Build from parameters by name, each one number or one per stencil.

        Args:
            name: Unique name.
            kernel: The energy.
            dofs: Global DOFs of each stencil, nodes first, angles last, shape (S, D).
            parameters: A value for each name of the kernel: numbers or arrays (S,).
            auxiliaries: Indices into the auxiliary array of the trial frames, shape (S, A); none
                where the kernel takes none.

        Raises:
            KeyError: A parameter of the kernel is missing, or a name is none of its parameters.
        """
        places = np.empty((len(dofs), 0), dtype=np.int64) if auxiliaries is None else auxiliaries
        return cls(name, kernel, dofs, kernel.parameters.stack(parameters, len(dofs)), places)

    def parameter(self, name: str) -> FloatArray:
        """A natural strain or a constant by name, shape (S,); a view."""
        row: FloatArray = self.parameters[self.kernel.parameters.row(name)]
        return row

    def having(self, parameters: Mapping[str, FloatArray | float]) -> StencilEnergy:
        """The same energy with other values of some parameters, by name."""
        changed = self.parameters.copy()
        for name, value in parameters.items():
            changed[self.kernel.parameters.row(name)] = value
        return replace(self, parameters=changed)

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
        return self.parameters[: len(self.kernel.naturals)]

    def natural_at(self, t: float, inputs: FloatArray) -> FloatArray:
        """Natural strains, the same at all times, shape (naturals, S); a view."""
        return self.natural

    def touching(self, dofs: BoolArray) -> StencilEnergy | None:
        """The stencils that hold any of some DOFs, given as a mask (n,); None if none does."""
        some = dofs[self.dofs].any(axis=1)
        if not some.any():
            return None
        return replace(
            self,
            dofs=self.dofs[some],
            parameters=np.ascontiguousarray(self.parameters[:, some]),
            auxiliaries=self.auxiliaries[some],
        )

    def bind(self, pattern: Pattern, driver: Driver) -> BoundStencil:
        """Make the gather-evaluate-scatter loop."""
        loop = driver.stencil(self.kernel, self.dofs, self.auxiliaries, pattern)
        return BoundStencil(self.name, self.shares, len(self.kernel.naturals), loop, self.parameters)


@frozen
class BoundStencil:
    """A stencil energy bound to a pattern; implements :class:`~.term.BoundEnergy`."""

    name: str
    shares: tuple[str, ...]
    naturals: int
    loop: StencilLoop
    parameters: FloatArray
    steady: ClassVar[bool] = True

    @property
    def potential(self) -> BoundStencil:
        """Itself."""
        return self

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
        return BoundStencil(self.name, self.shares, self.naturals, self.loop, parameters)
