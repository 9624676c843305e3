"""Runs kernels on NumPy batches and scatters by precomputed sparse operators."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from .batches import Batches
from .driver import DragLoop, LoadLoop, LoopT, RateLoop, StencilLoop
from .linearization import Linearization, Pattern
from .loop_text import LoopText
from .numpy_rates import NumpyRateLoop
from .shape import DragKernel, Kernel, LoadKernel, RateKernel


def _operator(
    rows: IntArray, local: IntArray, values: FloatArray, height: int, spare: int | None
) -> csr_matrix:
    """Sparse operator from component-major stencil outputs to a global array.

    Args:
        rows: Target of each entry, shape (S, M).
        local: Output component of each entry, shape (M,).
        values: Factor of each entry, shape (M,).
        height: Length of the global array.
        spare: Target that collects entries of fixed DOFs; they are dropped here.
    """
    stencils, entries = rows.shape
    columns = local[None, :] * stencils + np.arange(stencils)[:, None]
    keep = np.ones(rows.shape, dtype=bool) if spare is None else rows != spare
    data = np.broadcast_to(values, (stencils, entries))[keep]
    width = int(local.max(initial=-1) + 1) * stencils
    return csr_matrix((data, (rows[keep], columns[keep])), shape=(height, width))


def _ends(kernel: Kernel | DragKernel | LoadKernel, dofs: IntArray) -> tuple[IntArray, IntArray]:
    """DOFs of the tails and of the heads of all edge vectors, component by component, shape (M, S)."""
    d = kernel.dimension
    tails = [tail * d + i for tail, _ in kernel.vectors for i in range(d)]
    heads = [head * d + i for _, head in kernel.vectors for i in range(d)]
    return np.ascontiguousarray(dofs[:, tails].T), np.ascontiguousarray(dofs[:, heads].T)


class NumpyStencilLoop:
    """Gather, evaluate, scatter by two sparse operators."""

    def __init__(
        self,
        kernel: Kernel,
        dofs: IntArray,
        auxiliaries: IntArray,
        pattern: Pattern,
        finish: Callable[[FloatArray], None] = lambda packed: None,
    ) -> None:
        """Find out what goes where.

        Args:
            kernel: The energy.
            dofs: Global DOFs of each stencil, shape (S, D).
            auxiliaries: Places of its auxiliary inputs, shape (S, A).
            pattern: Where tangent entries go.
            finish: Changes the packed Hessians before they go there, shape (R (R + 1)/2, S).
        """
        count, packed = len(dofs), kernel.reduced * (kernel.reduced + 1) // 2
        angles = kernel.dimension * kernel.nodes + np.arange(kernel.angles)
        self._batches = Batches(kernel.function)
        self._tails, self._heads = _ends(kernel, dofs)
        self._angles = np.ascontiguousarray(dofs[:, angles].T)
        self._auxiliaries = np.ascontiguousarray(auxiliaries.T)
        self._vectors = len(self._tails)
        self._y = np.empty((kernel.reduced, count))
        self._energy = np.empty((kernel.energies, count))
        self._gradient = np.empty((kernel.reduced, count))
        self._hessian, self._finish = np.empty((packed, count)), finish
        local, reduced, signs = kernel.gradient_table
        self._local, self._reduced, self._signs, self._dofs = local, reduced, signs, dofs
        self._to_residual: csr_matrix | None = None
        pairs, entries, factors = kernel.hessian_table
        i, j = kernel.local_pairs
        slots = pattern.symmetric_slots(dofs[:, i], dofs[:, j])
        self._to_values = _operator(slots[:, pairs], entries, factors, pattern.slots, pattern.slots - 1)

    def energy(self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray) -> FloatArray:
        """Shares of the energy of each stencil [J]."""
        self._batches.evaluate((0,), (self._energy,), *self._gathered(q, auxiliary), parameters)
        return self._energy.copy()

    def add_residual(
        self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray, r: FloatArray
    ) -> None:
        """Add dE/dq."""
        self._batches.evaluate((1,), (self._gradient,), *self._gathered(q, auxiliary), parameters)
        self._add_gradient(r)

    def add_linearization(
        self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray, into: Linearization
    ) -> None:
        """Add dE/dq and d2E/dq2."""
        self._batches.evaluate(
            (1, 2), (self._gradient, self._hessian), *self._gathered(q, auxiliary), parameters
        )
        self._finish(self._hessian)
        self._add_gradient(into.residual)
        into.stiffness += self._to_values @ self._hessian.reshape(-1)

    def _gathered(self, q: FloatArray, auxiliary: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Edge vectors and angles, put in place, and auxiliary inputs of the stencils."""
        np.subtract(q[self._heads], q[self._tails], out=self._y[: self._vectors])
        self._y[self._vectors :] = q[self._angles]
        return self._y, auxiliary[self._auxiliaries]

    def _add_gradient(self, r: FloatArray) -> None:
        if self._to_residual is None:
            self._to_residual = _operator(
                self._dofs[:, self._local], self._reduced, self._signs, len(r), None
            )
        r += self._to_residual @ self._gradient.reshape(-1)


