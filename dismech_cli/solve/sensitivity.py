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
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..kernels.driver import Driver
from ..kinematics.motion import Since, held_dofs, held_span, prescribe
from ..kinematics.turning import Holonomy
from ..model.configuration import Configuration
from ..model.model import Model
from ..model.state import State
from .accelerations import EULER
from .anew import met
from .commanded import Acting, Commanded, nothing_acts
from .integrators import Integrator
from .maps import Maps, maps_of
from .neighbours import Here, Neighbours, ParameterSlope, Variation
from .slopes import Balance, Slope, Slopes
from .stage import at_state
from .sweep import Sides, turned_by, weighed_by
from .tape import SolvedStage, TapedStep

NOWHERE: Final[IntArray] = np.empty(0, dtype=np.int64)


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
        moving: Those with which motions change, with their numbers.
        edges: Edges whose frames are carried.
    """

    def __init__(
        self,
        model: Model,
        integrator: Integrator,
        parameters: Sequence[Neighbours],
        sweeper: Driver | None = None,
        steps: Sequence[TapedStep] = (),
    ) -> None:
        """Bind everything once.

        Args:
            model: The semi-discrete system.
            integrator: Of its run.
            parameters: What it is differentiated by.
            sweeper: Runs what goes through stages; by default what runs the model.
            steps: What the run did; none where nothing comes and goes.

        Raises:
            UnlikeError: A parameter changes the structure of the model.
        """
        self.model, self.integrator = model, integrator
        sweeper = sweeper or model.driver
        exact = replace(model, changing=tuple(term.exactly() for term in model.changing))
        self._slope = Slope(exact, sweeper, met(exact.changing, model.driver, integrator, steps))
        self._rubs = any(term.velocity_dependent for term in model.changing)
        self.parameters = tuple(
            ParameterSlope(k, model, near, self._slope.pattern, self._slope.terms)
            for k, near in enumerate(parameters)
        )
        self.moving = [(k, one) for k, one in enumerate(self.parameters) if one.moves]
        self._others = [(k, one) for k, one in enumerate(self.parameters) if one.others]
        self.edges = model.frames.turning
        self._turned, self._weighed = turned_by(sweeper), weighed_by(sweeper)
        self._commanded = Commanded(self._slope.terms)
        self._shares = np.stack([one.shares for one in self.parameters], axis=1)
        self._mass = np.stack([one.mass for one in self.parameters], axis=1)
        self._moves = bool(model.mass.any())
        self._held: dict[float, Held] = {}
        self._span = (0.0, 0.0)

    @property
    def retraceable(self) -> bool:
        """Whether the adjoint knows all: not how motions that remember depend on what they did before."""
        return not self.moving or not any(motion.remembers for motion in self.model.motions)

    def held(self, t: float) -> Held:
        """What is held during a step that starts at ``t`` [s]."""
        since, until = self._span
        if not since <= t < until:
            since, until = self._span = held_span(self.model.motions, t)
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

    @property
    def rubs(self) -> bool:
        """Whether an acceleration that is made anew is that which friction leaves."""
        return self._rubs

    def rubbed(self, step: TapedStep) -> SolvedStage:
        """The step of Euler's method that it was made by, see :func:`.accelerations.rubbed`."""
        start, dt = step.start, step.dt
        q, since = start.q + dt * (start.v + dt * start.a), Since(start.t, start.q, start.frames)
        stage = EULER.stage(0, start, start, dt)
        prescribe(self.model.motions, q, stage.t_end, since)
        return SolvedStage(stage, q, start.frames, start.q, start.t)

    def trial(self, solved: SolvedStage) -> Configuration:
        """The solution of a stage as a trial point."""
        stage, q = solved.stage, solved.q
        position = stage.position(q)
        frames = self.model.frames.transport(solved.stored, position)
        return Configuration(stage.t_stage, position, stage.velocity(q), frames, stage.inputs)

    def slopes(self, solved: SolvedStage) -> tuple[Configuration, Slopes, tuple[Holonomy, ...]]:
        """Trial point at the solution of a stage, slopes of its balance, how frames turned up to there."""
        c = self.trial(solved)
        holonomies = self.holonomies(solved, c.q)
        return c, self._slope.at(c, holonomies), holonomies

    def slopes_at(self, state: State) -> tuple[Configuration, Slopes]:
        """The same of the balance at a state itself, whose frames are stored there."""
        c, slopes, _ = self.slopes(SolvedStage(at_state(state), state.q, state.frames, state.q, state.t))
        return c, slopes

    def holonomies(self, solved: SolvedStage, q: FloatArray) -> tuple[Holonomy, ...]:
        """How frames turn from the start of a stage to a shape (n,)."""
        return tuple(self._turned(edges, solved.before, q) for edges in self.edges)

    def at_end(self, solved: SolvedStage, holonomies: tuple[Holonomy, ...]) -> tuple[Holonomy, ...]:
        """How they turn to the end of a stage, of those up to its trial point, which may be the same."""
        w, known = solved.stage.weights, holonomies
        if not known or (w.q == 1.0 and not solved.stage.q0.any()):
            return known
        return self.holonomies(solved, solved.q)

    def sides(
        self,
        held: Held,
        slopes: Slopes,
        maps: Maps,
        to_trial: tuple[Holonomy, ...],
        to_end: tuple[Holonomy, ...],
    ) -> Sides:
        """What a stage balances, for sweeps."""
        return Sides(maps, slopes.matrix, held.dofs, held.led, to_trial, to_end)

    def by_parameters(self, c: Configuration, slopes: Slopes, a: FloatArray) -> FloatArray:
        """D(M a + r)/dp at a fixed state, shape (n, P)."""
        found = self._weighed(slopes.residuals, self._shares, self._mass, a)
        here = Here(c, self._slope.terms)
        for k, one in self._others:
            if (more := one.of_others(here)) is not None:
                found[:, k] += more
        return found

    def by_inputs(self, c: Configuration, change: FloatArray) -> FloatArray:
        """Derivative of r at a fixed state along changes of the inputs (I, P), shape (n, P)."""
        return self._commanded.slope(c, change)

    def start(self, start: State) -> Variation:
        """Derivative of where the run starts."""
        parts = [one.of_start(start) for one in self.parameters]
        q, v, a = (np.stack([part[k] for part in parts], axis=1) for k in range(3))
        turns = tuple(np.stack([part[3][k] for part in parts], axis=1) for k in range(len(self.edges)))
        count = len(self.parameters)
        memory = {name: np.zeros((*np.shape(values), count)) for name, values in start.memory.items()}
        inputs = np.zeros((len(start.inputs), count))
        return Variation(q, v, a, turns, np.zeros_like(q), inputs, memory)


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
    for step in steps:
        d = _after(model, step, acting(before, d, step.start.t + step.dt), wanted)
        before = step.result.state
        yield d


