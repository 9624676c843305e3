"""Derivative checks: one helper for all terms, by Taylor remainders; complex steps for kernels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.testing import assert_allclose
from order import assert_remainder

from dismech_cli.arrays import FloatArray
from dismech_cli.kernels.driver import Driver
from dismech_cli.kernels.linearization import Linearization, all_symmetric
from dismech_cli.kernels.shape import Kernel
from dismech_cli.model.configuration import Configuration
from dismech_cli.model.model import Model
from dismech_cli.model.stencil import StencilEnergy
from dismech_cli.model.term import BoundTerm, Term
from dismech_cli.solve.pattern import SparsityPattern

_EPS = float(np.finfo(np.float64).eps)
STEPS = 2.0 ** -np.arange(3.0, 11.0)


def dense(pattern: SparsityPattern, values: FloatArray) -> FloatArray:
    """Full matrix over the free DOFs in matrix order."""
    matrix = pattern.csr(values).toarray()
    return matrix + np.triu(matrix, 1).T if pattern.symmetric else matrix


@dataclass(frozen=True, slots=True)
class Probe:
    """A term bound alone to its own pattern, all DOFs free, with results as plain arrays."""

    pattern: SparsityPattern
    bound: BoundTerm

    @classmethod
    def of(cls, term: Term, model: Model, driver: Driver) -> Probe:
        free = np.ones(model.dofs.n, dtype=bool)
        pattern = SparsityPattern.build(
            model.dofs, free, term.couplings, symmetric=all_symmetric(term.couplings)
        )
        return cls(pattern, term.bind(pattern, driver))

    def energy(self, c: Configuration) -> float:
        energy = self.bound.potential
        assert energy is not None
        return float(energy.energy(c).sum())

    def residual(self, c: Configuration) -> FloatArray:
        r = np.zeros(len(c.q))
        self.bound.add_residual(c, r)
        return r

    def tangents(self, c: Configuration) -> tuple[FloatArray, FloatArray]:
        """dr/dq and dr/dv in the numbering of q, shape (n, n)."""
        into = Linearization.of(len(c.q), self.pattern.slots)
        self.bound.add_linearization(c, into)
        assert_allclose(into.residual, self.residual(c), rtol=0, atol=1e-13 * _size(into.residual))
        back = np.ix_(self.pattern.order, self.pattern.order)
        stiffness, damping = (
            dense(self.pattern, into.stiffness)[back],
            dense(self.pattern, into.damping)[back],
        )
        for one in into.rank_ones:
            stiffness += np.outer(one.column, one.by_q)
            damping += np.outer(one.column, one.by_v)
        return stiffness, damping


def _size(x: FloatArray) -> float:
    return float(np.abs(x).max(initial=0.0))


def assert_derivatives(
    term: Term,
    at: Callable[[FloatArray, FloatArray], Configuration],
    q: FloatArray,
    v: FloatArray,
    model: Model,
    *,
    driver: Driver,
    scale: FloatArray,
    seed: int = 0,
) -> None:
    """Check energy, residual, dr/dq and dr/dv of a term against each other at one state.

    Args:
        term: The term.
        at: Configuration of given q and v; its frames are stored at the state under test.
        q: State, shape (n,).
        v: Rates, shape (n,).
        model: Owner of the numbering.
        driver: Runs the kernels.
        scale: Size of a perturbation that changes the state by order one, shape (n,).
        seed: Chooses the directions.
    """
    probe = Probe.of(term, model, driver)
    c = at(q, v)
    residual = probe.residual(c)
    stiffness, damping = probe.tangents(c)
    assert _size(residual) + _size(stiffness) + _size(damping) > 0.0, "nothing to differentiate"
    if term.couplings and all(coupling.symmetric for coupling in term.couplings):
        assert_allclose(stiffness, stiffness.T, rtol=0, atol=1e-13 * _size(stiffness))
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(4, len(q)))
    directions *= scale / np.abs(directions).max(axis=1)[:, None]
    if probe.bound.potential is not None:
        _check_energy(probe, at, q, v, residual, stiffness, directions)
    rates = rng.normal(size=len(v))
    if not _transported(term):
        _check_residual(probe, at, q, v, stiffness, damping, directions[0], np.zeros_like(v))
    _check_residual(probe, at, q, v, stiffness, damping, np.zeros_like(q), rates)


def _transported(term: Term) -> bool:
    """Whether the term reads frames: then r is the gradient only where they are stored."""
    return isinstance(term, StencilEnergy) and term.kernel.auxiliaries > 0


def _check_energy(
    probe: Probe,
    at: Callable[[FloatArray, FloatArray], Configuration],
    q: FloatArray,
    v: FloatArray,
    residual: FloatArray,
    stiffness: FloatArray,
    directions: FloatArray,
) -> None:
    """E(q + hd) = E + h r.d + h^2 d.Kd / 2 + O(h^3): for framed terms, too, where frames are stored.

    The remainders of several directions are summed: in a single one, terms of third and fourth
    order may cancel at some step and spoil the slope.
    """
    energy = probe.energy(at(q, v))

    def remainder(h: float) -> float:
        return sum(
            abs(
                probe.energy(at(q + h * d, v))
                - energy
                - h * (residual @ d)
                - 0.5 * h * h * (d @ stiffness @ d)
            )
            for d in directions
        )

    # Round-off of the energy itself and of positions: |r| times an ulp of q, summed.
    size = abs(energy) + max(abs(probe.energy(at(q + STEPS[0] * d, v))) for d in directions)
    floor = 20.0 * len(directions) * _EPS * (size + float(np.abs(residual) @ np.abs(q)))
    assert_remainder(remainder, STEPS, 3.0, floor)


def _check_residual(
    probe: Probe,
    at: Callable[[FloatArray, FloatArray], Configuration],
    q: FloatArray,
    v: FloatArray,
    stiffness: FloatArray,
    damping: FloatArray,
    d: FloatArray,
    w: FloatArray,
) -> None:
    """r(q + hd, v + hw) = r + h (Kd + Cw) + O(h^2)."""
    residual, slope = probe.residual(at(q, v)), stiffness @ d + damping @ w

    def remainder(h: float) -> float:
        return _size(probe.residual(at(q + h * d, v + h * w)) - residual - h * slope)

    top = _size(probe.residual(at(q + STEPS[0] * d, v + STEPS[0] * w)))
    by_position = float((np.abs(stiffness) @ np.abs(q) + np.abs(damping) @ np.abs(v)).max())
    assert_remainder(remainder, STEPS, 2.0, 20.0 * _EPS * (_size(residual) + top + by_position))


def complex_gradient(kernel: Kernel, y: FloatArray, a: FloatArray, p: FloatArray) -> FloatArray:
    """dE/dy of one stencil by complex steps: exact to round-off, no step to choose."""
    return complex_slopes(lambda z: [np.sum(kernel.function(z, tuple(a), tuple(p))[0])], y)[0]


def complex_hessian(kernel: Kernel, y: FloatArray, a: FloatArray, p: FloatArray) -> FloatArray:
    """Derivative of the kernel's gradient by complex steps, shape (R, R)."""
    return complex_slopes(lambda z: kernel.function(z, tuple(a), tuple(p))[1], y)


def complex_slopes(function: Callable[[tuple[Any, ...]], Any], y: FloatArray) -> FloatArray:
    """Derivative of each result of a function of numbers to each of them, by complex steps."""
    columns = []
    for k in range(len(y)):
        h = 1e-30 * (abs(y[k]) + np.abs(y).max())
        z = y.astype(np.complex128)
        z[k] += 1j * h
        columns.append([value.imag / h for value in function(tuple(z))])
    return np.array(columns).T


def unpacked(hessian: tuple[float, ...], size: int) -> FloatArray:
    """Full matrix of a packed upper triangle."""
    out = np.zeros((size, size))
    out[np.triu_indices(size)] = hessian
    return out + np.triu(out, 1).T
