"""Adjoint sensitivities: the gradient of one number that a run ends in, to any count of parameters.

The tape of the run is read backwards. What the number owes to the state after a step becomes, by the
transposed balance of its stages and the transposed maps of the integrator, what it owes to the state before
and to each parameter: one solve per stage, however many parameters there are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from ..model.state import State
from .differentiated import Differentiated, Passage
from .solved import Solved, solved
from .tape import TapedStep


@dataclass(slots=True)
class Owed:
    """Derivative of a number to a state.

    Attributes:
        q: To positions and angles, shape (n,).
        v: To their rates, shape (n,).
        a: To the rates of these, shape (n,).
        turns: To the turns of carried frames, for each kind of edges (E,).
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray
    turns: tuple[FloatArray, ...]


def adjoint(model: Differentiated, start: State, steps: Sequence[TapedStep], end: Owed) -> FloatArray:
    """Gradient of a number to all parameters of a model, shape (P,).

    Args:
        model: With its slopes; :attr:`~.Differentiated.retraceable`.
        start: Where the run starts.
        steps: What it did.
        end: What the number owes to the last state.

    Raises:
        FactorizationError: A balance is singular: there is no derivative.
    """
    gradient, owed = np.zeros(len(model.parameters)), end
    for leg in reversed(model.legs(steps, len(steps))):
        first = leg[0]
        passage = model.passage(model.held(first.start.t), solved(model.integrator, leg))
        owed = _through(model, passage, owed, gradient)
        if model.jumps(first.start):
            before = _rubbed if model.rubs else _balanced
            before(model, first, owed, gradient)
    for k, one in enumerate(model.parameters):
        q, v, a, turns = one.of_start(start)
        gradient[k] += q @ owed.q + v @ owed.v + a @ owed.a
        gradient[k] += sum(float(x @ y) for x, y in zip(turns, owed.turns, strict=True))
    return gradient


@frozen
class _Debts:
    """What is owed on the way back through steps, changed in place.

    Attributes:
        state: To q, v, a where that is, shape (3, n, 1).
        turns: To the turns of frames there, for each kind of edges (E,).
        start: To q, v, a of the start of the step that it is in, shape (3, n, 1).
    """

    state: FloatArray
    turns: tuple[FloatArray, ...]
    start: FloatArray


def _through(model: Differentiated, passage: Passage, end: Owed, gradient: FloatArray) -> Owed:
    """What is owed to the state that a passage starts from; adds what is owed to parameters in it."""
    sweep, left = passage.held.balance.sweep, passage.solved.count
    state = np.stack((end.q, end.v, end.a))[:, :, None]
    debts = _Debts(state, tuple([turn.copy() for turn in end.turns]), np.zeros_like(state))
    turns = debts.turns[0] if debts.turns else np.empty(0)
    by_held, sides = np.empty((left, len(passage.held.dofs))), passage.sides
    sweeps = sweep is not None and passage.slopes.plain
    while left:
        if sweeps and sweep is not None:
            left = sweep.back(sides, debts.state, turns, debts.start, gradient, by_held, left)
            if not left:
                break
        left -= 1
        by_held[left] = _by_batches(model, passage, left, debts, gradient)
    if model.moving and by_held.size:
        for k, by in enumerate(by_held):
            _to_holds(model, passage, k, by, gradient)
    q, v, a = debts.state[:, :, 0]
    return Owed(q, v, a, debts.turns)


def _to_holds(
    model: Differentiated, passage: Passage, k: int, by_held: FloatArray, gradient: FloatArray
) -> None:
    """Add what is owed to parameters by where held DOFs are, given what is owed to that, shape (K,)."""
    end = passage.solved.ends[k]
    still, turnless = np.zeros_like(end.q), tuple(np.zeros(len(edges.angles)) for edges in model.edges)
    for p, one in model.moving:
        law = one.of_holds(passage.held.dofs, end.t, passage.since(k), still, turnless)
        gradient[p] += by_held @ law


