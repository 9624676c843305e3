"""Time integrators as tables of affine maps: the only file where dt meets the physics.

Every stage solves M a_s + r(q_s, v_s, t_s) = 0 for the unknown q = q_end of that stage, where
q_s, v_s and a_s are affine in q. Static equilibrium is the integrator whose inertia is zero.
Formulas: Newmark 1959; Chung & Hulbert 1993 (generalised-alpha); Bank et al. 1985 and
Hosea & Shampine 1996 (TR-BDF2). What a step estimates of its own error is the leading term of the
positions' local error, from velocities and accelerations that it has anyway.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Protocol

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from ..model.state import State
from .stage import Stage, Weights


class Integrator(Protocol):
    """A sequence of stages that takes a state from t to t + dt."""

    @property
    def name(self) -> str:
        """Name in the scenario language."""

    @property
    def order(self) -> int:
        """Order of accuracy; a test holds it to its word."""

    @property
    def stages(self) -> int:
        """Nonlinear solves per step."""

    @property
    def needs_acceleration(self) -> bool:
        """Whether the start needs an acceleration consistent with the balance of forces."""

    @property
    def damping(self) -> int:
        """Rank by how much fast modes are damped; 0: not, or not by default."""

    @property
    def error_order(self) -> int:
        """Power of dt with which the error of one step falls; a test holds it to its word."""

    def error(self, trail: Sequence[State], dt: float) -> FloatArray:
        """Estimated error of the positions and angles of a step, shape (n,).

        Args:
            trail: State at the start of the step, and at the end of each stage.
            dt: Step [s].
        """

    def stage(self, index: int, start: State, latest: State, dt: float) -> Stage:
        """Maps of one stage.

        Args:
            index: 0 .. stages - 1.
            start: State at the start of the step.
            latest: Result of the previous stage; ``start`` for the first.
            dt: Step [s].
        """


def _between(end: FloatArray, start: FloatArray, alpha: float) -> FloatArray:
    """A value before the end of a step by a share of it: most integrators are not, at half the cost."""
    return (1.0 - alpha) * end + alpha * start if alpha else end


def _newmark_stage(s: State, dt: float, beta: float, gamma: float, alpha_f: float, alpha_m: float) -> Stage:
    """Newmark maps with balance at t + (1 - alpha_f) dt, as generalised-alpha needs them."""
    av = 1.0 / (beta * dt * dt)
    ahead = s.q + dt * s.v
    a_const = -av * ahead - (0.5 / beta - 1.0) * s.a
    v_slope = gamma * dt * av
    v_const = s.v + dt * ((1.0 - gamma) * s.a + gamma * a_const)
    f, m = 1.0 - alpha_f, 1.0 - alpha_m
    return Stage(
        t_stage=s.t + f * dt,
        t_end=s.t + dt,
        predictor=ahead + 0.5 * dt * dt * s.a,
        weights=Weights(q=f, v=f * v_slope, a=m * av),
        q0=alpha_f * s.q,
        v0=_between(v_const, s.v, alpha_f),
        a0=_between(a_const, s.a, alpha_m),
        v_end=(v_slope, v_const),
        a_end=(av, a_const),
        inputs=s.inputs,
    )


def _jump(trail: Sequence[State], weight: float) -> FloatArray:
    """A weight times the change of the accelerations over a step, shape (n,)."""
    change: FloatArray = weight * (trail[-1].a - trail[0].a)
    return change


@frozen
class ImplicitEuler:
    """First order, strongly damping; for quasi-static motion and first trials."""

    name: ClassVar[str] = "implicit_euler"
    order: ClassVar[int] = 1
    stages: ClassVar[int] = 1
    needs_acceleration: ClassVar[bool] = False
    damping: ClassVar[int] = 3
    error_order: ClassVar[int] = 2

    def error(self, trail: Sequence[State], dt: float) -> FloatArray:
        """dt^2/2 times the acceleration."""
        change: FloatArray = 0.5 * dt * (trail[-1].v - trail[0].v)
        return change

    def stage(self, index: int, start: State, latest: State, dt: float) -> Stage:
        """V = (q - q_n)/dt, a = (v - v_n)/dt."""
        v_const = -start.q / dt
        a_const = (v_const - start.v) / dt
        return Stage(
            t_stage=start.t + dt,
            t_end=start.t + dt,
            predictor=start.q + dt * start.v,
            weights=Weights(q=1.0, v=1.0 / dt, a=1.0 / dt**2),
            q0=np.zeros_like(start.q),
            v0=v_const,
            a0=a_const,
            v_end=(1.0 / dt, v_const),
            a_end=(1.0 / dt**2, a_const),
            inputs=start.inputs,
            lead=dt * dt * start.a,
        )


@frozen
class ImplicitMidpoint:
    """Second order, conserves quadratic invariants; stiff axial forces ring."""

    name: ClassVar[str] = "implicit_midpoint"
    order: ClassVar[int] = 2
    stages: ClassVar[int] = 1
    needs_acceleration: ClassVar[bool] = False
    damping: ClassVar[int] = 0
    error_order: ClassVar[int] = 3

    def error(self, trail: Sequence[State], dt: float) -> FloatArray:
        """dt^3/12 times the jerk, from the middle of the last step to that of this one."""
        return _jump(trail, dt * dt / 12.0)

    def stage(self, index: int, start: State, latest: State, dt: float) -> Stage:
        """Balance at (q + q_n)/2 with v = (q - q_n)/dt."""
        v_const = -start.q / dt
        a_const = 2.0 * (v_const - start.v) / dt
        return Stage(
            t_stage=start.t + 0.5 * dt,
            t_end=start.t + dt,
            predictor=start.q + dt * start.v + 0.5 * dt * dt * start.a,
            weights=Weights(q=0.5, v=1.0 / dt, a=2.0 / dt**2),
            q0=0.5 * start.q,
            v0=v_const,
            a0=a_const,
            v_end=(2.0 / dt, 2.0 * v_const - start.v),
            a_end=(2.0 / dt**2, a_const),
            inputs=start.inputs,
        )


@frozen
class Newmark:
    """Newmark's method; (1/4, 1/2) is the trapezoidal rule."""

    beta: float = 0.25
    gamma: float = 0.5
    name: ClassVar[str] = "newmark"
    stages: ClassVar[int] = 1
    needs_acceleration: ClassVar[bool] = True
    damping: ClassVar[int] = 0

    @property
    def order(self) -> int:
        """Second order only for gamma = 1/2."""
        return 2 if self.gamma == 0.5 else 1

    @property
    def error_order(self) -> int:
        """Of the positions, whatever the order of the velocities."""
        return 3

    def error(self, trail: Sequence[State], dt: float) -> FloatArray:
        """(beta - 1/6) dt^3 times the jerk, at least that of the trapezoidal rule, and what v adds.

        With beta = 1/6 the error of v is all there is; with gamma > 1/2 it makes one of q a step later.
        """
        return _jump(trail, (max(abs(self.beta - 1.0 / 6.0), 1.0 / 12.0) + self.gamma - 0.5) * dt * dt)

    def stage(self, index: int, start: State, latest: State, dt: float) -> Stage:
        """Balance at t + dt."""
        return _newmark_stage(start, dt, self.beta, self.gamma, 0.0, 0.0)