class NumpyDragLoop:
    """The same for drag kernels."""

    def __init__(self, kernel: DragKernel, dofs: IntArray, pattern: Pattern) -> None:
        count, f = len(dofs), kernel.forces
        self._batches = Batches(kernel.function)
        self._tails, self._heads = _ends(kernel, dofs)
        loaded = dofs[:, kernel.loaded_dofs]
        self._loaded = np.ascontiguousarray(loaded.T)
        self._force = np.empty((f, count))
        self._stiffness, self._damping = np.empty((f * kernel.reduced, count)), np.empty((f * f, count))
        row, column, index, sign = kernel.stiffness_table
        spare = pattern.slots - 1
        slots = pattern.slots_of(dofs[:, row], dofs[:, column])
        self._to_stiffness = _operator(slots, index, sign, pattern.slots, spare)
        i, j = np.divmod(np.arange(f * f), f)
        slots = pattern.slots_of(loaded[:, i], loaded[:, j])
        self._to_damping = _operator(slots, np.arange(f * f), np.ones(f * f), pattern.slots, spare)

    def add_residual(self, q: FloatArray, v: FloatArray, parameters: FloatArray, r: FloatArray) -> None:
        """Add -f."""
        self._batches.evaluate((0,), (self._force,), *self._gathered(q, v), parameters)
        self._add_force(r)

    def add_linearization(
        self, q: FloatArray, v: FloatArray, parameters: FloatArray, into: Linearization
    ) -> None:
        """Add -f, -df/dq and -df/dv."""
        out = (self._force, self._stiffness, self._damping)
        self._batches.evaluate((0, 1, 2), out, *self._gathered(q, v), parameters)
        self._add_force(into.residual)
        into.stiffness += self._to_stiffness @ self._stiffness.reshape(-1)
        into.damping += self._to_damping @ self._damping.reshape(-1)

    def _gathered(self, q: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Edge vectors, and velocities of the loaded nodes."""
        return q[self._heads] - q[self._tails], v[self._loaded]

    def _add_force(self, r: FloatArray) -> None:
        r += np.bincount(self._loaded.reshape(-1), self._force.reshape(-1), minlength=len(r))


class NumpyLoadLoop:
    """The same for load kernels."""

    def __init__(self, kernel: LoadKernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> None:
        count = len(dofs)
        self._batches = Batches(kernel.function)
        self._tails, self._heads = _ends(kernel, dofs)
        self._vectors = len(self._tails)
        self._dofs = np.ascontiguousarray(dofs.T)
        self._angles = self._dofs[kernel.dimension * kernel.nodes :]
        self._auxiliaries = np.ascontiguousarray(auxiliaries.T)
        self._y = np.empty((kernel.reduced, count))
        self._force = np.empty((kernel.dofs, count))
        self._stiffness = np.empty((kernel.dofs * kernel.reduced, count))
        row, column, index, sign = kernel.stiffness_table
        slots = pattern.slots_of(dofs[:, row], dofs[:, column])
        self._to_stiffness = _operator(slots, index, sign, pattern.slots, pattern.slots - 1)

    def add_residual(
        self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray, scale: float, r: FloatArray
    ) -> None:
        """Add -f."""
        self._batches.evaluate((0,), (self._force,), *self._gathered(q, auxiliary), parameters)
        self._add_force(scale, r)

    def add_linearization(
        self,
        q: FloatArray,
        auxiliary: FloatArray,
        parameters: FloatArray,
        scale: float,
        into: Linearization,
    ) -> None:
        """Add -f and -df/dq."""
        self._batches.evaluate(
            (0, 1), (self._force, self._stiffness), *self._gathered(q, auxiliary), parameters
        )
        self._add_force(scale, into.residual)
        into.stiffness += scale * (self._to_stiffness @ self._stiffness.reshape(-1))

    def _gathered(self, q: FloatArray, auxiliary: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Edge vectors and angles, put in place, and auxiliary inputs of the stencils."""
        np.subtract(q[self._heads], q[self._tails], out=self._y[: self._vectors])
        self._y[self._vectors :] = q[self._angles]
        return self._y, auxiliary[self._auxiliaries]

    def _add_force(self, scale: float, r: FloatArray) -> None:
        r += scale * np.bincount(self._dofs.reshape(-1), self._force.reshape(-1), minlength=len(r))


@frozen
class NumpyDriver:
    """Always available; as fast as the compiled loops on meshes of 1e5 stencils, to a factor of ten."""

    name: str = "numpy"
    _maps: dict[Callable[[Any], Any], Batches] = field(default_factory=dict, compare=False, repr=False)

    def stencil(self, kernel: Kernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> StencilLoop:
        """Loop of an energy kernel."""
        return NumpyStencilLoop(kernel, dofs, auxiliaries, pattern)

    def drag(self, kernel: DragKernel, dofs: IntArray, pattern: Pattern) -> DragLoop:
        """Loop of a drag kernel."""
        return NumpyDragLoop(kernel, dofs, pattern)

    def load(self, kernel: LoadKernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> LoadLoop:
        """Loop of a load kernel."""
        return NumpyLoadLoop(kernel, dofs, auxiliaries, pattern)

    def rate(self, kernel: RateKernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> RateLoop:
        """Loop of a rate kernel."""
        return NumpyRateLoop(kernel, dofs, auxiliaries, pattern)

    def map(self, function: Callable[[Any], Any], inputs: FloatArray, outputs: int) -> FloatArray:
        """Apply a kernel column by column."""
        if function not in self._maps:
            self._maps[function] = Batches(lambda x: (function(x),))
        out = np.empty((outputs, inputs.shape[1]))
        self._maps[function].evaluate((0,), (out,), inputs)
        return out

    def compiled(self, loop: LoopT) -> LoopT | None:
        """None: batches."""
        return None

    def woven(self, text: LoopText, parts: tuple[LoopText, ...]) -> Callable[..., Any] | None:
        """None: batches."""
        return None
