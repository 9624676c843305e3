"""Loops that note what they are run with instead of running: what compiled steps are woven of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field
from typing import Any, Final, cast

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from .driver import DragLoop, LoadLoop, LoopT, RateLoop, StencilLoop
from .linearization import Linearization, Pattern
from .loop_text import LoopText, call_text, drag_text, load_text, rate_text, stencil_text
from .shape import DragKernel, Kernel, LoadKernel, RateKernel


@frozen
class Block:
    """The loop of one term.

    Attributes:
        text: Its module.
        arguments: What its main loop takes: positions ``x``, velocities ``v``, ``auxiliary``, its parameters
            ``{p}``, each of them stacked and taken ``{at}`` a place, its tables of ``{indices}`` and of
            ``{slots}``, and what it adds to.
        indices: Tables of DOFs and places.
        slots: Tables of slots, one for each tangent that it has.
        tables: Others, after the parameters.
    """

    text: LoopText
    arguments: str
    indices: tuple[IntArray, ...]
    slots: tuple[IntArray, ...]
    tables: tuple[Any, ...] = ()


@frozen
class Call:
    """A loop that was run.

    Attributes:
        block: The loop.
        q: What it was given, shape (n,); None for loops that take no positions.
        v: Likewise; None for loops that take no velocity.
        parameters: Likewise, one or more for each stencil, and the scale where there is one.
    """

    block: Block
    q: FloatArray | None
    v: FloatArray | None
    parameters: tuple[FloatArray | float, ...]


# Each of them is a loop that can be linearised and nothing else, since nothing else is asked of it.


@frozen
class _NotedStencils:
    block: Block
    calls: list[Call]

    def add_linearization(
        self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray, into: Linearization
    ) -> None:
        self.calls.append(Call(self.block, q, None, (parameters,)))


@frozen
class _NotedDrag:
    block: Block
    calls: list[Call]

    def add_linearization(
        self, q: FloatArray, v: FloatArray, parameters: FloatArray, into: Linearization
    ) -> None:
        self.calls.append(Call(self.block, q, v, (parameters,)))


@frozen
class _NotedLoad:
    block: Block
    calls: list[Call]

    def add_linearization(
        self,
        q: FloatArray,
        auxiliary: FloatArray,
        parameters: FloatArray,
        scale: float,
        into: Linearization,
    ) -> None:
        self.calls.append(Call(self.block, q, None, (parameters, scale)))


@frozen
class _NotedRates:
    block: Block
    calls: list[Call]

    def add_linearization(
        self,
        q: FloatArray,
        v: FloatArray,
        auxiliary: FloatArray,
        parameters: FloatArray,
        into: Linearization,
    ) -> None:
        self.calls.append(Call(self.block, q, v, (parameters,)))


@frozen
class _NotedCall:
    text: LoopText
    calls: list[Call]

    def __call__(
        self,
        v: FloatArray,
        parameters: FloatArray,
        dofs: IntArray,
        r: FloatArray,
        damping: FloatArray,
        slots: IntArray,
    ) -> None:
        block = Block(self.text, _VISCOUS, (dofs,), (slots,))
        self.calls.append(Call(block, None, v, (parameters,)))


_STENCILS: Final = "x, auxiliary, {p}[0][{at}], {indices}[0], {indices}[1], r, stiffness, {slots}[0]"
_DRAG: Final = "x, v, {p}[0][{at}], {indices}[0], r, stiffness, damping, {slots}[0], {slots}[1]"
_LOAD: Final = (
    "x, auxiliary, {p}[0][{at}], {p}[1][{at}], {indices}[0], {indices}[1], r, stiffness, {slots}[0]"
)
_RATES: Final = (
    "x, v, auxiliary, {p}[0][{at}], {indices}[0], {indices}[1], r, {p}[1], stiffness, damping, {slots}[0]"
)
_VISCOUS: Final = "v, {p}[0][{at}], {indices}[0], r, damping, {slots}[0]"


class NotWovenError(Exception):
    """A term has a loop that compiled steps cannot take."""


@frozen
class NotingDriver:
    """A driver of loops that note; implements :class:`.driver.Driver`.

    Attributes:
        calls: The loops that ran since this was cleared, in order.
        name: ``noting``.
    """

    calls: list[Call] = field(default_factory=list)
    name: str = "noting"

    def stencil(self, kernel: Kernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> StencilLoop:
        """Loop of an energy kernel."""
        i, j = kernel.local_pairs
        slots = (pattern.symmetric_slots(dofs[:, i], dofs[:, j]),)
        block = Block(stencil_text(kernel), _STENCILS, (dofs, auxiliaries), slots)
        return cast(StencilLoop, _NotedStencils(block, self.calls))

    def drag(self, kernel: DragKernel, dofs: IntArray, pattern: Pattern) -> DragLoop:
        """Loop of a drag kernel."""
        loaded = dofs[:, kernel.loaded_dofs]
        row, column, _, _ = kernel.stiffness_table
        i, j = np.divmod(np.arange(kernel.forces**2), kernel.forces)
        slots = (
            pattern.slots_of(dofs[:, row], dofs[:, column]),
            pattern.slots_of(loaded[:, i], loaded[:, j]),
        )
        return cast(DragLoop, _NotedDrag(Block(drag_text(kernel), _DRAG, (dofs,), slots), self.calls))

    def load(self, kernel: LoadKernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> LoadLoop:
        """Loop of a load kernel."""
        block = Block(load_text(kernel), _LOAD, (dofs, auxiliaries), (_pairs(dofs, pattern),))
        return cast(LoadLoop, _NotedLoad(block, self.calls))

    def rate(self, kernel: RateKernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> RateLoop:
        """Loop of a rate kernel."""
        slots = (_pairs(dofs, pattern),)
        block = Block(rate_text(kernel), _RATES, (dofs, auxiliaries), slots, (kernel.loop_tables,))
        return cast(RateLoop, _NotedRates(block, self.calls))

    def map(self, function: Callable[[Any], Any], inputs: FloatArray, outputs: int) -> FloatArray:
        """Refuse."""
        raise NotWovenError

    def compiled(self, loop: LoopT) -> LoopT | None:
        """A loop that adds what velocities meet; it notes too."""
        return cast(LoopT, _NotedCall(call_text(loop), self.calls))

    def woven(self, text: LoopText, parts: tuple[LoopText, ...]) -> Callable[..., Any] | None:
        """None."""
        return None


def _pairs(dofs: IntArray, pattern: Pattern) -> IntArray:
    """Slots of all pairs of DOFs of each stencil, row by row, shape (S, D^2)."""
    i, j = np.divmod(np.arange(dofs.shape[1] ** 2), dofs.shape[1])
    return pattern.slots_of(dofs[:, i], dofs[:, j])
