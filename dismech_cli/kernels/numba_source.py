"""Source text of compiled loops: one small module per kernel, in straight-line code.

Gathering, the signs of the reduction and the scatter are constants of a kernel. Written out they
compile to register code; a loop over tables would index tuples by a variable, which is a jump
each. As modules on disk the loops can be cached by Numba, which closures cannot.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from .shape import DragKernel, Kernel, LoadKernel

_HEADER = '''"""Loops of {name}; written by dismech, do not edit."""

from numba import njit

from {module} import {name} as kernel

jit = njit(cache=True, fastmath={{"nsz", "arcp", "contract", "afn", "reassoc"}}, error_model="numpy")

'''

_KEPT = "cache=True, "


def not_kept(text: str) -> str:
    """The text of a module whose loops Numba compiles into memory alone."""
    return text.replace(_KEPT, "", 1)


_STENCIL = """
@jit
def energies(q, auxiliary, p, dofs, places, out):
    for s in range(out.shape[1]):
        {energy} = kernel({y}, {a}, {p})[0]


@jit
def residual(q, auxiliary, p, dofs, places, r):
    for s in range(len(dofs)):
        g = kernel({y}, {a}, {p})[1]
        {gradient}


@jit
def linearization(q, auxiliary, p, dofs, places, r, values, slots):
    for s in range(len(dofs)):
        _, g, h = kernel({y}, {a}, {p})
        {gradient}
        {hessian}
"""

_DRAG = """
@jit
def residual(q, v, p, dofs, r):
    for s in range(len(dofs)):
        f = kernel({y}, {u}, {p})[0]
        {force}


@jit
def linearization(q, v, p, dofs, r, stiffness, damping, k_slots, c_slots):
    for s in range(len(dofs)):
        f, k, c = kernel({y}, {u}, {p})
        {force}
        {stiffness}
        {damping}
"""

_LOAD = """
@jit
def residual(q, auxiliary, p, scale, dofs, places, r):
    for s in range(len(dofs)):
        f = kernel({y}, {a}, {p})[0]
        {force}


@jit
def linearization(q, auxiliary, p, scale, dofs, places, r, stiffness, slots):
    for s in range(len(dofs)):
        f, k = kernel({y}, {a}, {p})
        {force}
        {stiffness}
"""

_MAP = """
@jit
def loop(x, out):
    for s in range(x.shape[1]):
        y = kernel({x})
        {out}
"""


def stencil_source(kernel: Kernel) -> str:
    """Module text of an energy kernel: ``energies``, ``residual``, ``linearization``."""
    dof, reduced, sign = kernel.gradient_table
    pair, packed, factor = kernel.hessian_table
    return _header(kernel.function) + _STENCIL.format(
        y=_tuple(_variables(kernel)),
        a=_auxiliaries(kernel),
        p=_parameters(len(kernel.parameters)),
        energy=", ".join(f"out[{k}, s]" for k in range(kernel.energies)),
        gradient=_sums("r[dofs[s, {}]]", "g", dof, reduced, sign),
        hessian=_sums("values[slots[s, {}]]", "h", pair, packed, factor),
    )


def drag_source(kernel: DragKernel) -> str:
    """Module text of a drag kernel: ``residual``, ``linearization``."""
    loaded = kernel.loaded_dofs
    _, _, index, sign = kernel.stiffness_table
    ones = np.ones(kernel.forces**2)
    return _header(kernel.function) + _DRAG.format(
        y=_tuple(_differences(kernel.vectors, kernel.dimension)),
        u=_tuple([f"v[dofs[s, {d}]]" for d in loaded]),
        p=_parameters(len(kernel.parameters)),
        force=_sums("r[dofs[s, {}]]", "f", loaded, np.arange(len(loaded)), np.ones(len(loaded))),
        stiffness=_sums("stiffness[k_slots[s, {}]]", "k", np.arange(len(index)), index, sign),
        damping=_sums("damping[c_slots[s, {}]]", "c", np.arange(len(ones)), np.arange(len(ones)), ones),
    )


def load_source(kernel: LoadKernel) -> str:
    """Module text of a load kernel: ``residual``, ``linearization``."""
    row, column, index, sign = kernel.stiffness_table
    every = np.arange(kernel.dofs)
    ones = np.ones(kernel.dofs)
    return _header(kernel.function) + _LOAD.format(
        y=_tuple(_variables(kernel)),
        a=_auxiliaries(kernel),
        p=_parameters(len(kernel.parameters)),
        force=_sums("r[dofs[s, {}]]", "scale * f", every, every, ones),
        stiffness=_sums("stiffness[slots[s, {}]]", "scale * k", row * kernel.dofs + column, index, sign),
    )


def map_source(function: Callable[..., Any], inputs: int, outputs: int) -> str:
    """Module text of a map kernel: ``loop``."""
    return _header(function) + _MAP.format(
        x=_tuple([f"x[{k}, s]" for k in range(inputs)]),
        out="\n        ".join(f"out[{k}, s] = y[{k}]" for k in range(outputs)),
    )


def _header(function: Callable[..., Any]) -> str:
    return _HEADER.format(name=function.__name__, module=function.__module__)


def _variables(kernel: Kernel | LoadKernel) -> list[str]:
    angles = range(kernel.dimension * kernel.nodes, kernel.dofs)
    return _differences(kernel.vectors, kernel.dimension) + [f"q[dofs[s, {k}]]" for k in angles]


def _auxiliaries(kernel: Kernel | LoadKernel) -> str:
    return _tuple([f"auxiliary[places[s, {k}]]" for k in range(kernel.auxiliaries)])


def _differences(vectors: Sequence[tuple[int, int]], dimension: int) -> list[str]:
    return [
        f"q[dofs[s, {head * dimension + i}]] - q[dofs[s, {tail * dimension + i}]]"
        for tail, head in vectors
        for i in range(dimension)
    ]


def _parameters(count: int) -> str:
    return _tuple([f"p[{k}, s]" for k in range(count)])


def _tuple(entries: Sequence[str]) -> str:
    # an empty tuple has no type to compile: one unused zero stands in
    return f"({', '.join(entries)},)" if entries else "(0.0,)"


def _sums(target: str, source: str, places: Any, indices: Any, factors: Any) -> str:
    """Statements ``target[place] += sum of factor * source[index]``, one per place."""
    terms: dict[int, list[str]] = {}
    for place, index, factor in zip(places.tolist(), indices.tolist(), factors.tolist(), strict=True):
        size = "" if abs(factor) == 1.0 else f"{abs(factor)} * "
        terms.setdefault(place, []).append(f"{'-' if factor < 0.0 else '+'} {size}{source}[{index}]")
    return "\n        ".join(
        f"{target.format(place)} += {' '.join(parts).removeprefix('+ ')}" for place, parts in terms.items()
    )
