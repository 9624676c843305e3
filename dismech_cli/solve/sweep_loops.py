"""Stages of sweeps of derivatives: what :mod:`.sensitivity` and :mod:`.adjoint` do in batches.

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
from ..geometry.kernel import kernel, loop
from .linear.factors import RESIDUAL_GOAL
from .sweep_matrix import add_product, add_transposed, fill, in_place, solved, total

# Loops want plain numbers.
_GOAL = RESIDUAL_GOAL


@kernel
def _owing(maps: FloatArray, j: Any, x: Any) -> Any:
    """Column j of maps (5, 6) of five numbers."""
    first = maps[0, j] * x[0] + maps[1, j] * x[1] + maps[2, j] * x[2]
    return first + maps[3, j] * x[3] + maps[4, j] * x[4]


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


@loop
def go_back(
    numbers: FloatArray,
    maps: FloatArray,
    owed: FloatArray,
    turns: FloatArray,
    start: FloatArray,
    held: IntArray,
    led: IntArray,
    s: int,
    matrices: Any,
    symmetric: bool,
    width: int,
    band: Any,
    edges: Any,
    to_trial: Any,
    to_end: Any,
    given: FloatArray,
    gradient: FloatArray,
    by_held: FloatArray,
) -> bool:
    """What is owed after a stage becomes what is before; False, with nothing done, where that takes thought.

    Args:
        numbers: As of :func:`go_forward`.
        maps: Likewise.
        owed: Derivative of the number to q, v, a, shape (3, n, 1); changed.
        turns: To the turns of frames, shape (E,); changed.
        start: What is owed to q, v, a of the start; added to.
        held: Held DOFs, shape (K,).
        led: Those whose rates are difference quotients.
        s: Number of the stage among all.
        matrices: See the module.
        symmetric: Whether they are one triangle.
        width: Of the band.
        band: That of the transpose.
        edges: See the module.
        to_trial: Turns on the way to the trial point.
        to_end: Turns on the way to the end.
        given: Derivative of the balance at a fixed state to all parameters, shape (n, P).
        gradient: That of the number, shape (P,); added to.
        by_held: To where held DOFs are, shape (K,), written.
    """
    wq, wv, wa, sv, sa, span = numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5]
    stiffness, damping, mass, diagonal, indptr, indices, order = matrices
    heads, tails, angles = edges
    n = len(mass)
    v, a = owed[1].copy(), owed[2].copy()
    before, to_q = np.zeros((n, 1)), np.zeros((n, 1))
    for k in range(len(led)):
        before[led[k], 0] = -v[led[k], 0] / span
        v[led[k], 0] = a[led[k], 0] = 0.0
    for i in range(n):
        to_q[i, 0] = owed[0][i, 0] + sv * v[i, 0] + sa * a[i, 0] - before[i, 0]
    early_turns, late_turns = to_end[0][s], to_end[1][s]
    for e in range(len(angles)):
        for k in range(3):
            late, early = late_turns[k, e] * turns[e], early_turns[k, e] * turns[e]
            to_q[heads[k, e], 0] += late
            to_q[tails[k, e], 0] -= late
            before[heads[k, e], 0] += early
            before[tails[k, e], 0] -= early
    values, mu = total(stiffness[s], damping[s], mass, diagonal, order, wq, wv, wa), np.zeros((n, 1))
    room, work, free = band[1], band[2], band[3]
    fill(values, band, to_q)
    if not in_place(room, symmetric, width, len(free), work):
        return False
    for i in range(len(free)):
        mu[free[i], 0] = work[i, 0]
    by_all, by_v = np.zeros((n, 1)), np.zeros((n, 1))
    add_transposed(values, indptr, indices, order, symmetric, mu, by_all)
    largest = 0.0
    for i in range(len(free)):
        largest = max(largest, abs(to_q[free[i], 0]))
    for i in range(len(free)):
        if not abs(by_all[free[i], 0] - to_q[free[i], 0]) <= _GOAL * largest:
            return False
        by_all[free[i], 0] = to_q[free[i], 0]
    for k in range(len(held)):
        by_held[k] = to_q[held[k], 0] - by_all[held[k], 0]
    if damping.shape[1]:
        add_transposed(damping[s], indptr, indices, order, symmetric, mu, by_v)
    by_q = by_all
    for i in range(n):
        by_q[i, 0] = (by_q[i, 0] - wa * mass[i] * mu[i, 0] - wv * by_v[i, 0]) / wq
        for p in range(len(gradient)):
            gradient[p] -= mu[i, 0] * given[i, p]
    early_turns = to_trial[0][s]
    for e in range(len(angles)):
        turn = by_q[angles[e], 0]
        turns[e] -= turn
        for k in range(3):
            before[heads[k, e], 0] -= early_turns[k, e] * turn
            before[tails[k, e], 0] += early_turns[k, e] * turn
    for i in range(n):
        by = (-by_q[i, 0], -by_v[i, 0], -mass[i] * mu[i, 0], v[i, 0], a[i, 0])
        start[0][i, 0] += _owing(maps, 0, by)
        start[1][i, 0] += _owing(maps, 1, by)
        start[2][i, 0] += _owing(maps, 2, by)
        owed[0][i, 0] = before[i, 0] + _owing(maps, 3, by)
        owed[1][i, 0] = _owing(maps, 4, by)
        owed[2][i, 0] = _owing(maps, 5, by)
    return True


@loop
def all_back(
    first: int,
    numbers: FloatArray,
    maps: FloatArray,
    owed: FloatArray,
    turns: FloatArray,
    start: FloatArray,
    held: IntArray,
    led: IntArray,
    matrices: Any,
    symmetric: bool,
    width: int,
    band: Any,
    edges: Any,
    to_trial: Any,
    to_end: Any,
    given: FloatArray,
    gradient: FloatArray,
    by_held: FloatArray,
) -> int:
    """Go back through the stages of steps, down to one that takes a second thought.

    Args:
        first: Number of stages that are left to go through.
        numbers: Of the S stages of each step, shape (S, 6).
        maps: Likewise, shape (S, 5, 6).
        owed: See :func:`go_back`; so are those that follow.
        turns: See ``owed``.
        start: What is owed to the start of the step that a stage is of: nothing before its last stage.
        held: See ``owed``.
        led: See ``owed``.
        matrices: See the module.
        symmetric: See ``owed``.
        width: See ``owed``.
        band: See ``owed``.
        edges: See the module.
        to_trial: See ``owed``.
        to_end: See ``owed``.
        given: Derivatives of balances at fixed states to all parameters, shape (C, n, P).
        gradient: See ``owed``.
        by_held: To where held DOFs are at the end of each stage, shape (C, K), written.

    Returns:
        Number of stages that are still left.
    """
    for s in range(first - 1, -1, -1):
        k = s % len(numbers)
        if not go_back(
            numbers[k], maps[k], owed, turns, start, held, led, s, matrices,
            symmetric, width, band, edges, to_trial, to_end, given[s], gradient, by_held[s],
        ):  # fmt: skip
            return s + 1
        if k == 0:
            begin(owed, start)
    return 0


@loop
def begin(owed: FloatArray, start: FloatArray) -> None:
    """Where a step begins, what is owed to its start is owed to the state there."""
    for k in range(3):
        for i in range(owed.shape[1]):
            owed[k, i, 0] += start[k, i, 0]
            start[k, i, 0] = 0.0
