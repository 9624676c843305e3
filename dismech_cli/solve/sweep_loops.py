"""Stages of sweeps of derivatives: what :mod:`.sensitivity` and :mod:`.adjoint` do in batches.

A matrix is given as (stiffness, damping, mass, diagonal, indptr, indices, order): entries of dr/dq and dr/dv,
the latter of length 0 where nothing depends on velocities; masses (n,), slots of the diagonal; compressed
rows and the DOF of each of them. One triangle is stored where it is symmetric.

A band is given as (places, room, work, free): the place of each entry in the band of the free DOFs, a spare
one at its end for what is held; room for factors; for right-hand sides; the free DOFs in matrix order.

Edges whose frames are carried are given as (heads, tails, angles), and slopes of their turns to the edge
vectors at both ends of a way as (before, after), each of shape (3, E).
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
    residuals: FloatArray, shares: FloatArray, mass: FloatArray, a: FloatArray, out: FloatArray
) -> None:
    """Write sums of residuals (T, n) with shares (T, P), and masses (n, P) times accelerations (n,)."""
    for i in range(len(a)):
        for p in range(shares.shape[1]):
            found = mass[i, p] * a[i]
            for t in range(len(shares)):
                found += residuals[t, i] * shares[t, p]
            out[i, p] = found


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
    weights: Any,
    maps: FloatArray,
    start: Any,
    latest: Any,
    given: FloatArray,
    held: IntArray,
    held_q: FloatArray,
    led: IntArray,
    matrix: Any,
    symmetric: bool,
    width: int,
    band: Any,
    edges: Any,
    to_trial: Any,
    to_end: Any,
    turns: FloatArray,
    out: Any,
    out_turns: FloatArray,
) -> bool:
    """Write the derivative after a stage from that before; False where that takes a second thought.

    Args:
        weights: Of positions, velocities and accelerations in the balance; slopes of velocity and
            acceleration at the end; duration of the difference quotients [s].
        maps: Slopes of (q0, v0, a0, v_end, a_end) to q, v, a of the start and of the latest stage, (5, 6).
        start: Derivative of q, v, a of the start, each of shape (n, P).
        latest: That of the latest stage.
        given: That of the balance at a fixed state; used up.
        held: Held DOFs, shape (K,).
        held_q: Derivative of where they are, shape (K, P).
        led: Those whose rates are difference quotients.
        matrix: See the module.
        symmetric: Whether that is one triangle.
        width: Of the band.
        band: See the module.
        edges: See the module.
        to_trial: Turns on the way to the trial point.
        to_end: Turns on the way to the end.
        turns: Derivative of the turns of frames, shape (E, P).
        out: Derivatives at the end, written.
        out_turns: Turns there, written.
    """
    wq, wv, wa, sv, sa, span = weights
    stiffness, damping, mass, diagonal, indptr, indices, order = matrix
    heads, tails, angles = edges
    q2 = latest[0]
    q, v, a = out
    n, sides = q2.shape
    inertia = np.empty((n, sides))
    # the unknown is x + y: y takes the place of q until the end
    combine(maps, start, latest, q, 0)
    combine(maps, start, latest, inertia, 2)
    combine(maps, start, latest, v, 3)
    combine(maps, start, latest, a, 4)
    before = to_trial[0]
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
            given[i, p] += weight * (inertia[i, p] + wa * q[i, p])
    if len(damping):
        speed = inertia
        combine(maps, start, latest, speed, 1)
        add_share(wv, q, speed.reshape(speed.size))
        add_product(damping, indptr, indices, order, symmetric, speed, given)
    values = total(stiffness, damping, mass, diagonal, order, wq, wv, wa)
    moved = False
    for k in range(len(held)):
        for p in range(sides):
            moved = moved or held_q[k, p] != q[held[k], p]
    if moved:
        x = np.zeros((n, sides))
        for k in range(len(held)):
            for p in range(sides):
                x[held[k], p] = held_q[k, p] - q[held[k], p]
        add_product(values, indptr, indices, order, symmetric, x, given)
    room, work, free = band[1], band[2], band[3]
    fill(values, band, given)
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
    before, after = to_end
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
def go_back(
    weights: Any,
    maps: FloatArray,
    owed: Any,
    turns: FloatArray,
    start: Any,
    held: IntArray,
    led: IntArray,
    matrix: Any,
    symmetric: bool,
    width: int,
    band: Any,
    edges: Any,
    to_trial: Any,
    to_end: Any,
    given: FloatArray,
    gradient: FloatArray,
    out: Any,
    out_turns: FloatArray,
    by_held: FloatArray,
) -> bool:
    """Write what is owed to the state before a stage; False, with nothing done, where that takes thought.

    Args:
        weights: As of :func:`go_forward`.
        maps: Likewise.
        owed: Derivative of the number to q, v, a at the end, each of shape (n, 1).
        turns: To the turns of frames, shape (E,).
        start: What is owed to q, v, a of the start; added to.
        held: Held DOFs, shape (K,).
        led: Those whose rates are difference quotients.
        matrix: See the module.
        symmetric: Whether that is one triangle.
        width: Of the band.
        band: That of the transpose.
        edges: See the module.
        to_trial: Turns on the way to the trial point.
        to_end: Turns on the way to the end.
        given: Derivative of the balance at a fixed state to all parameters, shape (n, P).
        gradient: That of the number, shape (P,); added to.
        out: Derivative to q, v, a before the stage, written.
        out_turns: To the turns there, written.
        by_held: To where held DOFs are, shape (K,), written.
    """
    wq, wv, wa, sv, sa, span = weights
    stiffness, damping, mass, diagonal, indptr, indices, order = matrix
    heads, tails, angles = edges
    n = len(mass)
    v, a = owed[1].copy(), owed[2].copy()
    before, to_q = np.zeros((n, 1)), np.zeros((n, 1))
    for k in range(len(led)):
        before[led[k], 0] = -v[led[k], 0] / span
        v[led[k], 0] = a[led[k], 0] = 0.0
    for i in range(n):
        to_q[i, 0] = owed[0][i, 0] + sv * v[i, 0] + sa * a[i, 0] - before[i, 0]
    for e in range(len(angles)):
        for k in range(3):
            late, early = to_end[1][k, e] * turns[e], to_end[0][k, e] * turns[e]
            to_q[heads[k, e], 0] += late
            to_q[tails[k, e], 0] -= late
            before[heads[k, e], 0] += early
            before[tails[k, e], 0] -= early
    values, mu = total(stiffness, damping, mass, diagonal, order, wq, wv, wa), np.zeros((n, 1))
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
    if len(damping):
        add_transposed(damping, indptr, indices, order, symmetric, mu, by_v)
    by_q = by_all
    for i in range(n):
        by_q[i, 0] = (by_q[i, 0] - wa * mass[i] * mu[i, 0] - wv * by_v[i, 0]) / wq
        for p in range(len(gradient)):
            gradient[p] -= mu[i, 0] * given[i, p]
    for e in range(len(angles)):
        turn = by_q[angles[e], 0]
        out_turns[e] = turns[e] - turn
        for k in range(3):
            before[heads[k, e], 0] -= to_trial[0][k, e] * turn
            before[tails[k, e], 0] += to_trial[0][k, e] * turn
    for i in range(n):
        by = (-by_q[i, 0], -by_v[i, 0], -mass[i] * mu[i, 0], v[i, 0], a[i, 0])
        start[0][i, 0] += _owing(maps, 0, by)
        start[1][i, 0] += _owing(maps, 1, by)
        start[2][i, 0] += _owing(maps, 2, by)
        out[0][i, 0] = before[i, 0] + _owing(maps, 3, by)
        out[1][i, 0] = _owing(maps, 4, by)
        out[2][i, 0] = _owing(maps, 5, by)
    return True