@frozen
class GeneralizedAlpha:
    """Second order with a chosen damping of the highest frequencies (Chung & Hulbert 1993)."""

    spectral_radius: float = 0.8
    name: ClassVar[str] = "generalized_alpha"
    order: ClassVar[int] = 2
    stages: ClassVar[int] = 1
    needs_acceleration: ClassVar[bool] = True
    damping: ClassVar[int] = 1
    error_order: ClassVar[int] = 3

    def error(self, trail: Sequence[State], dt: float) -> FloatArray:
        """(beta - 1/6 - lag/2) dt^3 times the jerk: accelerations lag by alpha_f - alpha_m steps."""
        alpha_m, alpha_f, beta, _ = self._weights()
        return _jump(trail, (beta - 1.0 / 6.0 - 0.5 * (alpha_f - alpha_m)) * dt * dt)

    def _weights(self) -> tuple[float, float, float, float]:
        rho = self.spectral_radius
        alpha_m = (2.0 * rho - 1.0) / (rho + 1.0)
        alpha_f = rho / (rho + 1.0)
        gamma = 0.5 - alpha_m + alpha_f
        beta = 0.25 * (1.0 - alpha_m + alpha_f) ** 2
        return alpha_m, alpha_f, beta, gamma

    def stage(self, index: int, start: State, latest: State, dt: float) -> Stage:
        """Newmark maps, balance between the ends of the step."""
        alpha_m, alpha_f, beta, gamma = self._weights()
        return _newmark_stage(start, dt, beta, gamma, alpha_f, alpha_m)


