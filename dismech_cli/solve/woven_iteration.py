"""Source text of an iteration of Newton's method on a band: all of it that no scene changes.

It is compiled once for bands of one width and kind, and kept for all scenes that have them.
"""

from __future__ import annotations

from functools import cache

from ..kernels.loop_text import LoopText
from .linear import band_loops
from .linear.band_source import general_source, symmetric_source

_ITERATION = '''"""An iteration of Newton's method; written by dismech, do not edit."""

from math import isfinite, sqrt

import numpy as np
from numba import njit

jit = njit(cache=True, fastmath={{"nsz", "arcp", "contract", "afn", "reassoc"}}, error_model="numpy",
           no_cpython_wrapper=True, no_cfunc_wrapper=True)

{factors}

@jit
def begin(q, numbers, stage, mass, free, diagonal, x, v, r, stiffness, damping, memory):
    """Set out at a trial point: the state of the stage, and the tangent of the inertia."""
    wq, wv, wa = numbers[0], numbers[1], numbers[2]
    q0, v0, a0 = stage
    for i in range(len(q)):
        x[i] = wq * q[i] + q0[i]
        v[i] = wv * q[i] + v0[i]
        r[i] = 0.0
    for i in range(len(stiffness)):
        stiffness[i] = 0.0
    for i in range(len(damping)):
        damping[i] = 0.0
    for i in range(len(free)):
        stiffness[diagonal[i]] = wa / wq * mass[free[i]]
    memory[0] = memory[1] = 0.0


@jit
def add(row, r):
    for i in range(len(r)):
        r[i] += row[i]


@jit
def reflect(mirror, stiffness, damping):
    """Fill the lower triangles."""
    lower, upper = mirror
    for i in range(len(lower)):
        stiffness[lower[i]] = stiffness[upper[i]]
    if len(damping):
        for i in range(len(lower)):
            damping[lower[i]] = damping[upper[i]]


@jit
def gauge(r, split, memory):
    """Remember the larger of the squared sizes of a residual: forces, then moments."""
    one, other = 0.0, 0.0
    for i in range(split):
        one += r[i] * r[i]
    for i in range(split, len(r)):
        other += r[i] * r[i]
    memory[0], memory[1] = max(memory[0], one), max(memory[1], other)


@jit
def small(one, other, memory, floor, tolerance, length):
    most = max(memory[1], memory[0] * length)
    return one <= tolerance * memory[0] + floor and other <= tolerance * most + floor * length


@jit
def iterate(
    q, numbers, stage, mass, split, free, at_node, diagonal, r, stiffness, damping, work, pivots, memory, left
):
    """Judge a trial point and go on to the next: 0 where it is balance, -1 where there is none, else 1.

    Args:
        memory: Sizes of forces, see above; the floor, 1 where the last residual was within it, the largest
            residual, and how many points were judged.
        left: How many more factorisations there may be.
    """
    wq, wv, wa, tolerance, length, extent, rounding = numbers
    a0, m = stage[2], len(free)
    entries, room = len(stiffness), m + 2 * {width}
    factors, x = work[:entries], work[entries : entries + room]
    rhs, out = work[entries + room : entries + 2 * room], work[entries + 2 * room : entries + 3 * room]
    if len(damping):
        for i in range(entries):
            stiffness[i] = wq * stiffness[i] + wv * damping[i]
    elif wq != 1.0:
        for i in range(entries):
            stiffness[i] *= wq
    inertial, turning, far = 0.0, 0.0, 0.0
    for i in range(split):
        inertia = mass[i] * (wa * q[i] + a0[i])
        r[i] += inertia
        inertial += inertia * inertia
        far = max(far, abs(q[i]))
    for i in range(split, len(q)):
        inertia = mass[i] * (wa * q[i] + a0[i])
        r[i] += inertia
        turning += inertia * inertia
    memory[0], memory[1] = sqrt(max(memory[0], inertial)), sqrt(max(memory[1], turning))
    stiffest, one, other, most = 0.0, 0.0, 0.0, 0.0
    for i in range(m):
        value = -r[free[i]]
        rhs[i] = x[i] = value
        most = max(most, abs(value))
        if at_node[i]:
            stiffest = max(stiffest, stiffness[diagonal[i]])
            one += value * value
        else:
            other += value * value
    for i in range(m, room):
        x[i] = 0.0
    floor, one, other = min(memory[2], rounding * stiffest * far), sqrt(one), sqrt(other)
    if not isfinite(floor + one + other):
        return -1
    at_floor = small(one, other, memory, floor, tolerance, length)
    met = memory[5] > 0.0 and small(one, other, memory, 0.0, tolerance, length)
    settled = memory[3] > 0.0
    memory[2], memory[3], memory[4] = floor, 1.0 if at_floor else 0.0, most
    memory[5] += 1.0
    if one + other == 0.0 or (at_floor and (settled or met)):
        return 0
    if left == 0 or not factorize(stiffness, factors, pivots, x, m):
        return -1
    found = substitute(stiffness, factors, pivots, x, rhs, out, m)
    if not found <= 1e-6 * most:
        step = np.empty(m)
        for i in range(m):
            step[i], x[i], rhs[i] = x[i], out[i], out[i]
        factorize(stiffness, factors, pivots, x, m)
        found = substitute(stiffness, factors, pivots, x, rhs, out, m)
        if not found <= 0.1 * most:
            return -1
        for i in range(m):
            x[i] += step[i]
    moved = 0.0
    for i in range(m):
        q[free[i]] += x[i]
        if at_node[i]:
            moved += x[i] * x[i]
    return 1 if sqrt(moved) <= 1e6 * extent else -1
'''


@cache
def iteration_text(width: int, *, symmetric: bool) -> LoopText:
    """The module of iterations on bands of one width: ``begin``, ``gauge``, ``iterate``."""
    factors = symmetric_source(width) if symmetric else general_source(width)
    text = _ITERATION.format(factors=factors, width=width)
    kind = f"{'symmetric' if symmetric else 'general'}_{width}"
    return LoopText.of(band_loops.pivoted, kind, text, "iterate")
