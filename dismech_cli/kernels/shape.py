"""Pure kernels with the shape of their stencils.

An energy kernel sees reduced variables only: differences of node positions (edge vectors) and
angles. Because node positions enter through differences, gradient and Hessian with respect to nodes
follow from constant +-1 patterns, tabulated here once per kernel. A drag kernel sees edge vectors,
velocities of some nodes of the stencil and constants, and returns its residual share on those same
nodes with both tangents. A load kernel sees what an energy kernel sees and returns its residual share
on all DOFs of the stencil: its force has no potential. A rate kernel sees that too, and returns strains with
the viscosities that their rates meet.

Kernels name their parameters: only they know in which row of p a name stands.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen


@frozen
class Parameters:
    """Names of what a kernel reads for each stencil, in the order in which it reads them.

    Attributes:
        names: Unique names.
    """

    names: tuple[str, ...]

    def __post_init__(self) -> None:
        if len(set(self.names)) != len(self.names):
            raise ValueError(f"parameters named twice: {', '.join(self.names)}")

    def __len__(self) -> int:
        return len(self.names)

    def row(self, name: str) -> int:
        """Row of a parameter in p.

        Raises:
            KeyError: The kernel has none of that name.
        """
        if name not in self.names:
            raise KeyError(f"no parameter {name}: the kernel has {', '.join(self.names)}")
        return self.names.index(name)

    def stack(self, values: Mapping[str, FloatArray | float], stencils: int) -> FloatArray:
        """All parameters, shape (P, S), from one number or S of them for each name.

        Raises:
            KeyError: A name is missing, or is none of the kernel's.
        """
        for name in values:
            self.row(name)
        missing = [name for name in self.names if name not in values]
        if missing:
            raise KeyError(f"no value for {', '.join(missing)}")
        out = np.empty((len(self.names), stencils))
        for row, name in zip(out, self.names, strict=True):
            row[:] = values[name]
        return out


def _reduction(dimension: int, nodes: int, vectors: tuple[tuple[int, int], ...], angles: int) -> FloatArray:
    b = np.zeros((dimension * len(vectors) + angles, dimension * nodes + angles))
    for k, (tail, head) in enumerate(vectors):
        for i in range(dimension):
            b[k * dimension + i, tail * dimension + i] = -1.0
            b[k * dimension + i, head * dimension + i] = 1.0
    for k in range(angles):
        b[dimension * len(vectors) + k, dimension * nodes + k] = 1.0
    return b


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
        naturals: Names of the natural strains, with which p starts.
        constants: Names of the stiffnesses and measures that end p.
        scales: For each natural strain, the stiffnesses that weigh it: where all of them vanish,
            the natural strain changes nothing.
        shares: Names of the parts that the energy comes in, a tuple where they are several; empty where
            it is one number that counts under the name of the term.
    """

    function: Callable[[Any, Any, Any], Any]
    dimension: int
    nodes: int
    vectors: tuple[tuple[int, int], ...]
    constants: tuple[str, ...]
    naturals: tuple[str, ...] = ()
    scales: tuple[tuple[str, ...], ...] = ()
    angles: int = 0
    auxiliaries: int = 0
    shares: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if len(self.scales) != len(self.naturals):
            raise ValueError("every natural strain has its stiffnesses")
        for name in (name for scale in self.scales for name in scale):
            if name not in self.constants:
                raise ValueError(f"{name} scales a natural strain and is not among the constants")

    @cached_property
    def parameters(self) -> Parameters:
        """Names of p: natural strains, then constants."""
        return Parameters(self.naturals + self.constants)

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
        return _reduction(self.dimension, self.nodes, self.vectors, self.angles)

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


@dataclass(frozen=True)
class DragKernel:
    """A velocity-dependent force and the shape of its stencil.

    Attributes:
        function: ``f(y, u, p) -> (r (F), dr/dy (F*R by rows), dr/du (F*F by rows))``, tuples; y
            are the edge-vector components, u the velocities of the ``loaded`` nodes.
        dimension: Components of a vector: 2 or 3.
        nodes: Nodes per stencil.
        vectors: Edge vectors as (tail, head) local nodes.
        loaded: Local nodes whose velocities enter and that receive the force.
        constants: Names of p.
    """

    function: Callable[[Any, Any, Any], Any]
    dimension: int
    nodes: int
    vectors: tuple[tuple[int, int], ...]
    loaded: tuple[int, ...]
    constants: tuple[str, ...]

    @cached_property
    def parameters(self) -> Parameters:
        """Names of p."""
        return Parameters(self.constants)

    @property
    def reduced(self) -> int:
        """Number R of edge-vector components."""
        return self.dimension * len(self.vectors)

    @property
    def forces(self) -> int:
        """Number F of force components."""
        return self.dimension * len(self.loaded)

    @cached_property
    def loaded_dofs(self) -> IntArray:
        """Local DOFs of the loaded nodes, shape (F,)."""
        d = self.dimension
        return (np.array(self.loaded)[:, None] * d + np.arange(d)).reshape(-1)

    @cached_property
    def stiffness_table(self) -> tuple[IntArray, IntArray, IntArray, FloatArray]:
        """Entries (row DOF, column DOF, index into dr/dy, sign) of dr/dq_local."""
        d, entries = self.dimension, []
        for f, row in enumerate(self.loaded_dofs):
            for k, (tail, head) in enumerate(self.vectors):
                for i in range(d):
                    index = f * self.reduced + k * d + i
                    entries.append((row, tail * d + i, index, -1.0))
                    entries.append((row, head * d + i, index, 1.0))
        rows, columns, indices, signs = zip(*entries, strict=True)
        return np.array(rows), np.array(columns), np.array(indices), np.array(signs)


