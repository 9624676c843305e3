"""Forward sensitivities: how every state of a run changes with parameters of its scene.

The balance of a stage, M a_s + r(q_s, v_s; p) = 0 with q_s, v_s, a_s affine in the unknown q and in the
state before, is differentiated as it stands:

    J dq = -(dr/dp + K q0(d) + C v0(d) + M a0(d)),   J = a M + v C + q K,

where d is the derivative of the state before, put through the same maps of the integrator. With dq = x + y
and y = -q0(d)/q the product with K drops out, which is the dearest:

    J x = -(dr/dp + C (v0(d) + v y) + M (a0(d) + a y)).

One text serves statics and all integrators; what holds still has no derivative, what is held moves with the
parameters of its motion.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..model.state import State
from .commanded import Acting, nothing_acts
from .differentiated import Differentiated, Passage
from .neighbours import Variation
from .solved import Solved, solved
from .tape import TapedStep

NOWHERE: Final[IntArray] = np.empty(0, dtype=np.int64)


def forward(
    model: Differentiated,
    start: State,
    steps: Sequence[TapedStep],
    wanted: IntArray = NOWHERE,
    acting: Acting = nothing_acts,
) -> Iterator[Variation]:
    """Derivatives of the start and of the state after each step.

    Args:
        model: With its slopes.
        start: Where the run starts.
        steps: What it did.
        wanted: DOFs of which the derivative of the residual is asked for, shape (K,).
        acting: What acts between steps.

    Raises:
        FactorizationError: A balance is singular: there is no derivative.
    """
    d, before = model.start(start), start
    yield d
    for leg in model.legs(steps, len(steps) if acting is nothing_acts else 1):
        first = leg[0]
        d = acting(before, d, first.start.t + first.dt)
        if model.jumps(first.start):
            d = replace(d, a=(_rubbed(model, first, d) if model.rubs else _balanced(model, first.start, d)))
        passage = model.passage(model.held(first.start.t), solved(model.integrator, leg))
        for after in _through(model, passage, d, wanted):
            yield after
        d = after
        before = leg[-1].result.state


def _rubbed(model: Differentiated, step: TapedStep, d: Variation) -> FloatArray:
    """Derivative of the mean acceleration of a step of Euler's method, shape (n, P)."""
    passage = model.passage(model.held(step.start.t), model.rubbed(step))
    (after,) = _through(model, passage, d, NOWHERE)
    free, a = passage.held.balance.free, np.zeros_like(d.q)
    a[free] = (after.v - d.v)[free] / step.dt
    return a


def _balanced(model: Differentiated, state: State, d: Variation) -> FloatArray:
    """Derivative of -M^-1 r, shape (n, P)."""
    passage = model.passage(model.held(state.t), Solved.at(state))
    balance, slopes, dq = passage.held.balance, passage.slopes.at(0), d.q.copy()
    for edges, turns in zip(model.edges, d.turns, strict=True):
        dq[edges.angles] += turns
    rate = passage.given[0]
    rate += balance.stiff(slopes, dq)
    if d.inputs.any():
        rate += model.by_inputs(passage.points[0], d.inputs)
    if slopes.damped:
        rate += slopes.by_velocity(d.v)
    free, mass = balance.free, model.model.mass
    movable = free[mass[free] > 0.0]
    a = np.zeros_like(d.q)
    a[movable] = -rate[movable] / mass[movable, None]
    return a


@frozen
class _Rows:
    """Derivatives at the start of C stages and after each of them.

    Attributes:
        states: Of q, v, a, shape (C + 1, 3, n, P).
        turns: Of the turns of frames, for each kind of edges (C + 1, E, P).
        residuals: Of the M a + r of each stage where that is wanted, or of one for all, shape (1, n, P).
    """

    states: FloatArray
    turns: tuple[FloatArray, ...]
    residuals: FloatArray

    @classmethod
    def of(cls, d: Variation, count: int, *, wanted: bool) -> _Rows:
        """Room for stages, with the derivative that they start from."""
        states = np.empty((count + 1, 3, *d.q.shape))
        states[0] = d.q, d.v, d.a
        turns = tuple([np.empty((count + 1, *turn.shape)) for turn in d.turns])
        for rows, turn in zip(turns, d.turns, strict=True):
            rows[0] = turn
        return cls(states, turns, np.zeros((count if wanted else 1, *d.q.shape)))

    def at(self, k: int, d: Variation) -> Variation:
        """The derivative after some stages from that before, under the same inputs."""
        q, v, a = self.states[k]
        residual = self.residuals[(k - 1) % len(self.residuals)]
        return Variation(q, v, a, tuple([rows[k] for rows in self.turns]), residual, d.inputs, d.memory)


