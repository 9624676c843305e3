"""What an integrator makes of a linear oscillator: how much of its swing a step keeps, how fast it is."""

from __future__ import annotations

import numpy as np

from ..frozen import frozen
from ..kinematics.rod_frames import NoFrames
from ..model.state import State
from .integrators import Integrator


@frozen
class Response:
    """One step of an oscillator.

    Attributes:
        kept: Share of the amplitude that is left.
        turned: Angle that it turns by [rad].
    """

    kept: float
    turned: float


def respond(integrator: Integrator, angle: float) -> Response:
    """What is left of a free oscillation after a step.

    The largest eigenvalue of the amplification matrix of q'' = -angle^2 q for a step of 1, on position,
    velocity and acceleration.

    Args:
        integrator: Of a run in time.
        angle: Angular frequency times step [rad].
    """
    columns = [_step(integrator, angle, *unit) for unit in np.eye(3)]
    values = np.linalg.eigvals(np.array(columns).T)
    largest = values[np.argmax(np.abs(values))]
    return Response(float(np.abs(largest)), float(np.abs(np.angle(largest))))


def _step(integrator: Integrator, angle: float, q: float, v: float, a: float) -> tuple[float, float, float]:
    """Position, velocity and acceleration a step later."""
    start = _state(0.0, q, v, a)
    latest = start
    for index in range(integrator.stages):
        stage = integrator.stage(index, start, latest, 1.0)
        weights, squared = stage.weights, angle * angle
        solution = -(stage.a0 + squared * stage.q0) / (weights.a + squared * weights.q)
        speed, acceleration = stage.finish(solution)
        latest = _state(stage.t_end, float(solution[0]), float(speed[0]), float(acceleration[0]))
    return float(latest.q[0]), float(latest.v[0]), float(latest.a[0])


def _state(t: float, q: float, v: float, a: float) -> State:
    place = np.array([q])
    return State(t, place, np.array([v]), np.array([a]), NoFrames().rest(place))
