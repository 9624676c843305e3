"""Source text that goes from stage to stage of compiled steps; kept for all scenes.

The maps of a stage are numbers times what its step starts from and what the stage before ended at: so one
loop serves all integrators.
"""

from __future__ import annotations

from functools import cache

from ..kernels.loop_text import LoopText
from .linear import band_loops

_STAGES = '''"""Stages of steps; written by dismech, do not edit."""

from numba import njit

jit = njit(cache=True, fastmath={"nsz", "arcp", "contract", "afn", "reassoc"}, error_model="numpy",
           no_cpython_wrapper=True, no_cfunc_wrapper=True)


@jit
def set_out(maps, q, v, a, first, here, share, vectors):
    """The vectors of a stage, and its first guess: see :mod:`.stage_maps`.

    Args:
        maps: Shape (7, 6).
        q: Positions by row; likewise ``v`` and ``a``.
        first: Row of the start of the step.
        here: Row of the end of the stage before.
        share: Of the lead in the guess.
        vectors: Predictor, lead, q0, v0, a0, constants of v and a at the end, unknown; shape (8, n).
    """
    for k in range(7):
        m0, m1, m2, m3, m4, m5 = maps[k, 0], maps[k, 1], maps[k, 2], maps[k, 3], maps[k, 4], maps[k, 5]
        for i in range(q.shape[1]):
            one = m0 * q[first, i] + m1 * v[first, i] + m2 * a[first, i]
            vectors[k, i] = one + m3 * q[here, i] + m4 * v[here, i] + m5 * a[here, i]
    for i in range(q.shape[1]):
        vectors[7, i] = vectors[0, i] + share * vectors[1, i]


@jit
def prescribe(vectors, held, values):
    for i in range(len(held)):
        vectors[7, held[i]] = values[i]


@jit
def arrive(numbers, vectors, led, q, v, a, here):
    """The end of a stage: what is led has the difference quotient of its path, and no acceleration."""
    v_slope, a_slope, duration = numbers[3], numbers[4], numbers[5]
    for i in range(q.shape[1]):
        x = vectors[7, i]
        q[here + 1, i] = x
        v[here + 1, i] = v_slope * x + vectors[5, i]
        a[here + 1, i] = a_slope * x + vectors[6, i]
    for k in range(len(led)):
        i = led[k]
        v[here + 1, i] = (q[here + 1, i] - q[here, i]) / duration
        a[here + 1, i] = 0.0


@jit
def learnt(mass, vectors):
    """Which share of the lead would have made the guess best: see :mod:`.predictor`."""
    size, along = 0.0, 0.0
    for i in range(len(mass)):
        weighted = mass[i] * vectors[1, i]
        size += weighted * vectors[1, i]
        along += weighted * (vectors[7, i] - vectors[0, i])
    return min(max(along / size, 0.0), 1.0) if size > 0.0 else 0.0


@jit
def react(r, slope, mass, vectors, held, v, first, last, dt, reactions):
    """What holds a mass also moves it, along its path: the forces of terms on it, and with its inertia."""
    for k in range(len(held)):
        i = held[k]
        inertia = mass[i] * (slope * vectors[7, i] + vectors[4, i])
        reactions[k] = r[i] - inertia
        r[i] += mass[i] * ((v[last, i] - v[first, i]) / dt) - inertia
'''


@cache
def stages_text() -> LoopText:
    """The module: ``set_out``, ``prescribe``, ``arrive``, ``learnt`` and ``react``."""
    return LoopText.of(band_loops.pivoted, "stages", _STAGES, "set_out")