def _through(model: Differentiated, passage: Passage, d: Variation, wanted: IntArray) -> Iterator[Variation]:
    """Derivatives after the steps of a passage, from that before."""
    solved, sweep, inputs = passage.solved, passage.held.balance.sweep, d.inputs
    count, stages = solved.count, solved.maps.stages
    rows = _Rows.of(d, count, wanted=wanted.size > 0)
    if inputs.any():
        for c, given in zip(passage.points, passage.given, strict=True):
            given += model.by_inputs(c, inputs)
    turns = rows.turns[0] if rows.turns else np.empty((count + 1, 0, d.q.shape[1]))
    sweeps = sweep is not None and passage.slopes.plain and not wanted.size
    done, sides = 0, passage.sides
    while done < count:
        held_q = _where_held(model, passage, done, rows)
        if sweeps and sweep is not None:
            reach = done + 1 if model.moving else count
            swept = sweep.forward(sides, rows.states, turns, held_q, done, reach)
            if swept == reach:
                done = reach
                continue
            done = swept
        _by_batches(model, passage, done, rows, wanted, held_q)
        done += 1
    for k in range(stages, count + 1, stages):
        yield rows.at(k, d)


def _where_held(model: Differentiated, passage: Passage, k: int, rows: _Rows) -> FloatArray:
    """Derivative of where held DOFs are at the end of a stage, shape (K, P)."""
    dofs, q = passage.held.dofs, rows.states[k, 0]
    held_q: FloatArray = q[dofs]
    if dofs.size and model.moving:
        since, t = passage.since(k), passage.solved.ends[k].t
        for p, one in model.moving:
            turned = [turn[k, :, p] for turn in rows.turns]
            held_q[:, p] = one.of_holds(dofs, t, since, q[:, p], turned)
    return held_q


def _by_batches(
    model: Differentiated, passage: Passage, k: int, rows: _Rows, wanted: IntArray, held_q: FloatArray
) -> None:
    """Write the derivative after a stage, in operations on arrays.

    Args:
        model: With its slopes.
        passage: The stages.
        k: Number of the stage.
        rows: Derivatives up to it; that after it is written.
        wanted: See :func:`forward`.
        held_q: Derivative of where held DOFs are, shape (K, P).
    """
    held, maps, slopes = passage.held, passage.solved.maps, passage.slopes.at(k)
    index, b, latest = k % maps.stages, passage.given[k], rows.states[k]
    start, q_latest = rows.states[k - index], latest[0]
    w, mass = maps.weights[index], model.model.mass[:, None]
    factors, free = held.balance.factorize(slopes, w), held.balance.free
    q0, v0, a0, v_end, a_end = np.tensordot(maps.slopes[index], np.concatenate((start, latest)), 1)
    along = [edges.along(q_latest) for edges in model.edges]
    # y: frames that have turned act as their angles do
    y = q0
    for edges, turn, way, up in zip(model.edges, rows.turns, along, passage.to_trial, strict=True):
        y[edges.angles] += turn[k] + _weighed(up.before[k], way)
    y /= -w.q
    b += mass * (a0 + w.a * y)
    if slopes.damped:
        b += slopes.by_velocity(v0 + w.v * y)
    x = np.zeros_like(y)
    if held.dofs.size:
        x[held.dofs] = held_q - y[held.dofs]
        if x.any():
            b += held.balance.times(x)
    x[free] = -factors.solve(b[free])
    dq = x + y
    by_v, by_a = maps.numbers[index, 3:5]
    q, v, a = rows.states[k + 1]
    q[:], v[:], a[:] = dq, by_v * dq + v_end, by_a * dq + a_end
    v[held.led] = (dq[held.led] - q_latest[held.led]) / passage.span(k)
    a[held.led] = 0.0
    for edges, turn, way, end in zip(model.edges, rows.turns, along, passage.to_end, strict=True):
        turn[k + 1] = turn[k] + _weighed(end.before[k], way) + _weighed(end.after[k], edges.along(dq))
    if wanted.size:
        # what was known already of held DOFs is in b
        x[held.dofs] = 0.0
        rows.residuals[k, wanted] = (b + held.balance.times(x))[wanted]
        # as what holds a mass moves it, along its path and not as the integrator would have it
        dt = passage.solved.ends[k].t - passage.solved.before[k - index].t
        change = (v - start[1]) / dt - (w.a * dq + a0)
        rows.residuals[k, held.dofs] += (mass * change)[held.dofs]


def _weighed(slopes: FloatArray, way: FloatArray) -> FloatArray:
    """Changes of edges (3, E, P) times slopes to them (3, E), shape (E, P)."""
    x, y, z = slopes[:, :, None]
    return np.asarray(x * way[0] + y * way[1] + z * way[2])