@dataclass(frozen=True)
class LoadKernel:
    """A force without potential that depends on the state, and the shape of its stencil.

    Attributes:
        function: ``f(y, a, p) -> (r (D), dr/dy (D*R by rows))``, tuples: the residual on all DOFs of
            the stencil, nodes first, at unit scale.
        dimension: Components of a vector: 2 or 3.
        nodes: Nodes per stencil.
        vectors: Edge vectors as (tail, head) local nodes; y starts with their components.
        constants: Names of p.
        angles: Angles per stencil; they end y.
        auxiliaries: Inputs a taken from the trial frames.
    """

    function: Callable[[Any, Any, Any], Any]
    dimension: int
    nodes: int
    vectors: tuple[tuple[int, int], ...]
    constants: tuple[str, ...]
    angles: int = 0
    auxiliaries: int = 0

    @cached_property
    def parameters(self) -> Parameters:
        """Names of p."""
        return Parameters(self.constants)

    @property
    def reduced(self) -> int:
        """Number R of reduced variables."""
        return self.dimension * len(self.vectors) + self.angles

    @property
    def dofs(self) -> int:
        """Number D of DOFs per stencil."""
        return self.dimension * self.nodes + self.angles

    @cached_property
    def stiffness_table(self) -> tuple[IntArray, IntArray, IntArray, FloatArray]:
        """Entries (row DOF, column DOF, index into dr/dy, sign) of dr/dq_local = dr/dy B."""
        b = _reduction(self.dimension, self.nodes, self.vectors, self.angles)
        variable, column = np.nonzero(b)
        row = np.repeat(np.arange(self.dofs), len(column))
        variables, columns = np.tile(variable, self.dofs), np.tile(column, self.dofs)
        return row, columns, row * self.reduced + variables, b[variables, columns]


@dataclass(frozen=True)
class RateKernel:
    """Strains that resist their rates: r = sum_kl (de_k/dq) V_kl (de_l/dt).

    Loops form the rates from the velocities. The residual and both tangents follow from what the kernel
    returns, whatever the strains are.

    Attributes:
        function: ``f(y, a, p, w) -> (slopes, curvature, viscosities)``, tuples: the gradient (R) and the
            packed Hessian R(R+1)/2 to y of sum_k w_k e_k, and the upper triangle of V by rows.
        elastic: Energy of the same strains: its stencil is this one's.
        strains: Number of strains.
        constants: Names of p.
    """

    function: Callable[[Any, Any, Any, Any], Any]
    elastic: Kernel
    strains: int
    constants: tuple[str, ...]

    @cached_property
    def parameters(self) -> Parameters:
        """Names of p."""
        return Parameters(self.constants)

    @property
    def dimension(self) -> int:
        """Components of an edge vector."""
        return self.elastic.dimension

    @property
    def nodes(self) -> int:
        """Nodes per stencil."""
        return self.elastic.nodes

    @property
    def vectors(self) -> tuple[tuple[int, int], ...]:
        """Edge vectors as (tail, head) local nodes."""
        return self.elastic.vectors

    @property
    def auxiliaries(self) -> int:
        """Inputs taken from the trial frames."""
        return self.elastic.auxiliaries

    @property
    def reduced(self) -> int:
        """Number R of reduced variables."""
        return self.elastic.reduced

    @property
    def dofs(self) -> int:
        """Number D of DOFs per stencil."""
        return self.elastic.dofs

    @cached_property
    def tangent_table(self) -> tuple[IntArray, IntArray, IntArray, FloatArray]:
        """Entries (row DOF, column DOF, index by rows of K, factor) of K_local = B^T K B."""
        b, r = self.elastic.reduction, self.reduced
        variable, dof = np.nonzero(b)
        count = len(dof)
        i, j = np.repeat(np.arange(count), count), np.tile(np.arange(count), count)
        return dof[i], dof[j], variable[i] * r + variable[j], b[variable[i], dof[i]] * b[variable[j], dof[j]]

    @cached_property
    def loop_tables(self) -> tuple[IntArray | FloatArray, ...]:
        """What compiled loops look up: the slopes' table, then place in the tangent, index and factor."""
        row, column, sign = self.elastic.gradient_table
        place, other, entry, factor = self.tangent_table
        return row, column, sign, place * self.dofs + other, entry, factor