def _after(model: Differentiated, step: TapedStep, d: Variation, wanted: IntArray) -> Variation:
    """Derivative after a step from that before."""
    if model.jumps(step.start):
        d = replace(d, a=(_rubbed(model, step, d) if model.rubs else _balanced(model, step.start, d)))
    start = latest = d
    for index, solved in enumerate(step.stages(model.integrator)):
        latest, acceleration = _through(model, model.integrator, step, index, solved, start, latest, wanted)
    # as what holds a mass moves it, along its path and not as the integrator would have it
    held, mass = model.held(step.start.t).dofs, model.model.mass
    if wanted.size and held.size and mass[held].any():
        change = (latest.v - start.v) / step.dt - acceleration
        latest.residual[held] += mass[held, None] * change[held]
    return latest


def _rubbed(model: Differentiated, step: TapedStep, d: Variation) -> FloatArray:
    """Derivative of the mean acceleration of a step of Euler's method, shape (n, P)."""
    after, _ = _through(model, EULER, step, 0, model.rubbed(step), d, d, NOWHERE)
    free, a = model.held(step.start.t).balance.free, np.zeros_like(d.q)
    a[free] = (after.v - d.v)[free] / step.dt
    return a


def _balanced(model: Differentiated, state: State, d: Variation) -> FloatArray:
    """Derivative of -M^-1 r, shape (n, P)."""
    c, slopes = model.slopes_at(state)
    balance, dq = model.held(state.t).balance, d.q.copy()
    for edges, turns in zip(model.edges, d.turns, strict=True):
        dq[edges.angles] += turns
    rate = model.by_parameters(c, slopes, state.a)
    rate += balance.stiff(slopes, dq)
    if d.inputs.any():
        rate += model.by_inputs(c, d.inputs)
    if slopes.damped:
        rate += slopes.by_velocity(d.v)
    free, mass = balance.free, model.model.mass
    movable = free[mass[free] > 0.0]
    a = np.zeros_like(d.q)
    a[movable] = -rate[movable] / mass[movable, None]
    return a


