"""Source text of compiled loops: one small module per kernel, in straight-line code.

Gathering, the signs of the reduction and the scatter are constants of a kernel. Written out they
compile to register code; a loop over tables would index tuples by a variable, which is a jump
each. As modules on disk the loops can be cached by Numba, which closures cannot.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from .shape import DragKernel, Kernel, LoadKernel, RateKernel

_HEADER = '''"""Loops of {name}; written by dismech, do not edit."""

from numba import njit

from {module} import {name} as kernel

jit = njit(cache=True, fastmath={{"nsz", "arcp", "contract", "afn", "reassoc"}}, error_model="numpy")

'''

_KEPT = "cache=True, "


def not_kept(text: str) -> str:
    """The text of a module whose loops Numba compiles into memory alone."""
    return text.replace(_KEPT, "")


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

# Strains are few and their Hessians large: only the kernel is written out, the rest loops over small arrays;
# in straight lines it would take minutes to compile.
_RATE = """
import numpy as np


@jit
def residual(q, v, auxiliary, p, dofs, places, r, tables):
    slope_rows, slope_columns, slope_signs = tables[0], tables[1], tables[2]
    b, c = np.empty(({n}, {size})), np.empty(({n}, {n}))
    w, rate, g = np.empty({size}), np.empty({n}), np.empty({size})
    for s in range(len(dofs)):
        {velocities}
        g[:] = 0.0
        for k in range({n}):
            slopes, _, viscosities = kernel({y}, {a}, {p}, {unit})
            {slopes}
            {viscosities}
            rate[k] = 0.0
            for i in range({size}):
                rate[k] += b[k, i] * w[i]
        for k in range({n}):
            stress = 0.0
            for l in range({n}):
                stress += c[k, l] * rate[l]
            for i in range({size}):
                g[i] += stress * b[k, i]
        for m in range(len(slope_rows)):
            r[dofs[s, slope_rows[m]]] += slope_signs[m] * g[slope_columns[m]]


@jit
def linearization(q, v, auxiliary, p, dofs, places, r, tables, stiffness, damping, slots):
    slope_rows, slope_columns, slope_signs = tables[0], tables[1], tables[2]
    spots, entries, factors = tables[3], tables[4], tables[5]
    b, c, h = np.empty(({n}, {size})), np.empty(({n}, {n})), np.empty(({n}, {size}, {size}))
    w, rate, g = np.empty({size}), np.empty({n}), np.empty({size})
    met, changed, packed = np.empty({size}), np.empty(({n}, {size})), np.empty({half})
    kq, kv = np.empty({size} * {size}), np.empty({size} * {size})
    for s in range(len(dofs)):
        {velocities}
        g[:] = 0.0
        kq[:] = 0.0
        kv[:] = 0.0
        for k in range({n}):
            slopes, curvature, viscosities = kernel({y}, {a}, {p}, {unit})
            {slopes}
            {curvature}
            {viscosities}
            m = 0
            for i in range({size}):
                for j in range(i, {size}):
                    h[k, i, j] = packed[m]
                    h[k, j, i] = packed[m]
                    m += 1
            rate[k] = 0.0
            for i in range({size}):
                rate[k] += b[k, i] * w[i]
                changed[k, i] = 0.0
                for j in range({size}):
                    changed[k, i] += h[k, i, j] * w[j]
        for k in range({n}):
            stress = 0.0
            met[:] = 0.0
            for l in range({n}):
                stress += c[k, l] * rate[l]
                for i in range({size}):
                    met[i] += c[k, l] * b[l, i]
            for i in range({size}):
                g[i] += stress * b[k, i]
                for j in range({size}):
                    kq[i * {size} + j] += stress * h[k, i, j] + met[i] * changed[k, j]
                    kv[i * {size} + j] += met[i] * b[k, j]
        for m in range(len(slope_rows)):
            r[dofs[s, slope_rows[m]]] += slope_signs[m] * g[slope_columns[m]]
        for m in range(len(spots)):
            stiffness[slots[s, spots[m]]] += factors[m] * kq[entries[m]]
            damping[slots[s, spots[m]]] += factors[m] * kv[entries[m]]
