"""Statics along a path of equilibria by arc length, through limit points of the load and of the motion.

The load factor lambda joins the unknowns, and one equation fixes how far a step goes: the plane across
the tangent of the path at its start (Riks 1979). Both are solved on factors of the stiffness alone
(Crisfield 1981): K a = -r, K b = -dr/dlambda, and lambda changes such that a + b dlambda ends on the plane.
Which way is on is told by the last step, never by the sign of a pivot: neither limit points nor bifurcations
turn a path back.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf, isfinite

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from ..kinematics.motion import Since, prescribe
from ..model.state import State
from .assembly import Linearized
from .branches import FINE, branches_passed
from .linear.factors import FactorizationError, Factors
from .load_slope import load_slope
from .newton import solve_stage
from .path_metric import PathMetric, Way
from .problem import ExhaustedError, NewtonSettings, StageProblem, exact
from .result import NewtonResult, done, failed
from .status import Status
from .step import Stepper
from .step_result import StepResult

# A step along which the path turns by more than 30 degrees may have left it.
_STRAIGHT = 0.866
# Newton's steps from the tangent to the path; more mean that it is not near.
_CORRECTIONS = 12
# Change of the load factor, in units of the whole, over which loads are differentiated.
_DIFFERENCE = 1e-6
# Relative to the way of the step, how near to its end a path ends; and how many tries that may take.
_NEAR, _TRIES = 1e-9, 30


@frozen
class Goal:
    """Where a path ends: where a number passes a value.

    Attributes:
        measure: Reads it from a state.
        value: The value.
    """

    measure: Callable[[State], float]
    value: float

    def left(self, state: State) -> float:
        """What it still lacks, with the sign of the way."""
        return self.measure(state) - self.value


@frozen
class PathFollower:
    """Steps of a given length along a path; an :class:`~.step.Advance`.

    Attributes:
        metric: What length is.
        whole: The load factor that counts as one unit.
        goals: Where to end, whichever comes first.
    """

    metric: PathMetric
    whole: float
    goals: tuple[Goal, ...]

    def __call__(self, stepper: Stepper, start: State, dt: float, settings: NewtonSettings) -> StepResult:
        """The step of length ``dt``, or a shorter one to a goal on the way."""
        with np.errstate(all="ignore"):
            return _Step(self, stepper, settings).take(start, dt)


class _Step:
    """One step under way; counts the factorisations of all solves."""

    def __init__(self, path: PathFollower, stepper: Stepper, settings: NewtonSettings) -> None:
        self._path, self._stepper, self._settings = path, stepper, settings
        self._motions = stepper.model.motions
        self._spent = 0

    def take(self, start: State, length: float) -> StepResult:
        result, begun = self._begun(start)
        if result.status is not Status.CONVERGED:
            return _stayed(self._spent, start, result)
        result, end = self._ahead(begun, length)
        if result.status is not Status.CONVERGED:
            return _stayed(self._spent, start, result)
        branches = branches_passed(self._stepper, begun, end)
        if branches is None:
            return _stayed(self._spent, start, replace(result, status=Status.BRANCHED))
        for goal in self._path.goals:
            if goal.left(begun) * goal.left(end) <= 0.0 and goal.left(begun) != 0.0:
                return self._land(begun, goal, (length, result, end), branches)
        return _went(self._spent, result, end, branches)

    def _begun(self, start: State) -> tuple[NewtonResult, State]:
        """The start with the direction of the path there; at first, in balance with what does not wait."""
        problem = self._problem(start, start.law_time)
        if "path" in start.memory:
            return done(problem, start.q, problem.linearize(start.q), indefinite=False), start
        guess = start.q.copy()
        prescribe(self._motions, guess, start.law_time, since_of(start))
        result = solve_stage(problem, guess)
        self._spent += result.iterations
        if result.status is not Status.CONVERGED:
            return result, start
        frames = self._stepper.model.frames.transport(start.frames, result.q).state
        begun = replace(start, q=result.q, frames=frames, load=start.law_time)
        return self._directed(begun, Way(np.zeros_like(start.q), 1.0))

    def _land(
        self,
        start: State,
        goal: Goal,
        ahead: tuple[float, NewtonResult, State],
        branches: FloatArray,
    ) -> StepResult:
        """Where a goal is reached, by the Illinois rule on the length of the step."""
        (high, result, end), low = ahead, 0.0
        below, above = goal.left(start), goal.left(end)
        near = _NEAR * abs(above - below)
        kept = 0
        for _ in range(_TRIES):
            if abs(goal.left(end)) <= near:
                break
            length = (low * above - high * below) / (above - below)
            result, end = self._ahead(start, length)
            if result.status is not Status.CONVERGED:
                return _stayed(self._spent, start, result)
            left = goal.left(end)
            if left * above > 0.0:
                high, above, below, kept = length, left, (0.5 * below if kept == 1 else below), 1
            else:
                low, below, above, kept = length, left, (0.5 * above if kept == -1 else above), -1
        return _went(self._spent, result, end, branches, arrived=True)

    def _ahead(self, start: State, length: float) -> tuple[NewtonResult, State]:
        """The state on the path at some length from a directed start, if the way to it is straight."""
        tangent = direction_at(start)
        result, load = self._correct(start, tangent, length)
        if result.status is not Status.CONVERGED:
            return result, start
        nothing = np.zeros_like(result.q)
        frames = self._stepper.model.frames.transport(start.frames, result.q).state
        t = start.t + length
        end = State(t, result.q, nothing, nothing, frames, start.inputs, start.memory, load)
        way, metric = Way(end.q - start.q, load - start.law_time), self._path.metric
        directed, end = self._directed(end, way)
        if directed.status is not Status.CONVERGED:
            return directed, start
        straight = metric.dot(tangent, way) >= _STRAIGHT * metric.length(way)
        if not straight and length > FINE:
            return replace(result, status=Status.TURNED), start
        return result, end

    def _correct(self, start: State, tangent: Way, length: float) -> tuple[NewtonResult, float]:
        """From a point on the tangent to the path, in the plane across it; the load factor there."""
        metric, free = self._path.metric, self._stepper.system.pattern.free
        q, load = start.q + length * tangent.q, start.law_time + length * tangent.load
        prescribe(self._motions, q, load, since_of(start))
        floor = inf
        for corrections in range(_CORRECTIONS + 1):
            problem = self._problem(start, load)
            now = problem.linearize(q)
            floor = min(floor, problem.system.round_off(now.values, q))
            rhs = -now.residual[free]
            size = problem.size(rhs)
            if not isfinite(floor + sum(size)):
                return failed(problem, q, now, Status.NOT_FINITE), load
            # one step at least: a tangent within the tolerance is not yet the path
            if corrections > 0 and problem.small(size, now, floor):
                return done(problem, q, now, indefinite=False), load
            if corrections == _CORRECTIONS:
                break
            try:
                factors = self._factorize(problem, now)
                slope = self._slope(problem, since_of(start), q, tangent.load, factors)
                balance = np.zeros_like(q)
                balance[free] = factors.solve(rhs)
            except (FactorizationError, ExhaustedError):
                return failed(problem, q, now, Status.FACTORIZATION_FAILED), load
            way = Way(q - start.q, load - start.law_time)
            off = length - metric.dot(tangent, way) - metric.dot(tangent, Way(balance, 0.0))
            change = off / metric.dot(tangent, slope)
            step = balance + change * slope.q
            if not metric.length(Way(step, change)) <= 2.0 * length:
                return failed(problem, q, now, Status.TURNED), load
            part = problem.longest_step(q, step[free])
            q[free] += part * step[free]
            load += part * change
            prescribe(self._motions, q, load, since_of(start))
        return failed(problem, q, now, Status.MAX_ITERATIONS), load

    def _directed(self, state: State, last: Way) -> tuple[NewtonResult, State]:
        """An equilibrium with the unit tangent of the path there, on in the way of the last step."""
        problem = self._problem(state, state.law_time)
        now = problem.linearize(state.q)
        try:
            slope = self._slope(problem, since_of(state), state.q, last.load, self._factorize(problem, now))
        except (FactorizationError, ExhaustedError):
            return failed(problem, state.q, now, Status.FACTORIZATION_FAILED), state
        length = self._path.metric.length(slope)
        if self._path.metric.dot(slope, last) < 0.0:
            length = -length
        memory = {"path": slope.q / length, "path.load": np.array([slope.load / length])}
        return done(problem, state.q, now, indefinite=False), replace(
            state, memory={**state.memory, **memory}
        )

    def _problem(self, start: State, load: float) -> StageProblem:
        stage = replace(self._stepper.integrator.stage(0, start, start, 0.0), t_stage=load, t_end=load)
        return StageProblem(self._stepper.system, stage, start.frames, self._settings)

    def _factorize(self, problem: StageProblem, now: Linearized) -> Factors:
        """Of the tangent as it is: the path is the same on either side of a bifurcation."""
        self._spent += 1
        return exact(problem, problem.stage.predictor, now).updated(now)

    def _slope(
        self, problem: StageProblem, since: Since, q: FloatArray, heading: float, factors: Factors
    ) -> Way:
        change = _DIFFERENCE * self._path.whole * (1.0 if heading >= 0.0 else -1.0)
        return load_slope(problem, self._stepper.predictor, since, q, change, factors)


def _went(
    spent: int, result: NewtonResult, end: State, branches: FloatArray, *, arrived: bool = False
) -> StepResult:
    """A step that came to its end, after so many factorisations."""
    norm, residual = result.residual_norm, result.residual
    end = replace(end, memory={**end.memory, "path.branches": branches})
    return StepResult(end, Status.CONVERGED, spent, norm, residual, -1, arrived=arrived)


def _stayed(spent: int, start: State, result: NewtonResult) -> StepResult:
    """A step that came to none."""
    return StepResult(start, result.status, spent, result.residual_norm, result.residual, result.worst)


def direction_at(state: State) -> Way:
    """The unit tangent that a state on a path remembers."""
    return Way(state.memory["path"], float(state.memory["path.load"][0]))


def since_of(state: State) -> Since:
    """A state as the start of what is driven."""
    return Since(state.law_time, state.q, state.frames)