def _through(
    model: Differentiated,
    integrator: Integrator,
    step: TapedStep,
    index: int,
    solved: SolvedStage,
    start: Variation,
    latest: Variation,
    wanted: IntArray,
) -> tuple[Variation, FloatArray]:
    """Derivative after a stage, and that of the acceleration that it balances, shape (n, P)."""
    stage, held = solved.stage, model.held(step.start.t)
    c, slopes, holonomies = model.slopes(solved)
    ends, maps = model.at_end(solved, holonomies), maps_of(integrator, step.dt)[index]
    b = model.by_parameters(c, slopes, stage.acceleration(solved.q))
    if latest.inputs.any():
        b += model.by_inputs(c, latest.inputs)
    held_q = _where_held(model, held, solved, latest)
    if held.balance.sweep is not None and not slopes.rank_ones and not wanted.size:
        sides = model.sides(held, slopes, maps, holonomies, ends)
        states = ((start.q, start.v, start.a), (latest.q, latest.v, latest.a))
        found = held.balance.sweep.forward(sides, states, b, held_q, latest.turns)
        if found is not None:
            (q, v, a), turns = found
            return Variation(q, v, a, turns, latest.residual, latest.inputs, latest.memory), a
    return _by_batches(
        model, integrator, index, step, solved, start, latest, wanted, (slopes, holonomies, ends), b, held_q
    )


def _where_held(model: Differentiated, held: Held, solved: SolvedStage, latest: Variation) -> FloatArray:
    """Derivative of where held DOFs are at the end of a stage, shape (K, P)."""
    held_q: FloatArray = latest.q[held.dofs]
    if held.dofs.size and model.moving:
        since = Since(solved.since, solved.before, solved.stored)
        for k, one in model.moving:
            turned = [turn[:, k] for turn in latest.turns]
            held_q[:, k] = one.of_holds(held.dofs, solved.stage.t_end, since, latest.q[:, k], turned)
    return held_q


def _by_batches(
    model: Differentiated,
    integrator: Integrator,
    index: int,
    step: TapedStep,
    solved: SolvedStage,
    start: Variation,
    latest: Variation,
    wanted: IntArray,
    at: tuple[Slopes, tuple[Holonomy, ...], tuple[Holonomy, ...]],
    b: FloatArray,
    held_q: FloatArray,
) -> tuple[Variation, FloatArray]:
    """The same in operations on arrays.

    Args:
        model: With its slopes.
        integrator: Has the maps.
        index: Of the stage.
        step: Its step.
        solved: The stage.
        start: Derivative of the start of the step.
        latest: Of the state before the stage.
        wanted: See :func:`forward`.
        at: Slopes at the solution, turns of frames up to the trial point and to the end.
        b: Derivative of the balance at a fixed state, shape (n, P); used up.
        held_q: Of where held DOFs are, shape (K, P).
    """
    stage, held = solved.stage, model.held(step.start.t)
    slopes, holonomies, ends = at
    maps = integrator.stage(index, _as_state(step.start, start), _as_state(step.start, latest), step.dt)
    w, mass = stage.weights, model.model.mass[:, None]
    factors, free = held.balance.factorize(slopes, w), held.balance.free
    along = [edges.along(latest.q) for edges in model.edges]
    # y: frames that have turned act as their angles do
    y = maps.q0.copy()
    for edges, turn, way, up in zip(model.edges, latest.turns, along, holonomies, strict=True):
        y[edges.angles] += turn + _weighed(up.before, way)
    y /= -w.q
    b += mass * (maps.a0 + w.a * y)
    if slopes.damped:
        b += slopes.by_velocity(maps.v0 + w.v * y)
    x = np.zeros_like(y)
    if held.dofs.size:
        x[held.dofs] = held_q - y[held.dofs]
        if x.any():
            b += held.balance.times(x)
    x[free] = -factors.solve(b[free])
    dq = x + y
    v, a = maps.finish(dq)
    led = held.led
    v[led] = (dq[led] - latest.q[led]) / (stage.t_end - solved.since)
    a[led] = 0.0
    turns = tuple(
        turn + _weighed(end.before, way) + _weighed(end.after, edges.along(dq))
        for edges, turn, way, end in zip(model.edges, latest.turns, along, ends, strict=True)
    )
    residual = np.zeros_like(dq)
    if wanted.size:
        # what was known already of held DOFs is in b
        x[held.dofs] = 0.0
        residual[wanted] = (b + held.balance.times(x))[wanted]
    after = Variation(dq, v, a, turns, residual, latest.inputs, latest.memory)
    return after, w.a * dq + maps.a0


def _weighed(slopes: FloatArray, way: FloatArray) -> FloatArray:
    """Changes of edges (3, E, P) times slopes to them (3, E), shape (E, P)."""
    x, y, z = slopes[:, :, None]
    return np.asarray(x * way[0] + y * way[1] + z * way[2])


def _as_state(state: State, d: Variation) -> State:
    """A derivative in the place of a state: the maps of integrators are affine in it, and linear here."""
    return replace(state, q=d.q, v=d.v, a=d.a)