"""

_MAP = """
@jit
def loop(x, out):
    for s in range(x.shape[1]):
        y = kernel({x})
        {out}
"""

_CALL = """
from dismech_cli.kernels.placed import placed

loop = jit(placed(kernel, __name__, __file__))
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


def rate_source(kernel: RateKernel) -> str:
    """Module text of a rate kernel: ``residual``, ``linearization``."""
    n, size = kernel.strains, kernel.reduced
    half = size * (size + 1) // 2
    pairs = [(i, j) for i in range(n) for j in range(i, n)]
    return _header(kernel.function) + _RATE.format(
        n=n,
        size=size,
        half=half,
        y=_tuple(_variables(kernel.elastic)),
        a=_auxiliaries(kernel.elastic),
        p=_parameters(len(kernel.parameters)),
        unit=_tuple([f"1.0 if k == {k} else 0.0" for k in range(n)]),
        slopes=_lines([f"b[k, {i}] = slopes[{i}]" for i in range(size)], 12),
        curvature=_lines([f"packed[{m}] = curvature[{m}]" for m in range(half)], 12),
        viscosities=_lines(
            [f"c[{i}, {j}] = c[{j}, {i}] = viscosities[{m}]" for m, (i, j) in enumerate(pairs)], 12
        ),
        velocities=_lines([f"w[{i}] = {x}" for i, x in enumerate(_variables(kernel.elastic, "v"))], 8),
    )


def map_source(function: Callable[..., Any], inputs: int, outputs: int) -> str:
    """Module text of a map kernel: ``loop``."""
    return _header(function) + _MAP.format(
        x=_tuple([f"x[{k}, s]" for k in range(inputs)]),
        out="\n        ".join(f"out[{k}, s] = y[{k}]" for k in range(outputs)),
    )


def call_source(function: Callable[..., Any]) -> str:
    """Module text of a function that has loops of its own: ``loop``."""
    return _header(function) + _CALL


def _header(function: Callable[..., Any]) -> str:
    return _HEADER.format(name=function.__name__, module=function.__module__)


def _variables(kernel: Kernel | LoadKernel, of: str = "q") -> list[str]:
    angles = range(kernel.dimension * kernel.nodes, kernel.dofs)
    return _differences(kernel.vectors, kernel.dimension, of) + [f"{of}[dofs[s, {k}]]" for k in angles]


def _auxiliaries(kernel: Kernel | LoadKernel) -> str:
    return _tuple([f"auxiliary[places[s, {k}]]" for k in range(kernel.auxiliaries)])


def _differences(vectors: Sequence[tuple[int, int]], dimension: int, of: str = "q") -> list[str]:
    return [
        f"{of}[dofs[s, {head * dimension + i}]] - {of}[dofs[s, {tail * dimension + i}]]"
        for tail, head in vectors
        for i in range(dimension)
    ]


def _parameters(count: int) -> str:
    return _tuple([f"p[{k}, s]" for k in range(count)])


def _tuple(entries: Sequence[str]) -> str:
    # an empty tuple has no type to compile: one unused zero stands in
    return f"({', '.join(entries)},)" if entries else "(0.0,)"


def _lines(statements: Sequence[str], indent: int) -> str:
    return f"\n{' ' * indent}".join(statements)


def _sums(target: str, source: str, places: Any, indices: Any, factors: Any) -> str:
    """Statements ``target[place] += sum of factor * source[index]``, one per place."""
    terms: dict[int, list[str]] = {}
    for place, index, factor in zip(places.tolist(), indices.tolist(), factors.tolist(), strict=True):
        size = "" if abs(factor) == 1.0 else f"{abs(factor)} * "
        terms.setdefault(place, []).append(f"{'-' if factor < 0.0 else '+'} {size}{source}[{index}]")
    return "\n        ".join(
        f"{target.format(place)} += {' '.join(parts).removeprefix('+ ')}" for place, parts in terms.items()
    )
