"""From a pure energy kernel to a term: which components go in, where the numbers go.

A kernel sees reduced variables only: differences of node positions (edge vectors) and angles.
Because node positions enter through differences, gradient and Hessian with respect to nodes
follow from constant +-1 patterns, tabulated here once per kernel.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from .configuration import Configuration
from .driver import Driver, StencilLoop
from .term import Coupling, Linearization, Pattern


@dataclass(frozen=True)
class Kernel:
    """An energy kernel and the shape of its stencil.

    Attributes:
        function: ``f(y, a, p) -> (energy, gradient (R), packed Hessian R(R+1)/2)``.
        dimension: Components of an edge vector: 2 or 3.
        nodes: Nodes per stencil.
        vectors: Edge vectors as (tail, head) local nodes; y starts with their components.
        angles: Angles per stencil; they end y.
        auxiliaries: Inputs a taken from the trial frames.
        naturals: Leading parameters that are natural strains.
        parameters: Length of p, natural strains included.
        shares: Names of the parts that the energy comes in, a tuple then; empty where it is one number.
    """

    function: Callable[[Any, Any, Any], Any]
    dimension: int
    nodes: int
    vectors: tuple[tuple[int, int], ...]
    parameters: int
    naturals: int
    angles: int = 0
    auxiliaries: int = 0
    shares: tuple[str, ...] = ()

    @property
    def reduced(self) -> int:
        """Number R of reduced variables."""
        return self.dimension * len(self.vectors) + self.angles

    @property
    def energies(self) -> int:
        """Number of parts that the energy comes in."""
        return max(len(self.shares), 1)

    @property
    def dofs(self) -> int:
        """Number D of DOFs per stencil."""
        return self.dimension * self.nodes + self.angles

    @cached_property
    def reduction(self) -> FloatArray:
        """Constant matrix B, shape (R, D): y = B q_local."""
        b = np.zeros((self.reduced, self.dofs))
        for k, (tail, head) in enumerate(self.vectors):
            for i in range(self.dimension):
                b[k * self.dimension + i, tail * self.dimension + i] = -1.0
                b[k * self.dimension + i, head * self.dimension + i] = 1.0
        for k in range(self.angles):
            b[self.dimension * len(self.vectors) + k, self.dimension * self.nodes + k] = 1.0
        return b

    @cached_property
    def gradient_table(self) -> tuple[IntArray, IntArray, FloatArray]:
        """Entries (local DOF, reduced index, sign) of g_local = B^T g."""
        row, column = np.nonzero(self.reduction.T)
        return row, column, self.reduction.T[row, column]

    @cached_property
    def hessian_table(self) -> tuple[IntArray, IntArray, FloatArray]:
        """Entries (pair, packed index, factor) of the upper triangle of H_local = B^T H B."""
        r = self.reduced
        packed = np.zeros((r, r), dtype=np.int64)
        packed[np.triu_indices(r)] = np.arange(r * (r + 1) // 2)
        packed = np.maximum(packed, packed.T)
        sums: dict[tuple[int, int], float] = {}
        b = self.reduction
        for pair, (d, e) in enumerate(zip(*self.local_pairs, strict=True)):
            for i in np.flatnonzero(b[:, d]):
                for j in np.flatnonzero(b[:, e]):
                    key = (pair, int(packed[i, j]))
                    sums[key] = sums.get(key, 0.0) + b[i, d] * b[j, e]
        entries = sorted((p, k, w) for (p, k), w in sums.items() if w != 0.0)
        pairs, indices, factors = zip(*entries, strict=True)
        return np.array(pairs), np.array(indices), np.array(factors)

    @cached_property
    def local_pairs(self) -> tuple[IntArray, IntArray]:
        """Local DOF pairs (i <= j) of the upper triangle, in packed order."""
        i, j = np.triu_indices(self.dofs)
        return i.astype(np.int64), j.astype(np.int64)


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

    @property
    def dissipative(self) -> bool:
        """An energy does not depend on velocity."""
        return False

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
