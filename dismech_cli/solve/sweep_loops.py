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
from .linear.sided_loops import general_factors, solve_sides, symmetric_factors

# Loops want plain numbers.
_GOAL, _GOLDEN = RESIDUAL_GOAL, 0.6180339887498949


@kernel
def _owing(maps: FloatArray, j: Any, x: Any) -> Any:
    """Column j of maps (5, 6) of five numbers."""
    first = maps[0, j] * x[0] + maps[1, j] * x[1] + maps[2, j] * x[2]
    return first + maps[3, j] * x[3] + maps[4, j] * x[4]


@loop
def turn_slopes(
    q0: FloatArray,
    q1: FloatArray,
    heads: IntArray,
    tails: IntArray,
    before: FloatArray,
    after: FloatArray,
    edge: FloatArray,
    length: FloatArray,
) -> None:
    """Write how frames turn on their way from shapes (n,) to others; see :mod:`..kinematics.turning`."""
    for e in range(len(length)):
        x0, x1 = q0[heads[0, e]] - q0[tails[0, e]], q1[heads[0, e]] - q1[tails[0, e]]
        y0, y1 = q0[heads[1, e]] - q0[tails[1, e]], q1[heads[1, e]] - q1[tails[1, e]]
        z0, z1 = q0[heads[2, e]] - q0[tails[2, e]], q1[heads[2, e]] - q1[tails[2, e]]
        l0 = np.sqrt(x0 * x0 + y0 * y0 + z0 * z0)
        l1 = np.sqrt(x1 * x1 + y1 * y1 + z1 * z1)
        scale = -1.0 / (l0 * l1 + x0 * x1 + y0 * y1 + z0 * z1)
        a, b, c = scale * (y0 * z1 - z0 * y1), scale * (z0 * x1 - x0 * z1), scale * (x0 * y1 - y0 * x1)
        before[0, e], before[1, e], before[2, e] = a / l0, b / l0, c / l0
        after[0, e], after[1, e], after[2, e] = a / l1, b / l1, c / l1
        edge[0, e], edge[1, e], edge[2, e] = x1, y1, z1
        length[e] = l1


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
    a, b, c, d, e, f = maps[k, 0], maps[k, 1], maps[k, 2], maps[k, 3], maps[k, 4], maps[k, 5]
    size = out.size
    q1, v1, a1 = start[0].reshape(size), start[1].reshape(size), start[2].reshape(size)
    q2, v2, a2 = latest[0].reshape(size), latest[1].reshape(size), latest[2].reshape(size)
    flat = out.reshape(size)
    for i in range(size):
        flat[i] = a * q1[i] + b * v1[i] + c * a1[i] + d * q2[i] + e * v2[i] + f * a2[i]


@loop
def add_product(
    values: FloatArray,
    indptr: IntArray,
    indices: IntArray,
    order: IntArray,
    symmetric: bool,
    x: FloatArray,
    out: FloatArray,
) -> None:
    """Add A x, shape (n, P), to ``out``."""
    sides = x.shape[1]
    for i in range(len(order)):
        row = order[i]
        for s in range(indptr[i], indptr[i + 1]):
            column, value = order[indices[s]], values[s]
            for p in range(sides):
                out[row, p] += value * x[column, p]
            if symmetric and column != row:
                for p in range(sides):
                    out[column, p] += value * x[row, p]


@loop
def add_transposed(
    values: FloatArray,
    indptr: IntArray,
    indices: IntArray,
    order: IntArray,
    symmetric: bool,
    x: FloatArray,
    out: FloatArray,
) -> None:
    """Add A^T x, shape (n, P), to ``out``."""
    if symmetric:
        add_product(values, indptr, indices, order, symmetric, x, out)
        return
    for i in range(len(order)):
        for s in range(indptr[i], indptr[i + 1]):
            for p in range(x.shape[1]):
                out[order[indices[s]], p] += values[s] * x[order[i], p]


@loop
def total(
    stiffness: FloatArray,
    damping: FloatArray,
    mass: FloatArray,
    diagonal: IntArray,
    order: IntArray,
    wq: float,
    wv: float,
    wa: float,
) -> FloatArray:
    """Entries of J = q K + v C + a M."""
    values = np.empty(len(stiffness))
    for s in range(len(stiffness)):
        values[s] = wq * stiffness[s]
    for s in range(len(damping)):
        values[s] += wv * damping[s]
    for i in range(len(order)):
        values[diagonal[i]] += wa * mass[order[i]]
    return values


@loop
def solved(values: FloatArray, symmetric: bool, width: int, band: Any, b: FloatArray, x: FloatArray) -> bool:
    """Write x of A x = b on the free DOFs, shape (n, P); False where that takes a second thought."""
    places, room, work, free = band
    m, sides = len(free), b.shape[1]
    for i in range(len(room)):
        room[i] = 0.0
    for s in range(len(places)):
        room[places[s]] = values[s]
    for i in range(len(work)):
        for p in range(work.shape[1]):
            work[i, p] = 0.0
    for i in range(m):
        for p in range(sides):
            work[i, p] = b[free[i], p]
    if symmetric:
        if not symmetric_factors(room, width, m):
            return False
        solve_sides(room, width, m, 0, width + 1, 1, True, work)
    else:
        if not general_factors(room, width, m):
            return False
        solve_sides(room, width, m, width, 2 * width + 1, 2 * width, False, work)
    for i in range(m):
        for p in range(sides):
            x[free[i], p] = work[i, p]
    return True


