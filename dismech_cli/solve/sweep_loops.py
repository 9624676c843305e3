"""Stages of sweeps of derivatives from the start to the end: what :mod:`.sensitivity` does in batches.

Matrices of C stages are given as (stiffness, damping, mass, diagonal, indptr, indices, order): entries of
dr/dq and dr/dv, shape (C, slots), the latter of shape (C, 0) where nothing depends on velocities; masses
(n,), slots of the diagonal; compressed rows and the DOF of each of them. One triangle is stored where they
are symmetric.

A band is given as (places, room, work, free): the place of each entry in the band of the free DOFs, a spare
one at its end for what is held; room for factors; for right-hand sides; the free DOFs in matrix order.

Edges whose frames are carried are given as (heads, tails, angles), and slopes of their turns to the edge
vectors at both ends of a way as (before, after), each of shape (C, 3, E).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..geometry.kernel import loop
from .sweep_matrix import add_product, fill, solved, total


@loop
def weigh(
    residuals: FloatArray, shares: FloatArray, mass: FloatArray, accelerations: FloatArray, out: FloatArray
) -> None:
    """Write sums of residuals (C, T, n) with shares (T, P), and masses (n, P) times accelerations (C, n)."""
    for s in range(len(out)):
        for i in range(out.shape[1]):
            a = accelerations[s, i]
            for p in range(out.shape[2]):
                out[s, i, p] = mass[i, p] * a
            for t in range(len(shares)):
                r = residuals[s, t, i]
                for p in range(out.shape[2]):
                    out[s, i, p] += r * shares[t, p]


@loop
def combine(maps: FloatArray, start: Any, latest: Any, out: FloatArray, k: int) -> None:
    """Write what row k of maps (5, 6) makes of q, v, a of two states, all contiguous."""
    flat = out.reshape(out.size)
    flat[:] = 0.0
    for j in range(3):
        add_share(maps[k, j], start[j], flat)
        add_share(maps[k, j + 3], latest[j], flat)


@loop
def add_share(share: float, x: FloatArray, out: FloatArray) -> None:
    """Add a share of x, contiguous, to ``out``, flat; most shares are none."""
    if share != 0.0:
        flat = x.reshape(out.size)
        for i in range(out.size):
            out[i] += share * flat[i]


@loop
def go_forward(
    numbers: FloatArray,
    maps: FloatArray,
    start: FloatArray,
    latest: FloatArray,
    given: FloatArray,
    held: IntArray,
    held_q: FloatArray,
    led: IntArray,
    s: int,
    matrices: Any,
    symmetric: bool,
    width: int,
    band: Any,
    edges: Any,
    to_trial: Any,
    to_end: Any,
    turns: FloatArray,
    out: FloatArray,
    out_turns: FloatArray,
) -> bool:
    """Write the derivative after a stage from that before; False where that takes a second thought.

    Args:
        numbers: Of the stage, see :class:`.maps.Maps`, shape (6,).
        maps: Its slopes, shape (5, 6).
        start: Derivative of q, v, a of the start, shape (3, n, P).
        latest: That of the latest stage.
        given: That of the balance at a fixed state, shape (n, P).
        held: Held DOFs, shape (K,).
        held_q: Derivative of where they are, shape (K, P).
        led: Those whose rates are difference quotients.
        s: Number of the stage among all.
        matrices: See the module.
        symmetric: Whether they are one triangle.
        width: Of the band.
        band: See the module.
        edges: See the module.
        to_trial: Turns on the way to the trial point.
        to_end: Turns on the way to the end.
        turns: Derivative of the turns of frames, shape (E, P).
        out: Derivatives at the end, written, shape (3, n, P).
        out_turns: Turns there, written.
    """
    wq, wv, wa, sv, sa, span = numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5]
    stiffness, damping, mass, diagonal, indptr, indices, order = matrices
    heads, tails, angles = edges
    q2, q, v, a = latest[0], out[0], out[1], out[2]
    n, sides = q2.shape
    # first the inertia, then all that is balanced
    b = np.empty((n, sides))
    # the unknown is x + y: y takes the place of q until the end
    combine(maps, start, latest, q, 0)
    combine(maps, start, latest, b, 2)
    combine(maps, start, latest, v, 3)
    combine(maps, start, latest, a, 4)
    before = to_trial[0][s]
    for e in range(len(angles)):
        row = q[angles[e]]
        for p in range(sides):
            row[p] += turns[e, p]
        for k in range(3):
            weight, head, tail = before[k, e], q2[heads[k, e]], q2[tails[k, e]]
            for p in range(sides):
                row[p] += weight * (head[p] - tail[p])
    share = -1.0 / wq
    for i in range(n):
        weight = mass[i]
        for p in range(sides):
            q[i, p] *= share
            b[i, p] = given[i, p] + weight * (b[i, p] + wa * q[i, p])
    if damping.shape[1]:
        speed = np.empty((n, sides))
        combine(maps, start, latest, speed, 1)
        add_share(wv, q, speed.reshape(speed.size))
        add_product(damping[s], indptr, indices, order, symmetric, speed, b)
    values = total(stiffness[s], damping[s], mass, diagonal, order, wq, wv, wa)
    moved = False
    for k in range(len(held)):
        for p in range(sides):
            moved = moved or held_q[k, p] != q[held[k], p]
    if moved:
        x = np.zeros((n, sides))
        for k in range(len(held)):
            for p in range(sides):
                x[held[k], p] = held_q[k, p] - q[held[k], p]
        add_product(values, indptr, indices, order, symmetric, x, b)
    room, work, free = band[1], band[2], band[3]
    fill(values, band, b)
    if not solved(room, symmetric, width, len(free), work):
        return False
    for i in range(len(free)):
        for p in range(sides):
            q[free[i], p] -= work[i, p]
    for k in range(len(held)):
        for p in range(sides):
            q[held[k], p] = held_q[k, p]
    add_share(sv, q, v.reshape(v.size))
    add_share(sa, q, a.reshape(a.size))
    for k in range(len(led)):
        for p in range(sides):
            v[led[k], p] = (q[led[k], p] - q2[led[k], p]) / span
            a[led[k], p] = 0.0
    before, after = to_end[0][s], to_end[1][s]
    for e in range(len(angles)):
        for p in range(sides):
            out_turns[e, p] = turns[e, p]
        for k in range(3):
            first, last, head, tail = before[k, e], after[k, e], heads[k, e], tails[k, e]
            for p in range(sides):
                early, late = q2[head, p] - q2[tail, p], q[head, p] - q[tail, p]
                out_turns[e, p] += first * early + last * late
    return True


@loop
def all_forward(
    first: int,
    reach: int,
    numbers: FloatArray,
    maps: FloatArray,
    states: FloatArray,
    turns: FloatArray,
    given: FloatArray,
    held: IntArray,
    held_q: FloatArray,
    led: IntArray,
    matrices: Any,
    symmetric: bool,
    width: int,
    band: Any,
    edges: Any,
    to_trial: Any,
    to_end: Any,
) -> int:
    """Go forward through stages from a first one until one is reached, or one that takes a second thought.

    Args:
        first: Number of the first.
        reach: Number of that where this ends.
        numbers: Of the S stages of each step, shape (S, 6).
        maps: Likewise, shape (S, 5, 6).
        states: Derivative of q, v, a at the start and after each stage, written, shape (C + 1, 3, n, P).
        turns: Likewise of the turns of frames, shape (C + 1, E, P).
        given: That of balances at fixed states, shape (C, n, P).
        held: See :func:`go_forward`; all further ones too.
        held_q: The same for all stages.
        led: See ``held``.
        matrices: See the module.
        symmetric: See ``held``.
        width: See ``held``.
        band: See the module.
        edges: See the module.
        to_trial: See ``held``.
        to_end: See ``held``.

    Returns:
        Number of the stage that this came to.
    """
    for s in range(first, reach):
        k = s % len(numbers)
        if not go_forward(
            numbers[k], maps[k], states[s - k], states[s], given[s], held, held_q, led, s, matrices,
            symmetric, width, band, edges, to_trial, to_end, turns[s], states[s + 1], turns[s + 1],
        ):  # fmt: skip
            return s
    return reach
