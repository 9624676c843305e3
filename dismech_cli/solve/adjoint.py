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
from ..kinematics.motion import Since
from ..kinematics.turning import Holonomy
from ..model.state import State
from .accelerations import EULER
from .maps import Maps, maps_of
from .sensitivity import Differentiated, Held
from .slopes import Slopes
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

    @property
    def columns(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The first three as views, each of shape (n, 1)."""
        return self.q[:, None], self.v[:, None], self.a[:, None]

    def add(self, other: Owed) -> None:
        """Add what is owed besides."""
        self.q += other.q
        self.v += other.v
        self.a += other.a
        self.turns = tuple(x + y for x, y in zip(self.turns, other.turns, strict=True))


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
    for step in reversed(steps):
        owed = _before(model, step, owed, gradient)
    for k, one in enumerate(model.parameters):
        q, v, a, turns = one.of_start(start)
        gradient[k] += q @ owed.q + v @ owed.v + a @ owed.a
        gradient[k] += sum(float(x @ y) for x, y in zip(turns, owed.turns, strict=True))
    return gradient


def _before(model: Differentiated, step: TapedStep, owed: Owed, gradient: FloatArray) -> Owed:
    """What is owed to the state before a step; adds what is owed to parameters in it."""
    n = len(owed.q)
    to_start = Owed(np.zeros(n), np.zeros(n), np.zeros(n), tuple(map(np.zeros_like, owed.turns)))
    for index, solved in reversed(tuple(enumerate(step.stages(model.integrator)))):
        maps = maps_of(model.integrator, step.dt)[index]
        owed = _through(model, maps, step, solved, owed, to_start, gradient)
    to_start.add(owed)
    if model.jumps(step.start):
        if model.rubs:
            _rubbed(model, step, to_start, gradient)
        else:
            _balanced(model, step.start, to_start, gradient)
    return to_start


def _through(
    model: Differentiated,
    maps: Maps,
    step: TapedStep,
    solved: SolvedStage,
    owed: Owed,
    to_start: Owed,
    gradient: FloatArray,
) -> Owed:
    """What is owed to the state that a stage starts from; adds what is to the start and to parameters."""
    held = model.held(step.start.t)
    c, slopes, holonomies = model.slopes(solved)
    ends = model.at_end(solved, holonomies)
    given = model.by_parameters(c, slopes, solved.stage.acceleration(solved.q))
    if held.balance.sweep is not None and not slopes.rank_ones:
        sides = model.sides(held, slopes, maps, holonomies, ends)
        found = held.balance.sweep.back(sides, owed.columns, owed.turns, to_start.columns, given, gradient)
        if found is not None:
            (q, v, a), turns, by_held = found
            _to_holds(model, held, solved, by_held, gradient)
            return Owed(q[:, 0], v[:, 0], a[:, 0], turns)
    return _by_batches(model, maps, held, solved, owed, to_start, gradient, (slopes, holonomies, ends), given)


def _to_holds(
    model: Differentiated, held: Held, solved: SolvedStage, by_held: FloatArray, gradient: FloatArray
) -> None:
    """Add what is owed to parameters by where held DOFs are, given what is owed to that, shape (K,)."""
    if not model.moving or not held.dofs.size:
        return
    still = np.zeros_like(solved.q)
    since = Since(solved.since, solved.before, solved.stored)
    turnless = tuple(np.zeros(len(edges.angles)) for edges in model.edges)
    for k, one in model.moving:
        law = one.of_holds(held.dofs, solved.stage.t_end, since, still, turnless)
        gradient[k] += by_held @ law


def _by_batches(
    model: Differentiated,
    maps: Maps,
    held: Held,
    solved: SolvedStage,
    owed: Owed,
    to_start: Owed,
    gradient: FloatArray,
    at: tuple[Slopes, tuple[Holonomy, ...], tuple[Holonomy, ...]],
    given: FloatArray,
) -> Owed:
    """The same in operations on arrays.

    Args:
        model: With its slopes.
        maps: Of the stage.
        held: What is held.
        solved: The stage.
        owed: To the state after it.
        to_start: To the start of the step; added to.
        gradient: To parameters, shape (P,); added to.
        at: Slopes at the solution, turns of frames up to the trial point and to the end.
        given: Derivative of the balance at a fixed state, shape (n, P).
    """
    stage, (slopes, holonomies, ends) = solved.stage, at
    w, led, free = stage.weights, held.led, held.balance.free
    # the state at the end, from the unknown q and the constants of the maps
    v, a, mean = owed.v.copy(), owed.a.copy(), np.zeros_like(owed.v)
    mean[led] = v[led] / (stage.t_end - solved.since)
    v[led] = a[led] = 0.0
    to_q = owed.q + stage.v_end[0] * v + stage.a_end[0] * a + mean
    before = -mean
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
    gradient -= mu @ given
    _to_holds(model, held, solved, (to_q - by_all)[held.dofs], gradient)
    by_turn = tuple(by_q[edges.angles] for edges in model.edges)
    for edges, turns, one in zip(model.edges, by_turn, holonomies, strict=True):
        edges.add_along(before, -one.before * turns)
    latest = Owed(
        before,
        np.zeros_like(before),
        np.zeros_like(before),
        tuple(x - y for x, y in zip(owed.turns, by_turn, strict=True)),
    )
    for slope, owing in zip(maps.slopes, (-by_q, -by_v, -by_a, v, a), strict=True):
        for to, part in zip((to_start, latest), slope.reshape(2, 3), strict=True):
            for array, by in zip((to.q, to.v, to.a), part, strict=True):
                if by:
                    array += by * owing
    return latest


def _rubbed(model: Differentiated, step: TapedStep, owed: Owed, gradient: FloatArray) -> None:
    """The acceleration that a step starts with, from the mean one of a step of Euler's method."""
    free, n = model.held(step.start.t).balance.free, len(owed.q)
    end = Owed(np.zeros(n), np.zeros(n), np.zeros(n), tuple(map(np.zeros_like, owed.turns)))
    end.v[free] = owed.a[free] / step.dt
    owed.v[free] -= end.v[free]
    owed.a[:] = 0.0
    (maps,) = maps_of(EULER, step.dt)
    owed.add(_through(model, maps, step, model.rubbed(step), end, owed, gradient))


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
