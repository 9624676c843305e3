"""From a pure drag kernel to a term: forces that depend on velocity and on edge directions.

A drag kernel sees edge vectors (position differences), velocities of some nodes of the stencil
and constants, and returns its residual share on those same nodes with both tangents.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from .configuration import Configuration
from .driver import DragLoop, Driver
from .term import Coupling, Linearization, Pattern


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
        parameters: Length of p.
    """

    function: Callable[[Any, Any, Any], Any]
    dimension: int
    nodes: int
    vectors: tuple[tuple[int, int], ...]
    loaded: tuple[int, ...]
    parameters: int

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


@dataclass(frozen=True, slots=True)
class DragForce:
    """Many stencils of one drag force.

    Attributes:
        name: Unique name.
        kernel: The force.
        dofs: Global DOFs of each stencil, shape (S, D).
        parameters: Constants, shape (P, S).
    """

    name: str
    kernel: DragKernel
    dofs: IntArray
    parameters: FloatArray

    @property
    def dissipative(self) -> bool:
        """Drag depends on velocity."""
        return True

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """One clique per stencil; the tangent is not symmetric."""
        return (Coupling(self.dofs, symmetric=False),)

    def bind(self, pattern: Pattern, driver: Driver) -> BoundDrag:
        """Make the gather-evaluate-scatter loop."""
        return BoundDrag(self.name, driver.drag(self.kernel, self.dofs, pattern), self.parameters)


@dataclass(frozen=True, slots=True)
class BoundDrag:
    """A drag force bound to a pattern."""

    name: str
    loop: DragLoop
    parameters: FloatArray

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        """Add -f."""
        self.loop.add_residual(c.q, c.v, self.parameters, r)

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Add -f, -df/dq, -df/dv."""
        self.loop.add_linearization(c.q, c.v, self.parameters, into)
