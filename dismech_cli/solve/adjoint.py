"""Adjoint sensitivities: the gradient of one number that a run ends in, to any count of parameters.

The tape of the run is read backwards. What the number owes to the state after a step becomes, by the
transposed balance of its stages and the transposed maps of the integrator, what it owes to the state before
and to each parameter: one solve per stage, however many parameters there are.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import TypeAlias

import numpy as np

from ..arrays import FloatArray
from ..kinematics.motion import Since
from ..model.state import State
from .integrators import Integrator
from .sensitivity import Differentiated
from .tape import SolvedStage, TapedStep


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

    def add(self, other: Owed) -> None:
        """Add what is owed besides."""
        self.q += other.q
        self.v += other.v
        self.a += other.a
        self.turns = tuple(x + y for x, y in zip(self.turns, other.turns, strict=True))


@dataclass(frozen=True, slots=True)
class Coefficients:
    """Slopes of the affine maps of a stage to the states that they are made from.

    Each is of shape (2, 3): to q, v, a of the start of the step, then of the latest stage.

    Attributes:
        q0: Of the constant part of q_s.
        v0: Of that of v_s.
        a0: Of that of a_s.
        v_end: Of that of the velocity at the end.
        a_end: Of that of the acceleration.
    """

    q0: FloatArray
    v0: FloatArray
    a0: FloatArray
    v_end: FloatArray
    a_end: FloatArray

    @classmethod
    def of(cls, integrator: Integrator, start: State, index: int, dt: float) -> Coefficients:
        """Ask the integrator, with a unit in the place of each; the state may be any."""
        units = np.eye(6)
        one = replace(start, q=units[0], v=units[1], a=units[2])
        latest = one if index == 0 else replace(start, q=units[3], v=units[4], a=units[5])
        maps = integrator.stage(index, one, latest, dt)
        found = (maps.q0, maps.v0, maps.a0, maps.v_end[1], maps.a_end[1])
        return cls(*(slopes.reshape(2, 3) for slopes in found))


Maps: TypeAlias = "Callable[[int, float], Coefficients]"
"""Those of a stage, by its number and the length of the step."""


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
    coefficients = cache(partial(Coefficients.of, model.integrator, start))
    for step in reversed(steps):
        owed = _before(model, coefficients, step, owed, gradient)
    for k, one in enumerate(model.parameters):
        q, v, a, turns = one.of_start(start)
        gradient[k] += q @ owed.q + v @ owed.v + a @ owed.a
        gradient[k] += sum(float(x @ y) for x, y in zip(turns, owed.turns, strict=True))
    return gradient


def _before(
    model: Differentiated, coefficients: Maps, step: TapedStep, owed: Owed, gradient: FloatArray
) -> Owed:
    """What is owed to the state before a step; adds what is owed to parameters in it."""
    n = len(owed.q)
    to_start = Owed(np.zeros(n), np.zeros(n), np.zeros(n), tuple(map(np.zeros_like, owed.turns)))
    for index, solved in reversed(tuple(enumerate(step.stages(model.integrator)))):
        maps = coefficients(index, step.dt)
        owed = _through(model, maps, step, solved, owed, to_start, gradient)
    to_start.add(owed)
    if model.jumps(step.start):
        _balanced(model, step.start, to_start, gradient)
    return to_start


def _through(
    model: Differentiated,
    maps: Coefficients,
    step: TapedStep,
    solved: SolvedStage,
    owed: Owed,
    to_start: Owed,
    gradient: FloatArray,
) -> Owed:
    """What is owed to the state that a stage starts from; adds what is to the start and to parameters."""
    stage, held = solved.stage, model.held(step.start.t)
    w, led, free = stage.weights, held.led, held.balance.free
    c, slopes, holonomies = model.slopes(solved)
    # the state at the end, from the unknown q and the constants of the maps
    v, a, mean = owed.v.copy(), owed.a.copy(), np.zeros_like(owed.v)
    mean[led] = v[led] / (stage.t_end - solved.since)
    v[led] = a[led] = 0.0
    to_q = owed.q + stage.v_end[0] * v + stage.a_end[0] * a + mean
    before = -mean
    ends = model.at_end(solved, holonomies)
    for edges, turns, one in zip(model.edges, owed.turns, ends, strict=True):
        edges.add_along(to_q, one.after * turns)
        edges.add_along(before, one.before * turns)
    # the balance: K^T mu follows from J^T mu
    mu = np.zeros_like(to_q)
    mu[free] = held.balance.factorize(slopes, w).solve_transposed(to_q[free])
    by_all = held.balance.transposed(mu) if held.dofs.size else to_q
    by_a = model.model.mass * mu
    by_q = by_all - w.a * by_a
    by_v = np.zeros_like(mu)
    if slopes.damped:
        by_v = slopes.by_velocity_transposed(mu)
        by_q -= w.v * by_v
    by_q /= w.q
    gradient -= mu @ model.by_parameters(c, slopes, stage.acceleration(solved.q))
    moving = [k for k, one in enumerate(model.parameters) if one.moves] if held.dofs.size else []
    if moving:
        to_held, still = (to_q - by_all)[held.dofs], np.zeros_like(to_q)
        since = Since(solved.since, solved.before, solved.stored)
        turnless = tuple(map(np.zeros_like, owed.turns))
        for k in moving:
            law = model.parameters[k].of_holds(held.dofs, stage.t_end, since, still, turnless)
            gradient[k] += to_held @ law
    by_turn = tuple(by_q[edges.angles] for edges in model.edges)
    for edges, turns, one in zip(model.edges, by_turn, holonomies, strict=True):
        edges.add_along(before, -one.before * turns)
    latest = Owed(
        before,
        np.zeros_like(before),
        np.zeros_like(before),
        tuple(x - y for x, y in zip(owed.turns, by_turn, strict=True)),
    )
    parts = (
        (maps.q0, -by_q),
        (maps.v0, -by_v),
        (maps.a0, -by_a),
        (maps.v_end, v),
        (maps.a_end, a),
    )
    for slope, owing in parts:
        for to, (by_position, by_rate, by_second) in zip((to_start, latest), slope, strict=True):
            for array, by in ((to.q, by_position), (to.v, by_rate), (to.a, by_second)):
                if by:
                    array += by * owing
    return latest


def _balanced(model: Differentiated, state: State, owed: Owed, gradient: FloatArray) -> None:
    """The acceleration that a step starts with, from the balance of forces."""
    c, slopes = model.slopes_at(state)
    balance, mass = model.held(state.t).balance, model.model.mass
    movable = balance.free[mass[balance.free] > 0.0]
    mu = np.zeros_like(owed.q)
    mu[movable] = owed.a[movable] / mass[movable]
    by_q = balance.stiff_transposed(slopes, mu)
    gradient -= mu @ model.by_parameters(c, slopes, state.a)
    owed.q -= by_q
    if slopes.damped:
        owed.v -= slopes.by_velocity_transposed(mu)
    owed.turns = tuple(x - by_q[edges.angles] for edges, x in zip(model.edges, owed.turns, strict=True))
    owed.a[:] = 0.0
