"""What one nonlinear solve is of: positions, velocities and accelerations that are affine in its unknown."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..model.state import State


@frozen
class Weights:
    """Slopes of the stage maps: the tangent is a M + v C + q K."""

    q: float
    v: float
    a: float


@frozen
class Stage:
    """One nonlinear solve.

    Attributes:
        t_stage: Time [s] where balance is enforced.
        t_end: Time [s] of the unknown q.
        predictor: First guess of q, shape (n,).
        weights: Slopes of the stage maps.
        q0: Constant part of q_s, shape (n,); likewise ``v0`` and ``a0``.
        v0: See ``q0``.
        a0: See ``q0``.
        v_end: (slope, constant) of the velocity at t_end.
        a_end: (slope, constant) of the acceleration at t_end.
        inputs: What controllers put in during the step, shape (K,).
        lead: What the first guess goes on by if the last accelerations last, shape (n,); None where it does
            already, or nothing accelerates.
    """

    t_stage: float
    t_end: float
    predictor: FloatArray
    weights: Weights
    q0: FloatArray
    v0: FloatArray
    a0: FloatArray
    v_end: tuple[float, FloatArray]
    a_end: tuple[float, FloatArray]
    inputs: FloatArray
    lead: FloatArray | None = None

    @property
    def balanced_end(self) -> bool:
        """Whether balance is enforced where the stage ends."""
        return self.t_stage == self.t_end and self.weights.q == 1.0

    def position(self, q: FloatArray) -> FloatArray:
        """q_s(q)."""
        return self.weights.q * q + self.q0

    def velocity(self, q: FloatArray) -> FloatArray:
        """v_s(q)."""
        return self.weights.v * q + self.v0

    def acceleration(self, q: FloatArray) -> FloatArray:
        """a_s(q)."""
        return self.weights.a * q + self.a0

    def acceleration_of(self, q: FloatArray, dofs: IntArray) -> FloatArray:
        """The same of some DOFs, shape (K,)."""
        some: FloatArray = self.weights.a * q[dofs] + self.a0[dofs]
        return some

    def finish(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Velocity and acceleration at t_end."""
        return self.v_end[0] * q + self.v_end[1], self.a_end[0] * q + self.a_end[1]

    def mean_velocity(self, before: State, q: FloatArray, dofs: IntArray) -> FloatArray:
        """Difference quotient of some DOFs from a state before the stage to its end, shape (K,)."""
        mean: FloatArray = (q[dofs] - before.q[dofs]) / (self.t_end - before.t)
        return mean


def at_state(state: State) -> Stage:
    """Balance of forces at a state, as it moves: a stage of no duration and no inertia."""
    zero = np.zeros_like(state.q)
    return Stage(
        t_stage=state.law_time,
        t_end=state.law_time,
        predictor=state.q,
        weights=Weights(q=1.0, v=0.0, a=0.0),
        q0=zero,
        v0=state.v,
        a0=zero,
        v_end=(0.0, zero),
        a_end=(0.0, zero),
        inputs=state.inputs,
    )


def mean_acceleration(start: State, end: State, dt: float, dofs: IntArray) -> FloatArray:
    """Difference quotient of the velocities of some DOFs over a step, shape (K,)."""
    mean: FloatArray = (end.v[dofs] - start.v[dofs]) / dt
    return mean