def _by_batches(
    model: Differentiated, passage: Passage, k: int, debts: _Debts, gradient: FloatArray
) -> FloatArray:
    """Go back through a stage in operations on arrays.

    Args:
        model: With its slopes.
        passage: The stages.
        k: Number of the stage.
        debts: What is owed after it, then before it.
        gradient: To parameters, shape (P,); added to.

    Returns:
        What is owed to where held DOFs are, shape (K,).
    """
    held, maps, slopes = passage.held, passage.solved.maps, passage.slopes.at(k)
    index, balance = k % maps.stages, held.balance
    w, led, free = maps.weights[index], held.led, balance.free
    owed, start = debts.state[:, :, 0], debts.start[:, :, 0]
    # the state at the end, from the unknown q and the constants of the maps
    v, a, mean = owed[1].copy(), owed[2].copy(), np.zeros_like(owed[1])
    mean[led] = v[led] / passage.span(k)
    v[led] = a[led] = 0.0
    v_slope, a_slope = maps.numbers[index, 3:5]
    to_q = owed[0] + v_slope * v + a_slope * a + mean
    before = -mean
    for edges, turns, one in zip(model.edges, debts.turns, passage.to_end, strict=True):
        edges.add_along(to_q, one.after[k] * turns)
        edges.add_along(before, one.before[k] * turns)
    # the balance: K^T mu follows from J^T mu
    mu = np.zeros_like(to_q)
    mu[free] = balance.factorize(slopes, w).solve_transposed(to_q[free])
    by_all = balance.transposed(mu) if held.dofs.size else to_q.copy()
    by_held: FloatArray = (to_q - by_all)[held.dofs]
    by_a = model.model.mass * mu
    by_q = by_all - w.a * by_a
    by_v = np.zeros_like(mu)
    if slopes.damped:
        by_v = slopes.by_velocity_transposed(mu)
        by_q -= w.v * by_v
    by_q /= w.q
    gradient -= mu @ passage.given[k]
    for edges, turns, one in zip(model.edges, debts.turns, passage.to_trial, strict=True):
        by_turn = by_q[edges.angles]
        turns -= by_turn
        edges.add_along(before, -one.before[k] * by_turn)
    to_states = np.tensordot(maps.slopes[index].T, np.stack((-by_q, -by_v, -by_a, v, a)), 1)
    start += to_states[:3]
    owed[:] = to_states[3:]
    owed[0] += before
    if index == 0:
        owed += start
        start[:] = 0.0
    return by_held


def _rubbed(model: Differentiated, step: TapedStep, owed: Owed, gradient: FloatArray) -> None:
    """The acceleration that a step starts with, from the mean one of a step of Euler's method."""
    passage = model.passage(model.held(step.start.t), model.rubbed(step))
    free, nothing = passage.held.balance.free, np.zeros_like(owed.q)
    by_v = np.zeros_like(owed.q)
    by_v[free] = owed.a[free] / step.dt
    owed.v[free] -= by_v[free]
    owed.a[:] = 0.0
    end = Owed(nothing, by_v, nothing, tuple(map(np.zeros_like, owed.turns)))
    before = _through(model, passage, end, gradient)
    owed.q += before.q
    owed.v += before.v
    owed.a += before.a
    owed.turns = tuple(x + y for x, y in zip(owed.turns, before.turns, strict=True))


def _balanced(model: Differentiated, step: TapedStep, owed: Owed, gradient: FloatArray) -> None:
    """The acceleration that a step starts with, from the balance of forces."""
    passage = model.passage(model.held(step.start.t), Solved.at(step.start))
    balance, slopes, mass = passage.held.balance, passage.slopes.at(0), model.model.mass
    movable = balance.free[mass[balance.free] > 0.0]
    mu = np.zeros_like(owed.q)
    mu[movable] = owed.a[movable] / mass[movable]
    by_q = balance.stiff_transposed(slopes, mu)
    gradient -= mu @ passage.given[0]
    owed.q -= by_q
    if slopes.damped:
        owed.v -= slopes.by_velocity_transposed(mu)
    owed.turns = tuple(x - by_q[edges.angles] for edges, x in zip(model.edges, owed.turns, strict=True))
    owed.a[:] = 0.0
