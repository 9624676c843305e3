"""Source text of an iteration of Newton's method on a band: all of it that no scene changes.

It is compiled once for bands of one width and kind, and kept for all scenes that have them.
"""

from __future__ import annotations

from functools import cache

from ..kernels.loop_text import LoopText
from .linear import band_loops
from .linear.band_source import general_source, symmetric_source

_ITERATION = '''"""An iteration of Newton's method; written by dismech, do not edit."""

from math import inf, isfinite, sqrt

import numpy as np
from numba import njit

jit = njit(cache=True, fastmath={{"nsz", "arcp", "contract", "afn", "reassoc"}}, error_model="numpy")

{factors}

@jit
def begin(q, numbers, stage, mass, free, diagonal, x, v, r, stiffness, damping):
    """Set out at a trial point: the state of the stage, and the tangent of the inertia."""
    wq, wv, wa = numbers[0], numbers[1], numbers[2]
    q0, v0 = stage[0], stage[1]
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
def gauge(r, split, force, moment):
    """The larger of some squared sizes and those of a residual."""
    one, other = 0.0, 0.0
    for i in range(split):
        one += r[i] * r[i]
    for i in range(split, len(r)):
        other += r[i] * r[i]
    return max(force, one), max(moment, other)


@jit
def small(one, other, force, moment, floor, tolerance, length):
    most = max(moment, force * length)
    return one <= tolerance * force + floor and other <= tolerance * most + floor * length


@jit
def iterate(
    q, numbers, stage, mass, split, free, at_node, diagonal, r, stiffness, damping, work, pivots,
    force, moment, iteration, last, floor, settled,
):
    """Judge a trial point and go on to the next.

    Returns 0 where it is balance, -1 where there is none to be found, else 1; the floor, whether the residual
    was within it, and the largest residual.
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
    force, moment = sqrt(max(force, inertial)), sqrt(max(moment, turning))
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
    floor, one, other = min(floor, rounding * stiffest * far), sqrt(one), sqrt(other)
    if not isfinite(floor + one + other):
        return -1, floor, settled, most
    at_floor = small(one, other, force, moment, floor, tolerance, length)
    met = iteration > 0 and small(one, other, force, moment, 0.0, tolerance, length)
    if one + other == 0.0 or (at_floor and (settled or met)):
        return 0, floor, at_floor, most
    for i in range(m, room):
        x[i] = 0.0
    if last or not factorize(stiffness, factors, pivots, x, m):
        return -1, floor, at_floor, most
    found = substitute(stiffness, factors, pivots, x, rhs, out, m)
    moved = 0.0
    if not found <= 1e-6 * most:
        step = np.empty(m)
        for i in range(m):
            step[i], x[i], rhs[i] = x[i], out[i], out[i]
        factorize(stiffness, factors, pivots, x, m)
        found = substitute(stiffness, factors, pivots, x, rhs, out, m)
        if not found <= 0.1 * most:
            return -1, floor, at_floor, most
        for i in range(m):
            x[i] += step[i]
    for i in range(m):
        q[free[i]] += x[i]
        if at_node[i]:
            moved += x[i] * x[i]
    return (1 if sqrt(moved) <= 1e6 * extent else -1), floor, at_floor, most
'''


@cache
def iteration_text(width: int, *, symmetric: bool) -> LoopText:
    """The module of iterations on bands of one width: ``begin``, ``gauge``, ``iterate``."""
    factors = symmetric_source(width) if symmetric else general_source(width)
    text = _ITERATION.format(factors=factors, width=width)
    kind = f"{'symmetric' if symmetric else 'general'}_{width}"
    return LoopText.of(band_loops.pivoted, kind, text, "iterate")