@frozen
class TrBdf2:
    """Second order and L-stable: a trapezoidal stage, then a BDF2 stage."""

    name: ClassVar[str] = "tr_bdf2"
    order: ClassVar[int] = 2
    stages: ClassVar[int] = 2
    needs_acceleration: ClassVar[bool] = True
    damping: ClassVar[int] = 2
    error_order: ClassVar[int] = 3
    fraction: ClassVar[float] = 2.0 - 2.0**0.5

    def error(self, trail: Sequence[State], dt: float) -> FloatArray:
        """What the embedded formula of third order would add (Hosea & Shampine 1996)."""
        start, middle, end = trail
        w = 0.25 * 2.0**0.5
        early, late = w - (1.0 - w) / 3.0, w - (3.0 * w + 1.0) / 3.0
        error: FloatArray = dt * (early * start.v + late * middle.v + self.fraction / 3.0 * end.v)
        return error

    def stage(self, index: int, start: State, latest: State, dt: float) -> Stage:
        """Trapezoidal rule over the first 0.586 dt, BDF2 over the whole."""
        return (self._trapezoid, self._bdf2)[index](start, latest, dt)

    def _trapezoid(self, start: State, latest: State, dt: float) -> Stage:
        return _newmark_stage(start, self.fraction * dt, 0.25, 0.5, 0.0, 0.0)

    def _bdf2(self, start: State, latest: State, dt: float) -> Stage:
        g = self.fraction
        c1 = 1.0 / (g * (2.0 - g))
        c2 = (1.0 - g) ** 2 / (g * (2.0 - g))
        c3 = (1.0 - g) / (2.0 - g) * dt
        v_const = (c2 * start.q - c1 * latest.q) / c3
        a_const = (v_const - c1 * latest.v + c2 * start.v) / c3
        rest = (1.0 - g) * dt
        return Stage(
            t_stage=start.t + dt,
            t_end=start.t + dt,
            predictor=latest.q + rest * latest.v + 0.5 * rest * rest * latest.a,
            weights=Weights(q=1.0, v=1.0 / c3, a=1.0 / c3**2),
            q0=np.zeros_like(start.q),
            v0=v_const,
            a0=a_const,
            v_end=(1.0 / c3, v_const),
            a_end=(1.0 / c3**2, a_const),
            inputs=start.inputs,
        )


@frozen
class Static:
    """Equilibrium at each load level: no inertia, no velocity; t is the load parameter."""

    name: ClassVar[str] = "static"
    order: ClassVar[int] = 0
    stages: ClassVar[int] = 1
    needs_acceleration: ClassVar[bool] = False
    damping: ClassVar[int] = 0
    error_order: ClassVar[int] = 0

    def error(self, trail: Sequence[State], dt: float) -> FloatArray:
        """None: every equilibrium is one."""
        return np.zeros_like(trail[0].q)

    def stage(self, index: int, start: State, latest: State, dt: float) -> Stage:
        """Balance of forces at t + dt, from the last equilibrium."""
        zero = np.zeros_like(start.q)
        return Stage(
            t_stage=start.law_time + dt,
            t_end=start.law_time + dt,
            predictor=start.q,
            weights=Weights(q=1.0, v=0.0, a=0.0),
            q0=zero,
            v0=zero,
            a0=zero,
            v_end=(0.0, zero),
            a_end=(0.0, zero),
            inputs=start.inputs,
        )


INTEGRATORS: tuple[Integrator, ...] = (
    Static(),
    ImplicitEuler(),
    ImplicitMidpoint(),
    Newmark(),
    GeneralizedAlpha(),
    TrBdf2(),
)
"""One of each, with its defaults."""
