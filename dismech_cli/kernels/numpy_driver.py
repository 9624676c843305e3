"""Runs kernels on NumPy batches and scatters by precomputed sparse operators."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from .driver import DragLoop, LoadLoop, LoopT, RateLoop, StencilLoop
from .linearization import Linearization, Pattern
from .loop_text import LoopText
from .needed import first_results
from .numpy_rates import NumpyRateLoop
from .shape import DragKernel, Kernel, LoadKernel, RateKernel

# Stencils per call: temporaries of a chunk stay in the second-level cache.
_CHUNK = 2048


def _chunks(count: int) -> list[slice]:
    return [slice(i, min(i + _CHUNK, count)) for i in range(0, count, _CHUNK)]


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
    """Gather, evaluate in chunks, scatter by two sparse operators."""

    def __init__(self, kernel: Kernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> None:
        self._kernel = kernel
        count = len(dofs)
        angles = kernel.dimension * kernel.nodes + np.arange(kernel.angles)
        self._tails, self._heads = _ends(kernel, dofs)
        self._angles = np.ascontiguousarray(dofs[:, angles].T)
        self._auxiliaries = np.ascontiguousarray(auxiliaries.T)
        self._vectors = len(self._tails)
        self._chunks = _chunks(count)
        self._y = np.empty((kernel.reduced, count))
        self._energy = np.empty((kernel.energies, count))
        self._gradient = np.empty((kernel.reduced, count))
        self._hessian = np.empty((kernel.reduced * (kernel.reduced + 1) // 2, count))
        local, reduced, signs = kernel.gradient_table
        self._local, self._reduced, self._signs, self._dofs = local, reduced, signs, dofs
        self._to_residual: csr_matrix | None = None
        pairs, packed, factors = kernel.hessian_table
        i, j = kernel.local_pairs
        slots = pattern.symmetric_slots(dofs[:, i], dofs[:, j])
        self._to_values = _operator(slots[:, pairs], packed, factors, pattern.slots, pattern.slots - 1)

    def energy(self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray) -> FloatArray:
        """Shares of the energy of each stencil [J]."""
        a, energies = self._gathered(q, auxiliary), first_results(self._kernel.function, 1)
        for chunk in self._chunks:
            (self._energy[:, chunk],) = energies(self._y[:, chunk], a[:, chunk], parameters[:, chunk])
        return self._energy.copy()

    def add_residual(
        self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray, r: FloatArray
    ) -> None:
        """Add dE/dq."""
        a, forces = self._gathered(q, auxiliary), first_results(self._kernel.function, 2)
        for chunk in self._chunks:
            _, gradient = forces(self._y[:, chunk], a[:, chunk], parameters[:, chunk])
            _fill(self._gradient, gradient, chunk)
        self._add_gradient(r)

    def add_linearization(
        self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray, into: Linearization
    ) -> None:
        """Add dE/dq and d2E/dq2."""
        a = self._gathered(q, auxiliary)
        for chunk in self._chunks:
            _, gradient, hessian = self._kernel.function(self._y[:, chunk], a[:, chunk], parameters[:, chunk])
            _fill(self._gradient, gradient, chunk)
            _fill(self._hessian, hessian, chunk)
        self._add_gradient(into.residual)
        into.stiffness += self._to_values @ self._hessian.reshape(-1)

    def _gathered(self, q: FloatArray, auxiliary: FloatArray) -> FloatArray:
        """Edge vectors and angles are put in place; auxiliary inputs of the stencils."""
        np.subtract(q[self._heads], q[self._tails], out=self._y[: self._vectors])
        self._y[self._vectors :] = q[self._angles]
        return auxiliary[self._auxiliaries]

    def _add_gradient(self, r: FloatArray) -> None:
        if self._to_residual is None:
            self._to_residual = _operator(
                self._dofs[:, self._local], self._reduced, self._signs, len(r), None
            )
        r += self._to_residual @ self._gradient.reshape(-1)


class NumpyDragLoop:
    """The same for drag kernels."""

    def __init__(self, kernel: DragKernel, dofs: IntArray, pattern: Pattern) -> None:
        self._kernel = kernel
        self._tails, self._heads = _ends(kernel, dofs)
        loaded = dofs[:, kernel.loaded_dofs]
        self._loaded = np.ascontiguousarray(loaded.T)
        row, column, index, sign = kernel.stiffness_table
        spare = pattern.slots - 1
        slots = pattern.slots_of(dofs[:, row], dofs[:, column])
        self._to_stiffness = _operator(slots, index, sign, pattern.slots, spare)
        f = kernel.forces
        i, j = np.divmod(np.arange(f * f), f)
        slots = pattern.slots_of(loaded[:, i], loaded[:, j])
        self._to_damping = _operator(slots, np.arange(f * f), np.ones(f * f), pattern.slots, spare)

    def add_residual(self, q: FloatArray, v: FloatArray, parameters: FloatArray, r: FloatArray) -> None:
        """Add -f."""
        self._add(self._evaluate(q, v, parameters)[0], r)

    def add_linearization(
        self, q: FloatArray, v: FloatArray, parameters: FloatArray, into: Linearization
    ) -> None:
        """Add -f, -df/dq and -df/dv."""
        force, stiffness, damping = self._evaluate(q, v, parameters)
        self._add(force, into.residual)
        into.stiffness += self._to_stiffness @ stiffness.reshape(-1)
        into.damping += self._to_damping @ damping.reshape(-1)

    def _evaluate(
        self, q: FloatArray, v: FloatArray, parameters: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        y = q[self._heads] - q[self._tails]
        force, stiffness, damping = self._kernel.function(y, v[self._loaded], parameters)
        return _rows(force, y.shape[1]), _rows(stiffness, y.shape[1]), _rows(damping, y.shape[1])

    def _add(self, force: FloatArray, r: FloatArray) -> None:
        r += np.bincount(self._loaded.reshape(-1), force.reshape(-1), minlength=len(r))


class NumpyLoadLoop:
    """The same for load kernels."""

    def __init__(self, kernel: LoadKernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> None:
        self._kernel = kernel
        count = len(dofs)
        self._tails, self._heads = _ends(kernel, dofs)
        self._vectors = len(self._tails)
        self._dofs = np.ascontiguousarray(dofs.T)
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
        self._evaluate(q, auxiliary, parameters)
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
        self._evaluate(q, auxiliary, parameters)
        self._add_force(scale, into.residual)
        into.stiffness += scale * (self._to_stiffness @ self._stiffness.reshape(-1))

    def _evaluate(self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray) -> None:
        np.subtract(q[self._heads], q[self._tails], out=self._y[: self._vectors])
        self._y[self._vectors :] = q[self._dofs[self._kernel.dimension * self._kernel.nodes :]]
        a = auxiliary[self._auxiliaries]
        for chunk in _chunks(self._y.shape[1]):
            force, stiffness = self._kernel.function(self._y[:, chunk], a[:, chunk], parameters[:, chunk])
            _fill(self._force, force, chunk)
            _fill(self._stiffness, stiffness, chunk)

    def _add_force(self, scale: float, r: FloatArray) -> None:
        r += scale * np.bincount(self._dofs.reshape(-1), self._force.reshape(-1), minlength=len(r))


def _fill(rows: FloatArray, values: Any, chunk: slice) -> None:
    """Write results of a kernel, which may be single numbers, to the columns of a chunk."""
    for target, value in zip(rows, values, strict=True):
        target[chunk] = value


def _rows(values: Any, count: int) -> FloatArray:
    out = np.empty((len(values), count))
    _fill(out, values, slice(None))
    return out


@frozen
class NumpyDriver:
    """Always available; as fast as the compiled loops on meshes of 1e5 stencils, to a factor of ten."""

    name: str = "numpy"

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
        return _rows(function(inputs), inputs.shape[1])

    def compiled(self, loop: LoopT) -> LoopT | None:
        """None: batches."""
        return None

    def woven(self, text: LoopText, parts: tuple[LoopText, ...]) -> Callable[..., Any] | None:
        """None: batches."""
        return None
