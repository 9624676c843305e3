"""Tangents of energies made positive semi-definite, stencil by stencil (Teran et al. 2005).

A sum of positive semi-definite blocks is one itself: Newton's step then goes downhill wherever the
energy has a slope, at the price of the quadratic rate where blocks with negative eigenvalues are at
the solution. Energies and gradients are untouched, so what is balance stays balance.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Final

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from .driver import DragLoop, Driver, LoadLoop, LoopT, RateLoop, StencilLoop
from .linearization import Linearization, Pattern
from .loop_text import LoopText
from .numpy_driver import NumpyStencilLoop
from .shape import DragKernel, Kernel, LoadKernel, RateKernel

# Matrices whose eigenvalues are found at a time.
_CHUNK: Final = 2048


def clamped(packed: FloatArray, order: int) -> FloatArray:
    """Symmetric matrices with their negative eigenvalues set to zero.

    Args:
        packed: Upper triangles by rows, shape (R (R + 1)/2, S); columns that are not finite stay.
        order: R.

    Returns:
        The same shape.
    """
    i, j = np.triu_indices(order)
    out = packed.copy()
    finite = np.flatnonzero(np.isfinite(packed).all(axis=0))
    matrices = np.zeros((len(finite), order, order))
    matrices[:, j, i] = packed[:, finite].T  # eigh reads the lower triangle
    values, vectors = np.linalg.eigh(matrices)
    bent = np.flatnonzero(values[:, 0] < 0.0)
    v = vectors[bent]
    fixed = (v * np.maximum(values[bent], 0.0)[:, None, :]) @ v.transpose(0, 2, 1)
    out[:, finite[bent]] = fixed[:, i, j].T
    return out


def _clamp(packed: FloatArray, order: int) -> None:
    """Set negative eigenvalues to zero in place, of some matrices at a time."""
    for start in range(0, packed.shape[1], _CHUNK):
        chunk = packed[:, start : start + _CHUNK]
        chunk[:] = clamped(chunk, order)


@frozen
class ProjectedLoop:
    """Energy and gradient as they are, tangents projected.

    Attributes:
        plain: Loop of the kernel.
        projected: Loop of the kernel with clamped Hessian.
    """

    plain: StencilLoop
    projected: StencilLoop

    def energy(self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray) -> FloatArray:
        """Shares of the energy of each stencil [J]."""
        return self.plain.energy(q, auxiliary, parameters)

    def add_residual(
        self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray, r: FloatArray
    ) -> None:
        """Add dE/dq."""
        self.plain.add_residual(q, auxiliary, parameters, r)

    def add_linearization(
        self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray, into: Linearization
    ) -> None:
        """Add dE/dq and the projected d2E/dq2."""
        self.projected.add_linearization(q, auxiliary, parameters, into)


@frozen
class ProjectedDriver:
    """Another driver's loops, with the tangents of energies projected.

    Eigenvalues cost a hundred times as much as the kernel, so batches serve for these whatever the
    driver is.

    Attributes:
        driver: Runs everything else.
    """

    driver: Driver

    @property
    def name(self) -> str:
        """Name of the driver."""
        return self.driver.name

    def stencil(self, kernel: Kernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> StencilLoop:
        """Loop of an energy kernel."""
        return ProjectedLoop(
            self.driver.stencil(kernel, dofs, auxiliaries, pattern),
            NumpyStencilLoop(kernel, dofs, auxiliaries, pattern, partial(_clamp, order=kernel.reduced)),
        )

    def drag(self, kernel: DragKernel, dofs: IntArray, pattern: Pattern) -> DragLoop:
        """Loop of a drag kernel."""
        return self.driver.drag(kernel, dofs, pattern)

    def load(self, kernel: LoadKernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> LoadLoop:
        """Loop of a load kernel."""
        return self.driver.load(kernel, dofs, auxiliaries, pattern)

    def rate(self, kernel: RateKernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> RateLoop:
        """Loop of a rate kernel."""
        return self.driver.rate(kernel, dofs, auxiliaries, pattern)

    def map(self, function: Callable[[Any], Any], inputs: FloatArray, outputs: int) -> FloatArray:
        """Apply a kernel column by column."""
        return self.driver.map(function, inputs, outputs)

    def compiled(self, loop: LoopT) -> LoopT | None:
        """The driver's loop."""
        return self.driver.compiled(loop)

    def woven(self, text: LoopText, parts: tuple[LoopText, ...]) -> Callable[..., Any] | None:
        """None: Python steps."""
        return None
