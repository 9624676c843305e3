"""Viscous stresses of rate kernels on NumPy batches."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix

from ..arrays import FloatArray, IntArray
from .batches import Batches
from .linearization import Linearization, Pattern
from .shape import RateKernel

# Stencils per call: Hessians of all strains at once fill the second-level cache sooner than energies do.
_CHUNK = 512


class NumpyRateLoop:
    """Gather, evaluate in chunks, scatter by a sparse operator."""

    def __init__(self, kernel: RateKernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> None:
        self._kernel, self._dofs, self._auxiliaries = kernel, dofs, auxiliaries
        # strain by strain
        self._batches = [Batches(_of(kernel, unit)) for unit in np.eye(kernel.strains).tolist()]
        # y = B q of each stencil
        self._reduction = kernel.elastic.reduction
        row, column, index, factor = kernel.tangent_table
        slots = pattern.slots_of(dofs[:, row], dofs[:, column])
        stencils, entries = slots.shape
        # stencil by stencil, each with its R x R values by rows; entries of fixed DOFs are dropped
        columns = np.arange(stencils)[:, None] * kernel.reduced**2 + index
        keep = slots != pattern.slots - 1
        values = np.broadcast_to(factor, (stencils, entries))[keep]
        width = stencils * kernel.reduced**2
        self._to_values = csr_matrix((values, (slots[keep], columns[keep])), shape=(pattern.slots, width))
        self._tangents = np.empty((2, stencils, kernel.reduced, kernel.reduced))
        n, r = kernel.strains, kernel.reduced
        self._viscosity = np.zeros((n, n), dtype=np.int64)
        self._viscosity[np.triu_indices(n)] = np.arange(n * (n + 1) // 2)
        self._viscosity = np.maximum(self._viscosity, self._viscosity.T)
        self._packed = np.zeros((r, r), dtype=np.int64)
        self._packed[np.triu_indices(r)] = np.arange(r * (r + 1) // 2)
        self._packed = np.maximum(self._packed, self._packed.T)

    def add_residual(
        self, q: FloatArray, v: FloatArray, auxiliary: FloatArray, parameters: FloatArray, r: FloatArray
    ) -> None:
        """Add the residual."""
        for chunk in self._chunks():
            b, _, c, w = self._evaluate(q, v, auxiliary, parameters, chunk)
            self._add(chunk, np.einsum("sk,ski->si", _stress(b, c, w), b), r)

    def add_linearization(
        self,
        q: FloatArray,
        v: FloatArray,
        auxiliary: FloatArray,
        parameters: FloatArray,
        into: Linearization,
    ) -> None:
        """Add the residual and both tangents."""
        for chunk in self._chunks():
            b, h, c, w = self._evaluate(q, v, auxiliary, parameters, chunk)
            stress, met = _stress(b, c, w), c @ b
            self._add(chunk, np.einsum("sk,ski->si", stress, b), into.residual)
            # a rate changes with the shape by the curvature of its strain along the velocity
            changed = np.einsum("skij,sj->ski", h, w)
            stiffness, damping = self._tangents[:, chunk]
            np.einsum("sk,skij->sij", stress, h, out=stiffness)
            stiffness += met.transpose(0, 2, 1) @ changed
            np.matmul(met.transpose(0, 2, 1), b, out=damping)
        into.stiffness += self._to_values @ self._tangents[0].reshape(-1)
        into.damping += self._to_values @ self._tangents[1].reshape(-1)

    def _chunks(self) -> list[slice]:
        count = len(self._dofs)
        return [slice(i, min(i + _CHUNK, count)) for i in range(0, count, _CHUNK)]

    def _evaluate(
        self, q: FloatArray, v: FloatArray, auxiliary: FloatArray, parameters: FloatArray, chunk: slice
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Slopes (S, n, R), curvatures (S, n, R, R), viscosities (S, n, n) and velocities (S, R)."""
        dofs, n, r = self._dofs[chunk], self._kernel.strains, self._kernel.reduced
        y, w = q[dofs] @ self._reduction.T, v[dofs] @ self._reduction.T
        a = auxiliary[self._auxiliaries[chunk]]
        y, a, p = np.ascontiguousarray(y.T), np.ascontiguousarray(a.T), parameters[:, chunk]
        b = np.empty((len(dofs), n, r))
        h = np.empty((len(dofs), n, r * (r + 1) // 2))
        c = np.empty((len(dofs), n * (n + 1) // 2))
        for k, batches in enumerate(self._batches):
            batches.evaluate((0, 1, 2), (b[:, k].T, h[:, k].T, c.T), y, a, p)
        return b, h[:, :, self._packed], c[:, self._viscosity], w

    def _add(self, chunk: slice, g: FloatArray, r: FloatArray) -> None:
        local = g @ self._reduction
        r += np.bincount(self._dofs[chunk].reshape(-1), local.reshape(-1), minlength=len(r))


def _of(kernel: RateKernel, unit: list[float]) -> Callable[..., Any]:
    """The kernel for one of its strains."""
    return lambda y, a, p: kernel.function(y, a, p, tuple(unit))


def _stress(b: FloatArray, c: FloatArray, w: FloatArray) -> FloatArray:
    """Stresses (S, n) of strains whose rates are their slopes along the velocity."""
    stress: FloatArray = np.einsum("skl,sl->sk", c, np.einsum("sli,si->sl", b, w))
    return stress
