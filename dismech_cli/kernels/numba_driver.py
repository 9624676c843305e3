"""Runs the same kernel text in compiled loops (extra ``[fast]``)."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from .driver import DragLoop, LoadLoop, LoopT, RateLoop, StencilLoop
from .linearization import Linearization, Pattern
from .loop_module import LoopModule
from .loop_text import LoopText, call_text, drag_text, load_text, map_text, rate_text, stencil_text
from .shape import DragKernel, Kernel, LoadKernel, RateKernel


def _unsigned(indices: IntArray) -> NDArray[np.uint32]:
    """Row-major unsigned indices: no check for negative ones, half the memory of the usual integers."""
    return np.ascontiguousarray(indices, dtype=np.uint32)


@cache
def _module(text: LoopText) -> LoopModule:
    return LoopModule(text)


def _stencil_loops(kernel: Kernel) -> LoopModule:
    return _module(stencil_text(kernel))


class NumbaStencilLoop:
    """Serial compiled loop over stencils."""

    def __init__(self, kernel: Kernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> None:
        self._loops = _stencil_loops(kernel)
        self._energies = kernel.energies
        self._indices = (_unsigned(dofs), _unsigned(auxiliaries))
        i, j = kernel.local_pairs
        self._slots = _unsigned(pattern.symmetric_slots(dofs[:, i], dofs[:, j]))

    def energy(self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray) -> FloatArray:
        """Shares of the energy of each stencil [J]."""
        out = np.empty((self._energies, parameters.shape[1]))
        self._loops.run("energies", q, auxiliary, parameters, *self._indices, out)
        return out

    def add_residual(
        self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray, r: FloatArray
    ) -> None:
        """Add dE/dq."""
        self._loops.run("residual", q, auxiliary, parameters, *self._indices, r)

    def add_linearization(
        self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray, into: Linearization
    ) -> None:
        """Add dE/dq and d2E/dq2."""
        self._loops.run(
            "linearization",
            q,
            auxiliary,
            parameters,
            *self._indices,
            into.residual,
            into.stiffness,
            self._slots,
        )


def _drag_loops(kernel: DragKernel) -> LoopModule:
    return _module(drag_text(kernel))


class NumbaDragLoop:
    """Serial compiled loop over drag stencils."""

    def __init__(self, kernel: DragKernel, dofs: IntArray, pattern: Pattern) -> None:
        self._loops = _drag_loops(kernel)
        self._dofs = _unsigned(dofs)
        loaded = dofs[:, kernel.loaded_dofs]
        row, column, _, _ = kernel.stiffness_table
        i, j = np.divmod(np.arange(kernel.forces**2), kernel.forces)
        self._slots = (
            _unsigned(pattern.slots_of(dofs[:, row], dofs[:, column])),
            _unsigned(pattern.slots_of(loaded[:, i], loaded[:, j])),
        )

    def add_residual(self, q: FloatArray, v: FloatArray, parameters: FloatArray, r: FloatArray) -> None:
        """Add -f."""
        self._loops.run("residual", q, v, parameters, self._dofs, r)

    def add_linearization(
        self, q: FloatArray, v: FloatArray, parameters: FloatArray, into: Linearization
    ) -> None:
        """Add -f, -df/dq and -df/dv."""
        self._loops.run(
            "linearization",
            q,
            v,
            parameters,
            self._dofs,
            into.residual,
            into.stiffness,
            into.damping,
            *self._slots,
        )


def _load_loops(kernel: LoadKernel) -> LoopModule:
    return _module(load_text(kernel))


class NumbaLoadLoop:
    """Serial compiled loop over load stencils."""

    def __init__(self, kernel: LoadKernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> None:
        self._loops = _load_loops(kernel)
        self._indices = (_unsigned(dofs), _unsigned(auxiliaries))
        i, j = np.divmod(np.arange(kernel.dofs**2), kernel.dofs)
        self._slots = _unsigned(pattern.slots_of(dofs[:, i], dofs[:, j]))

    def add_residual(
        self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray, scale: float, r: FloatArray
    ) -> None:
        """Add -f."""
        self._loops.run("residual", q, auxiliary, parameters, scale, *self._indices, r)

    def add_linearization(
        self,
        q: FloatArray,
        auxiliary: FloatArray,
        parameters: FloatArray,
        scale: float,
        into: Linearization,
    ) -> None:
        """Add -f and -df/dq."""
        self._loops.run(
            "linearization",
            q,
            auxiliary,
            parameters,
            scale,
            *self._indices,
            into.residual,
            into.stiffness,
            self._slots,
        )


def _rate_loops(kernel: RateKernel) -> LoopModule:
    return _module(rate_text(kernel))


class NumbaRateLoop:
    """Serial compiled loop over stencils of a viscous stress."""

    def __init__(self, kernel: RateKernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> None:
        self._loops = _rate_loops(kernel)
        self._indices = (_unsigned(dofs), _unsigned(auxiliaries))
        self._tables = kernel.loop_tables
        i, j = np.divmod(np.arange(kernel.dofs**2), kernel.dofs)
        self._slots = _unsigned(pattern.slots_of(dofs[:, i], dofs[:, j]))

    def add_residual(
        self, q: FloatArray, v: FloatArray, auxiliary: FloatArray, parameters: FloatArray, r: FloatArray
    ) -> None:
        """Add the residual."""
        self._loops.run("residual", q, v, auxiliary, parameters, *self._indices, r, self._tables)

    def add_linearization(
        self,
        q: FloatArray,
        v: FloatArray,
        auxiliary: FloatArray,
        parameters: FloatArray,
        into: Linearization,
    ) -> None:
        """Add the residual and both tangents."""
        self._loops.run(
            "linearization",
            q,
            v,
            auxiliary,
            parameters,
            *self._indices,
            into.residual,
            self._tables,
            into.stiffness,
            into.damping,
            self._slots,
        )


def _map_loop(function: Callable[..., Any], inputs: int, outputs: int) -> LoopModule:
    return _module(map_text(function, inputs, outputs))


def _call_loop(function: Callable[..., Any]) -> LoopModule:
    return _module(call_text(function))


@frozen
class NumbaDriver:
    """Compiled loops; needs the extra ``[fast]``."""

    name: str = "numba"

    def stencil(self, kernel: Kernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> StencilLoop:
        """Loop of an energy kernel."""
        return NumbaStencilLoop(kernel, dofs, auxiliaries, pattern)

    def drag(self, kernel: DragKernel, dofs: IntArray, pattern: Pattern) -> DragLoop:
        """Loop of a drag kernel."""
        return NumbaDragLoop(kernel, dofs, pattern)

    def load(self, kernel: LoadKernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> LoadLoop:
        """Loop of a load kernel."""
        return NumbaLoadLoop(kernel, dofs, auxiliaries, pattern)

    def rate(self, kernel: RateKernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> RateLoop:
        """Loop of a rate kernel."""
        return NumbaRateLoop(kernel, dofs, auxiliaries, pattern)

    def map(self, function: Callable[[Any], Any], inputs: FloatArray, outputs: int) -> FloatArray:
        """Apply a kernel column by column."""
        out = np.empty((outputs, inputs.shape[1]))
        _map_loop(function, len(inputs), outputs).run("loop", inputs, out)
        return out

    def compiled(self, loop: LoopT) -> LoopT | None:
        """The loop, compiled when it is first called."""
        return cast(LoopT, partial(_call_loop(loop).run, "loop"))

    def woven(self, text: LoopText, parts: tuple[LoopText, ...]) -> Callable[..., Any] | None:
        """The loop, compiled when it is first called."""
        for part in parts:
            _module(part)
        return partial(_module(text).run, text.main)
