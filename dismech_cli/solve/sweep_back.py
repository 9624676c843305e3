"""Stages of sweeps of derivatives from the end to the start: what :mod:`.adjoint` does in batches.

Matrices, bands and turns are given as :mod:`.sweep_loops` says.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..geometry.kernel import kernel, loop
from .linear.factors import RESIDUAL_GOAL
from .sweep_matrix import add_transposed, fill, in_place, total

# Loops want plain numbers.
_GOAL = RESIDUAL_GOAL


@kernel
def _owing(maps: FloatArray, j: Any, x: Any) -> Any:
    """Column j of maps (5, 6) of five numbers."""
    first = maps[0, j] * x[0] + maps[1, j] * x[1] + maps[2, j] * x[2]
    return first + maps[3, j] * x[3] + maps[4, j] * x[4]


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
        numbers: As of :func:`.sweep_loops.go_forward`.
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
