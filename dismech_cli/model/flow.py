"""Drag in a fluid that moves: what counts is the velocity relative to the fluid, v - u(x, t)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field, replace
from typing import ClassVar, Protocol

import numpy as np

from ..arrays import FloatArray, IntArray, distinct
from ..frozen import frozen
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Linearization, Pattern
from ..kinematics.dofs import DofMap
from ..laws.field import Field
from .configuration import Configuration
from .term import BoundTerm, Term


class Drag(Term, Protocol):
    """A force that depends on the velocities of some nodes, stencil by stencil."""

    @property
    def loaded(self) -> IntArray:
        """DOFs of the nodes whose velocities enter and that it acts on, node by node, shape (S, F)."""

    def resistance(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """Slope of its residual share to these velocities [N s/m], shape (S, F, F)."""


@frozen
class DragInFlow:
    """A drag whose velocities are those relative to a fluid.

    Attributes:
        drag: The drag.
        flow: Velocity of the fluid [m/s], a field for each axis of the model.
        dofs: Numbering.
    """

    drag: Drag
    flow: Sequence[Field]
    dofs: DofMap
    velocity_dependent: ClassVar[bool] = True

    @property
    def name(self) -> str:
        """Name of the drag."""
        return self.drag.name

    @property
    def uniform(self) -> bool:
        """Whether the fluid moves alike everywhere."""
        return all(component.uniform for component in self.flow)

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """Those of the drag; a flow that varies in space makes forces depend on positions too."""
        if self.uniform:
            return self.drag.couplings
        return (*self.drag.couplings, Coupling(self.drag.loaded, symmetric=False))

    @property
    def wet(self) -> IntArray:
        """Nodes in the fluid, ascending, shape (W,)."""
        d = self.dofs.dimension
        nodes: IntArray = distinct(self.drag.loaded[:, ::d] // d)
        return nodes

    def refuse_infinite(self, q: FloatArray) -> None:
        """Refuse a flow that has no value or slope at the start, at positions ``q`` (n,).

        Raises:
            LawError: It has none.
        """
        x = self.dofs.space_positions(q)[self.wet]
        for component in self.flow:
            component.value(0.0, x)
            component.gradient(0.0, x)

    def bind(self, pattern: Pattern, driver: Driver) -> BoundDragInFlow:
        """Bind the drag and find the nodes that are in the fluid."""
        loaded = self.drag.loaded
        slots = None
        if not self.uniform:
            count = loaded.shape[1]
            i, j = np.divmod(np.arange(count**2), count)
            slots = pattern.slots_of(loaded[:, i], loaded[:, j])
        return BoundDragInFlow(self.name, self, self.drag.bind(pattern, driver), self.wet, slots)


@frozen
class BoundDragInFlow:
    """A drag in a fluid that moves, bound to a pattern.

    Attributes:
        name: Unique name.
        term: What it is of.
        still: The same drag as if the fluid were still.
        wet: Nodes in the fluid, ascending, shape (W,).
        slots: Where the slope of the flow goes, shape (S, F * F); None where it has none.
    """

    name: str
    term: DragInFlow
    still: BoundTerm
    wet: IntArray
    slots: IntArray | None = field(repr=False)
    potential: ClassVar[None] = None

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        """Add -f."""
        self.still.add_residual(self._relative(c), r)

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Add -f, -df/dq and -df/dv; df/dq has a part -df/dv du/dx from the flow."""
        relative = self._relative(c)
        self.still.add_linearization(relative, into)
        if self.slots is not None:
            local = -self._resistance_times_slope(relative)
            into.stiffness += np.bincount(
                self.slots.reshape(-1), local.reshape(-1), minlength=len(into.stiffness)
            )

    def _relative(self, c: Configuration) -> Configuration:
        dofs = self.term.dofs
        x = dofs.space_positions(c.q)[self.wet]
        v = c.v.copy()
        for component, field_ in zip(dofs.of_nodes(self.wet).T, self.term.flow, strict=True):
            v[component] -= field_.value(c.t, x)
        return replace(c, v=v)

    def _resistance_times_slope(self, c: Configuration) -> FloatArray:
        """C du/dx of every stencil, shape (S, F, F / d, d)."""
        term, d = self.term, self.term.dofs.dimension
        x = term.dofs.space_positions(c.q)[self.wet]
        axes = list(term.dofs.axes)
        slope = np.stack([one.gradient(c.t, x)[:, axes] for one in term.flow], axis=1)
        loaded = term.drag.loaded
        nodes = np.searchsorted(self.wet, loaded[:, ::d] // d)
        c_blocks = term.drag.resistance(c.q, c.v).reshape(len(loaded), -1, nodes.shape[1], d)
        product: FloatArray = np.einsum("sfnk,snkl->sfnl", c_blocks, slope[nodes])
        return product
