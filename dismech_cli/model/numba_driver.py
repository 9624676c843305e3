"""Runs the same kernel text in compiled loops (extra ``[fast]``).

Compiled code is cached on disk in a folder named by a hash of all kernel sources: Numba's own
cache does not notice an edit of a function that a loop calls.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..geometry.kernel import marked_kernels
from .drag import DragKernel
from .driver import DragLoop, StencilLoop
from .stencil import Kernel
from .term import Linearization, Pattern

# Reassociation and contraction only: never nnan or ninf, which delete checks for NaN.
_FASTMATH = {"nsz", "arcp", "contract", "afn", "reassoc"}


def cache_folder() -> Path:
    """Folder of the compiled code: user cache directory / hash of the package sources."""
    package = Path(__file__).resolve().parents[1]
    digest = hashlib.sha256()
    for source in sorted([*package.glob("*/*.py")]):
        digest.update(source.read_bytes())
    base = os.environ.get("DISMECH_CACHE") or os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    folder = Path(base) / "dismech" / "kernels" / digest.hexdigest()[:16]
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        folder = Path(tempfile.gettempdir()) / f"dismech-kernels-{digest.hexdigest()[:16]}"
        folder.mkdir(parents=True, exist_ok=True)
    return folder


@cache
def _numba() -> Any:
    """Import Numba once, point its cache at our folder and register all kernel text."""
    import numba

    numba.config.CACHE_DIR = str(cache_folder())
    for function in marked_kernels():
        numba.extending.register_jitable(fastmath=_FASTMATH)(function)
    return numba


@cache
def _stencil_loops(kernel_function: Callable[..., Any], shape: tuple[int, int, int, int, int]) -> Any:
    """Compile energy, residual and linearization loops of one kernel.

    Args:
        kernel_function: The kernel.
        shape: Position components, angles, R, auxiliaries, parameters.
    """
    numba = _numba()
    from numba.np.unsafe.ndarray import to_fixed_tuple

    n_vectors, n_angles, n_reduced, n_auxiliary, n_parameters = shape
    jit = numba.njit(cache=True, fastmath=_FASTMATH, error_model="numpy", boundscheck=False)

    @jit
    def gather(s, q, auxiliary, parameters, tails, heads, angles, indices, y, a, p):  # type: ignore[no-untyped-def]
        for k in range(n_vectors):
            y[k] = q[heads[s, k]] - q[tails[s, k]]
        for k in range(n_angles):
            y[n_vectors + k] = q[angles[s, k]]
        for k in range(n_auxiliary):
            a[k] = auxiliary[indices[s, k]]
        for k in range(n_parameters):
            p[k] = parameters[k, s]
        return kernel_function(
            to_fixed_tuple(y, n_reduced), to_fixed_tuple(a, n_auxiliary), to_fixed_tuple(p, n_parameters)
        )

    @jit
    def energies(q, auxiliary, parameters, tails, heads, angles, indices, out):  # type: ignore[no-untyped-def]
        y, a, p = np.empty(n_reduced), np.empty(n_auxiliary), np.empty(n_parameters)
        for s in range(len(out)):
            out[s] = gather(s, q, auxiliary, parameters, tails, heads, angles, indices, y, a, p)[0]

    @jit
    def residual(q, auxiliary, parameters, tails, heads, angles, indices, r):  # type: ignore[no-untyped-def]
        y, a, p = np.empty(n_reduced), np.empty(n_auxiliary), np.empty(n_parameters)
        for s in range(parameters.shape[1]):
            g = gather(s, q, auxiliary, parameters, tails, heads, angles, indices, y, a, p)[1]
            for k in range(n_vectors):
                r[heads[s, k]] += g[k]
                r[tails[s, k]] -= g[k]
            for k in range(n_angles):
                r[angles[s, k]] += g[n_vectors + k]

    @jit
    def linearization(  # type: ignore[no-untyped-def]
        q, auxiliary, parameters, tails, heads, angles, indices, r, values, slots, pairs, packed, factors
    ):
        y, a, p = np.empty(n_reduced), np.empty(n_auxiliary), np.empty(n_parameters)
        block = np.empty(slots.shape[1])
        for s in range(parameters.shape[1]):
            _, g, h = gather(s, q, auxiliary, parameters, tails, heads, angles, indices, y, a, p)
            for k in range(n_vectors):
                r[heads[s, k]] += g[k]
                r[tails[s, k]] -= g[k]
            for k in range(n_angles):
                r[angles[s, k]] += g[n_vectors + k]
            block[:] = 0.0
            for m in range(len(pairs)):
                block[pairs[m]] += factors[m] * h[packed[m]]
            for m in range(len(block)):
                values[slots[s, m]] += block[m]

    return energies, residual, linearization


class NumbaStencilLoop:
    """Serial compiled loop over stencils."""

    def __init__(self, kernel: Kernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> None:
        d = kernel.dimension
        tails = np.array([t * d + i for t, _ in kernel.vectors for i in range(d)])
        heads = np.array([h * d + i for _, h in kernel.vectors for i in range(d)])
        angles = d * kernel.nodes + np.arange(kernel.angles)
        self._indices = tuple(
            np.ascontiguousarray(x, dtype=np.int64)
            for x in (dofs[:, tails], dofs[:, heads], dofs[:, angles], auxiliaries)
        )
        shape = (
            d * len(kernel.vectors),
            kernel.angles,
            kernel.reduced,
            kernel.auxiliaries,
            kernel.parameters,
        )
        self._energies, self._residual, self._linearization = _stencil_loops(kernel.function, shape)
        i, j = kernel.local_pairs
        slots = np.ascontiguousarray(pattern.symmetric_slots(dofs[:, i], dofs[:, j]))
        self._tables = (slots, *(np.ascontiguousarray(x) for x in kernel.hessian_table))

    def energy(self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray) -> FloatArray:
        """Energy of each stencil [J]."""
        out = np.empty(parameters.shape[1])
        self._energies(q, auxiliary, parameters, *self._indices, out)
        return out

    def add_residual(
        self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray, r: FloatArray
    ) -> None:
        """Add dE/dq."""
        self._residual(q, auxiliary, parameters, *self._indices, r)

    def add_linearization(
        self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray, into: Linearization
    ) -> None:
        """Add dE/dq and d2E/dq2."""
        self._linearization(
            q, auxiliary, parameters, *self._indices, into.residual, into.stiffness, *self._tables
        )


@cache
def _drag_loops(kernel_function: Callable[..., Any], shape: tuple[int, int, int]) -> Any:
    """Compile residual and linearization loops of one drag kernel.

    Args:
        kernel_function: The kernel.
        shape: Edge-vector components, force components, parameters.
    """
    numba = _numba()
    from numba.np.unsafe.ndarray import to_fixed_tuple

    n_vectors, n_forces, n_parameters = shape
    jit = numba.njit(cache=True, fastmath=_FASTMATH, error_model="numpy", boundscheck=False)

    @jit
    def gather(s, q, v, parameters, tails, heads, loaded, y, u, p):  # type: ignore[no-untyped-def]
        for k in range(n_vectors):
            y[k] = q[heads[s, k]] - q[tails[s, k]]
        for k in range(n_forces):
            u[k] = v[loaded[s, k]]
        for k in range(n_parameters):
            p[k] = parameters[k, s]
        return kernel_function(
            to_fixed_tuple(y, n_vectors), to_fixed_tuple(u, n_forces), to_fixed_tuple(p, n_parameters)
        )

    @jit
    def residual(q, v, parameters, tails, heads, loaded, r):  # type: ignore[no-untyped-def]
        y, u, p = np.empty(n_vectors), np.empty(n_forces), np.empty(n_parameters)
        for s in range(parameters.shape[1]):
            f = gather(s, q, v, parameters, tails, heads, loaded, y, u, p)[0]
            for k in range(n_forces):
                r[loaded[s, k]] += f[k]

    @jit
    def linearization(  # type: ignore[no-untyped-def]
        q, v, parameters, tails, heads, loaded, r, stiffness, damping, k_slots, k_index, k_sign, c_slots
    ):
        y, u, p = np.empty(n_vectors), np.empty(n_forces), np.empty(n_parameters)
        for s in range(parameters.shape[1]):
            f, dy, du = gather(s, q, v, parameters, tails, heads, loaded, y, u, p)
            for k in range(n_forces):
                r[loaded[s, k]] += f[k]
            for m in range(len(k_index)):
                stiffness[k_slots[s, m]] += k_sign[m] * dy[k_index[m]]
            for m in range(n_forces * n_forces):
                damping[c_slots[s, m]] += du[m]

    return residual, linearization


class NumbaDragLoop:
    """Serial compiled loop over drag stencils."""

    def __init__(self, kernel: DragKernel, dofs: IntArray, pattern: Pattern) -> None:
        d = kernel.dimension
        tails = np.array([t * d + i for t, _ in kernel.vectors for i in range(d)])
        heads = np.array([h * d + i for _, h in kernel.vectors for i in range(d)])
        loaded = dofs[:, kernel.loaded_dofs]
        self._indices = tuple(np.ascontiguousarray(x) for x in (dofs[:, tails], dofs[:, heads], loaded))
        row, column, index, sign = kernel.stiffness_table
        i, j = np.divmod(np.arange(kernel.forces**2), kernel.forces)
        self._tables = tuple(
            np.ascontiguousarray(x)
            for x in (
                pattern.slots_of(dofs[:, row], dofs[:, column]),
                index,
                sign,
                pattern.slots_of(loaded[:, i], loaded[:, j]),
            )
        )
        self._residual, self._linearization = _drag_loops(
            kernel.function, (kernel.reduced, kernel.forces, kernel.parameters)
        )

    def add_residual(self, q: FloatArray, v: FloatArray, parameters: FloatArray, r: FloatArray) -> None:
        """Add -f."""
        self._residual(q, v, parameters, *self._indices, r)

    def add_linearization(
        self, q: FloatArray, v: FloatArray, parameters: FloatArray, into: Linearization
    ) -> None:
        """Add -f, -df/dq and -df/dv."""
        self._linearization(
            q, v, parameters, *self._indices, into.residual, into.stiffness, into.damping, *self._tables
        )


@cache
def _map_loop(function: Callable[..., Any], inputs: int, outputs: int) -> Any:
    numba = _numba()
    from numba.np.unsafe.ndarray import to_fixed_tuple

    @numba.njit(cache=True, fastmath=_FASTMATH, error_model="numpy", boundscheck=False)
    def loop(x, out):  # type: ignore[no-untyped-def]
        column = np.empty(inputs)
        for s in range(x.shape[1]):
            for k in range(inputs):
                column[k] = x[k, s]
            result = function(to_fixed_tuple(column, inputs))
            for k in range(outputs):
                out[k, s] = result[k]

    return loop


@dataclass(frozen=True, slots=True)
class NumbaDriver:
    """Compiled loops; needs the extra ``[fast]``."""

    name: str = "numba"

    def stencil(self, kernel: Kernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> StencilLoop:
        """Loop of an energy kernel."""
        return NumbaStencilLoop(kernel, dofs, auxiliaries, pattern)

    def drag(self, kernel: DragKernel, dofs: IntArray, pattern: Pattern) -> DragLoop:
        """Loop of a drag kernel."""
        return NumbaDragLoop(kernel, dofs, pattern)

    def map(self, function: Callable[[Any], Any], inputs: FloatArray, outputs: int) -> FloatArray:
        """Apply a kernel column by column."""
        out = np.empty((outputs, inputs.shape[1]))
        _map_loop(function, len(inputs), outputs)(inputs, out)
        return out
