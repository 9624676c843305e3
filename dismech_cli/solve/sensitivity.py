"""Forward sensitivities: how every state of a run changes with parameters of its scene.

The balance of a stage, M a_s + r(q_s, v_s; p) = 0 with q_s, v_s, a_s affine in the unknown q and in the
state before, is differentiated as it stands:

    (a M + v C + q K) dq = -(dr/dp + K q0(d) + C v0(d) + M a0(d)),

where d is the derivative of the state before, put through the same maps of the integrator. One text serves
statics and all integrators; what holds still has no derivative, what is held moves with the parameters of
its motion.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..kinematics.motion import Since, held_dofs, held_span
from ..model.configuration import Configuration
from ..model.model import Model
from ..model.state import State
from .integrators import Integrator, at_state
from .neighbours import Here, Neighbours, ParameterSlope, Variation
from .slopes import Balance, Slope, Slopes
from .tape import SolvedStage, TapedStep


@dataclass(frozen=True, slots=True)
class Held:
    """What is held during a step.

    Attributes:
        since: Time from which on it is [s].
        mask: The held DOFs, shape (n,).
        dofs: Those.
        led: Those and the massless ones of dynamics, whose rates are difference quotients.
        balance: Solves for the others.
    """

    since: float
    mask: BoolArray
    dofs: IntArray
    led: IntArray
    balance: Balance


class Differentiated:
    """A model with the slopes of its balance to its state and to parameters.

    Attributes:
        model: The semi-discrete system.
        integrator: Of its run.
        parameters: A slope for each parameter.
    """

    def __init__(self, model: Model, integrator: Integrator, parameters: Sequence[Neighbours]) -> None:
        """Bind everything once.

        Raises:
            UnlikeError: A parameter changes the structure of the model.
        """
        self.model, self.integrator = model, integrator
        self._slope = Slope(model)
        self.parameters = tuple(
            ParameterSlope(k, model, near, self._slope.pattern, self._slope.terms)
            for k, near in enumerate(parameters)
        )
        self.edges = model.frames.turning
        self._moves = bool(model.mass.any())
        self._held: dict[float, Held] = {}

    @property
    def retraceable(self) -> bool:
        """Whether the adjoint knows all: not how motions that remember depend on what they did before."""
        return not any(one.moves for one in self.parameters) or not any(
            motion.remembers for motion in self.model.motions
        )

    def held(self, t: float) -> Held:
        """What is held during a step that starts at ``t`` [s]."""
        since = held_span(self.model.motions, t)[0]
        if since not in self._held:
            mask = held_dofs(self.model.motions, self.model.dofs.n, t)
            led = mask | ((self.model.mass == 0.0) & self._moves)
            balance = Balance(self._slope, ~mask)
            self._held[since] = Held(since, mask, np.flatnonzero(mask), np.flatnonzero(led), balance)
        return self._held[since]

    def jumps(self, state: State) -> bool:
        """Whether the acceleration that a step starts with was made from the balance of forces."""
        begins = state.t in (0.0, self.held(state.t).since)
        return begins and self.integrator.needs_acceleration

    def trial(self, solved: SolvedStage) -> Configuration:
        """The solution of a stage as a trial point."""
        stage, q = solved.stage, solved.q
        position = stage.position(q)
        frames = self.model.frames.transport(solved.stored, position)
        return Configuration(stage.t_stage, position, stage.velocity(q), frames, stage.inputs)

    def slopes(self, solved: SolvedStage) -> tuple[Configuration, Slopes]:
        """Trial point at the solution of a stage, and slopes of its balance."""
        c = self.trial(solved)
        return c, self._slope.at(c, solved.before)

    def slopes_at(self, state: State) -> tuple[Configuration, Slopes]:
        """The same of the balance at a state itself, whose frames are stored there."""
        return self.slopes(SolvedStage(at_state(state), state.q, state.frames, state.q, state.t))

    def by_parameters(self, c: Configuration, a: FloatArray) -> FloatArray:
        """D(M a + r)/dp at a fixed state, shape (n, P)."""
        here = Here(c, self._slope.terms)
        return np.stack([one.of_balance(here, a) for one in self.parameters], axis=1)

    def start(self, start: State) -> Variation:
        """Derivative of where the run starts."""
        parts = [one.of_start(start) for one in self.parameters]
        q, v, a = (np.stack([part[k] for part in parts], axis=1) for k in range(3))
        turns = tuple(np.stack([part[3][k] for part in parts], axis=1) for k in range(len(self.edges)))
        return Variation(q, v, a, turns, np.zeros_like(q))


def forward(model: Differentiated, start: State, steps: Sequence[TapedStep]) -> Iterator[Variation]:
    """Derivatives of the start and of the state after each step.

    Args:
        model: With its slopes.
        start: Where the run starts.
        steps: What it did.

    Raises:
        FactorizationError: A balance is singular: there is no derivative.
    """
    d = model.start(start)
    yield d
    for step in steps:
        d = _after(model, step, d)
        yield d


def _after(model: Differentiated, step: TapedStep, d: Variation) -> Variation:
    """Derivative after a step from that before."""
    if model.jumps(step.start):
        d = replace(d, a=_balanced(model, step.start, d))
    start = latest = d
    for index, solved in enumerate(step.stages(model.integrator)):
        latest, acceleration = _through(model, step, index, solved, start, latest)
    # as what holds a mass moves it, along its path and not as the integrator would have it
    held, mass = model.held(step.start.t).dofs, model.model.mass
    if held.size and mass[held].any():
        change = (latest.v - start.v) / step.dt - acceleration
        latest.residual[held] += mass[held, None] * change[held]
    return latest


def _balanced(model: Differentiated, state: State, d: Variation) -> FloatArray:
    """Derivative of -M^-1 r, shape (n, P)."""
    c, slopes = model.slopes_at(state)
    rate = model.by_parameters(c, state.a)
    rate += slopes.times(d.q, d.v, np.zeros_like(d.q))
    if model.edges:
        rate += slopes.turned(d.turns)
    free, mass = model.held(state.t).balance.free, model.model.mass
    movable = free[mass[free] > 0.0]
    a = np.zeros_like(d.q)
    a[movable] = -rate[movable] / mass[movable, None]
    return a


def _through(
    model: Differentiated,
    step: TapedStep,
    index: int,
    solved: SolvedStage,
    start: Variation,
    latest: Variation,
) -> tuple[Variation, FloatArray]:
    """Derivative after a stage, and that of the acceleration that it balances, shape (n, P)."""
    stage, held = solved.stage, model.held(step.start.t)
    maps = model.integrator.stage(index, _as_state(step.start, start), _as_state(step.start, latest), step.dt)
    w = stage.weights
    c, slopes = model.slopes(solved)
    dq = np.zeros_like(start.q)
    since = Since(solved.since, solved.before, solved.stored)
    for k, one in enumerate(model.parameters):
        dq[held.dofs, k] = one.of_holds(
            held.dofs, stage.t_end, since, latest.q[:, k], [turn[:, k] for turn in latest.turns]
        )
    by_all = model.by_parameters(c, stage.acceleration(solved.q))
    if model.edges:
        turns = tuple(
            turn + np.einsum("ie,iep->ep", edges.holonomy(solved.before, c.q)[0], edges.along(latest.q))
            for edges, turn in zip(model.edges, latest.turns, strict=True)
        )
        by_all += slopes.turned(turns)
    known = by_all + slopes.times(w.q * dq + maps.q0, w.v * dq + maps.v0, w.a * dq + maps.a0)
    factors, free = held.balance.factorize(slopes, w), held.balance.free
    for k in range(dq.shape[1]):
        dq[free, k] = factors.solve(-known[free, k])
    residual = by_all + slopes.times(w.q * dq + maps.q0, w.v * dq + maps.v0, w.a * dq + maps.a0)
    v, a = maps.finish(dq)
    led = held.led
    v[led] = (dq[led] - latest.q[led]) / (stage.t_end - solved.since)
    a[led] = 0.0
    turns = tuple(
        turn
        + np.einsum("ie,iep->ep", before, edges.along(latest.q))
        + np.einsum("ie,iep->ep", after, edges.along(dq))
        for edges, turn, (before, after) in (
            (edges, turn, edges.holonomy(solved.before, solved.q))
            for edges, turn in zip(model.edges, latest.turns, strict=True)
        )
    )
    return Variation(dq, v, a, turns, residual), w.a * dq + maps.a0


def _as_state(state: State, d: Variation) -> State:
    """A derivative in the place of a state: the maps of integrators are affine in it, and linear here."""
    return replace(state, q=d.q, v=d.v, a=d.a)