@loop
def sound(
    values: FloatArray,
    indptr: IntArray,
    indices: IntArray,
    order: IntArray,
    symmetric: bool,
    free: IntArray,
    x: FloatArray,
    b: FloatArray,
) -> bool:
    """Whether solutions (n, P) are good: a bad one of any column shows in a sum of all."""
    n, sides = x.shape
    mixed, left = np.zeros((n, 1)), np.zeros((n, 1))
    for p in range(sides):
        largest = 0.0
        for i in range(len(free)):
            largest = max(largest, abs(b[free[i], p]))
        share = (0.5 + ((p + 1) * _GOLDEN) % 1.0) / (largest if largest > 0.0 else 1.0)
        for i in range(len(free)):
            mixed[free[i], 0] += share * x[free[i], p]
            left[free[i], 0] -= share * b[free[i], p]
    add_product(values, indptr, indices, order, symmetric, mixed, left)
    good = True
    for i in range(len(free)):
        good = good and abs(left[free[i], 0]) <= _GOAL
    return good


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
    speed, inertia = np.empty((n, sides)), np.empty((n, sides))
    # the unknown is x + y: y takes the place of q until the end
    combine(maps, start, latest, q, 0)
    combine(maps, start, latest, speed, 1)
    combine(maps, start, latest, inertia, 2)
    combine(maps, start, latest, v, 3)
    combine(maps, start, latest, a, 4)
    before = to_trial[0]
    for e in range(len(angles)):
        for p in range(sides):
            q[angles[e], p] += turns[e, p]
            for k in range(3):
                q[angles[e], p] += before[k, e] * (q2[heads[k, e], p] - q2[tails[k, e], p])
    for i in range(n):
        for p in range(sides):
            q[i, p] /= -wq
            given[i, p] += mass[i] * (inertia[i, p] + wa * q[i, p])
            speed[i, p] += wv * q[i, p]
    if len(damping):
        add_product(damping, indptr, indices, order, symmetric, speed, given)
    values = total(stiffness, damping, mass, diagonal, order, wq, wv, wa)
    x = np.zeros((n, sides))
    moved = False
    for k in range(len(held)):
        for p in range(sides):
            x[held[k], p] = held_q[k, p] - q[held[k], p]
            moved = moved or x[held[k], p] != 0.0
    if moved:
        add_product(values, indptr, indices, order, symmetric, x, given)
    if not solved(values, symmetric, width, band, given, x):
        return False
    if not sound(values, indptr, indices, order, symmetric, band[3], x, given):
        return False
    for i in range(len(band[3])):
        for p in range(sides):
            x[band[3][i], p] = -x[band[3][i], p]
    for i in range(n):
        for p in range(sides):
            q[i, p] += x[i, p]
            v[i, p] += sv * q[i, p]
            a[i, p] += sa * q[i, p]
    for k in range(len(led)):
        for p in range(sides):
            v[led[k], p] = (q[led[k], p] - q2[led[k], p]) / span
            a[led[k], p] = 0.0
    before, after = to_end
    for e in range(len(angles)):
        for p in range(sides):
            turn = turns[e, p]
            for k in range(3):
                turn += before[k, e] * (q2[heads[k, e], p] - q2[tails[k, e], p])
                turn += after[k, e] * (q[heads[k, e], p] - q[tails[k, e], p])
            out_turns[e, p] = turn
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
    if not solved(values, symmetric, width, band, to_q, mu):
        return False
    by_all, by_v = np.zeros((n, 1)), np.zeros((n, 1))
    add_transposed(values, indptr, indices, order, symmetric, mu, by_all)
    free, largest = band[3], 0.0
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


@loop
def mend(
    stiffness: FloatArray,
    damping: FloatArray,
    residuals: FloatArray,
    turning: IntArray,
    edges: Any,
    v: FloatArray,
    way: Any,
    by_angle: IntArray,
    edge_of: IntArray,
    sums: Any,
) -> None:
    """Add what kernels leave out at edges whose frames are carried; see :mod:`.carried`.

    Args:
        stiffness: Entries of dr/dq, mended.
        damping: Those of dr/dv; of length 0 for none.
        residuals: Of each term, shape (T, n).
        turning: Terms whose moments about edges count, shape (K,).
        edges: See the module.
        v: Velocities at the trial point, shape (n,).
        way: Slopes after the way there (3, E), edge vectors (3, E) and their lengths (E,).
        by_angle: Entries in columns of angles, shape (M,).
        edge_of: Edge of each, shape (M,).
        sums: Slots that get anything; where the sums of each begin, their signs and what they are of: turned
            entries (3, M), then halves of moments along edges (3, E).
    """
    heads, tails, angles = edges
    after, edge, length = way
    slots, begin, signs, sources = sums
    many, count = len(by_angle), len(angles)
    parts, turns = np.empty(3 * (many + count)), np.zeros((3, count))
    for e in range(count):
        half, moment = 0.5 / length[e] ** 3, 0.0
        for k in range(len(turning)):
            moment += residuals[turning[k], angles[e]]
        for k in range(3):
            parts[3 * many + k * count + e] = half * moment * edge[k, e]
        if len(damping):
            x = v[heads[0, e]] - v[tails[0, e]]
            y = v[heads[1, e]] - v[tails[1, e]]
            z = v[heads[2, e]] - v[tails[2, e]]
            turns[0, e] = half * (y * edge[2, e] - z * edge[1, e])
            turns[1, e] = half * (z * edge[0, e] - x * edge[2, e])
            turns[2, e] = half * (x * edge[1, e] - y * edge[0, e])
    for s in range(many):
        e, slot = edge_of[s], by_angle[s]
        for k in range(3):
            turned = stiffness[slot] * after[k, e]
            if len(damping):
                turned += damping[slot] * turns[k, e]
            parts[k * many + s] = turned
    for j in range(len(slots)):
        more = 0.0
        for s in range(begin[j], begin[j + 1]):
            more += signs[s] * parts[sources[s]]
        stiffness[slots[j]] += more
