"""A model with what its balance changes by along the stages that a run has solved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..frozen import frozen
from ..kernels.driver import Driver
from ..kinematics.motion import Since, held_dofs, held_span, prescribe
from ..kinematics.turning import Holonomy
from ..model.configuration import Configuration
from ..model.model import Model
from ..model.state import State
from .accelerations import EULER
from .anew import met
from .commanded import Commanded
from .integrators import Integrator
from .maps import maps_of
from .neighbours import Here, Neighbours, ParameterSlope, Variation
from .slopes import Balance, Slope, SlopeRows
from .solved import Solved
from .sweep import Sides, turned_by, weighed_by
from .tape import TapedStep

# Stages that are gone through together take so many bytes, which stay near the processor.
_ROOM: Final = 1 << 21


@frozen
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


@frozen
class Passage:
    """C stages that were solved, with what their balances change by; good until the next is asked for.

    Attributes:
        held: What is held.
        solved: The stages.
        points: Their solutions as trial points.
        slopes: Of their balances there.
        given: Derivatives of M a + r at fixed states, shape (C, n, P).
        to_trial: How frames turn on the ways to these points.
        to_end: And to the ends of the stages.
    """

    held: Held
    solved: Solved
    points: Sequence[Configuration]
    slopes: SlopeRows
    given: FloatArray
    to_trial: tuple[Holonomy, ...]
    to_end: tuple[Holonomy, ...]

    @property
    def sides(self) -> Sides:
        """The same for sweeps."""
        held, slopes = self.held, self.slopes
        return Sides(
            self.solved.maps,
            slopes.stiffness,
            slopes.damping,
            self.given,
            held.dofs,
            held.led,
            self.to_trial,
            self.to_end,
        )

    def since(self, k: int) -> Since:
        """What a stage starts from."""
        before = self.solved.before[k]
        return Since(before.t, before.q, before.frames)

    def span(self, k: int) -> float:
        """Length of a stage [s]."""
        return self.solved.ends[k].t - self.solved.before[k].t


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

    def rubbed(self, step: TapedStep) -> Solved:
        """The step of Euler's method that it was made by, see :func:`.accelerations.rubbed`."""
        start, dt = step.start, step.dt
        q, t = start.q + dt * (start.v + dt * start.a), start.t + dt
        prescribe(self.model.motions, q, t, Since(start.t, start.q, start.frames))
        return Solved.of(maps_of(EULER, dt), [(start, replace(start, t=t, q=q))])

    def legs(self, steps: Sequence[TapedStep], most: int) -> list[Sequence[TapedStep]]:
        """Steps that are gone through together, as many at a time as there is room for, or ``most``."""
        n, count = self.model.dofs.n, len(self.parameters)
        room = _ROOM // (self._slope.bytes + 32 * n * (count + 1)) // self.integrator.stages
        most = max(min(most, room), 1)
        legs, first = [], 0
        for k in range(1, len(steps)):
            if k - first == most or not self._goes_on(steps[first], steps[k]):
                legs.append(steps[first:k])
                first = k
        return [*legs, steps[first:]] if steps else []

    def _goes_on(self, first: TapedStep, step: TapedStep) -> bool:
        """Whether a step is of the length of another, under the same holds, and no acceleration is made."""
        held = self.held(first.start.t) is self.held(step.start.t)
        return first.dt == step.dt and held and not self.jumps(step.start)

    def passage(self, held: Held, solved: Solved) -> Passage:
        """Stages that were solved, with what their balances change by."""
        to_trial = self._holonomies(solved, np.ascontiguousarray(solved.points[:, 0]))
        to_end = to_trial
        if to_trial and not solved.maps.at_ends:
            to_end = self._holonomies(solved, np.array([end.q for end in solved.ends]))
        points = [self._trial(solved, k) for k in range(solved.count)]
        slopes = self._slope.at(points, to_trial)
        given = self._weighed(slopes.residuals, self._shares, self._mass, solved.points[:, 2])
        if self._others:
            for k, c in enumerate(points):
                here = Here(c, self._slope.terms)
                for p, one in self._others:
                    if (more := one.of_others(here)) is not None:
                        given[k, :, p] += more
        return Passage(held, solved, points, slopes, given, to_trial, to_end)

    def _trial(self, solved: Solved, k: int) -> Configuration:
        """The solution of a stage as a trial point."""
        (q, v, _), before = solved.points[k], solved.before[k]
        frames = self.model.frames.transport(before.frames, q)
        return Configuration(solved.times[k], q, v, frames, before.inputs)

    def _holonomies(self, solved: Solved, q: FloatArray) -> tuple[Holonomy, ...]:
        """How frames turn from the starts of stages to shapes (C, n)."""
        if not self.edges:
            return ()
        starts = np.array([before.q for before in solved.before])
        return tuple(self._turned(edges, starts, q) for edges in self.edges)

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
