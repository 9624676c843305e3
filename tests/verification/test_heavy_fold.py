"""A long heavy strip folded onto itself on a floor without friction: where it lifts off and comes down.

Between these places it is an elastica under its own weight, of zero curvature at both ends and without
horizontal force. Lengths are in units of l = (EI / w)^(1/3); expected is the solution of that boundary value
problem, for a strip without thickness.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dismech_cli import simulate
from dismech_cli.arrays import FloatArray

L, RADIUS, RHO, G = 0.1, 0.5e-3, 1000.0, 9.81
HEIGHT, OVERHANG, LENGTH, LANDING, CURVATURE = 0.906597, 0.757251, 4.683470, 2.484620, 2.53374
TAIL, EDGE = 1.5 * L, L / 40.0


def start() -> FloatArray:
    """A fold of another shape: along the floor, half a circle, and a slow way down onto what lies there."""
    low, high, radius = RADIUS, 3.0 * RADIUS, 0.45 * L
    turn, x = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 200), np.linspace(0.2 * L, -2.48 * L, 400)
    down = high + (low + 2.0 * radius - high) * 0.5 * (1.0 + np.cos(np.pi * (0.2 * L - x) / (2.68 * L)))
    parts = (
        [(-2.48 * L - TAIL, low)],
        np.column_stack((0.2 * L + radius * np.cos(turn), low + radius * (1.0 + np.sin(turn)))),
        np.column_stack((x, down)),
        [(-2.48 * L - TAIL, high)],
    )
    points = np.concatenate(parts)
    s = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    at = np.linspace(0.0, s[-1], round(s[-1] / EDGE) + 1)
    return np.column_stack((np.interp(at, s, points[:, 0]), 0.0 * at, np.interp(at, s, points[:, 1])))


def deck() -> dict[str, Any]:
    points = start()
    modulus = 4.0 * RHO * G * L**3 / RADIUS**2
    return {
        "schema_version": 1,
        "name": "heavy_fold",
        "dimension": 2,
        "materials": {"m": {"youngs_modulus": modulus, "poisson_ratio": 0.3, "density": RHO}},
        "geometry": [
            {
                "type": "rod",
                "name": "strip",
                "material": "m",
                "radius": RADIUS,
                "generate": {"shape": "polyline", "points": points.tolist(), "nodes": len(points)},
                "natural": {"curvature_1": 0.0},
            }
        ],
        "obstacles": [{"name": "floor", "type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}],
        "contact": {},
        "motions": [{"type": "clamp", "where": "strip.start"}],
        "forces": [
            {"type": "gravity", "acceleration": [0, 0, -G]},
            {"type": "viscous", "coefficient": 0.02},
        ],
        "numerics": {"integrator": {"type": "implicit_euler"}, "dt": 2e-3, "t_end": 0.6},
        "output": {
            "every": 0.1,
            "fields": ["contact_force"],
            "probes": {"pull": {"reaction": "strip.start", "component": "x"}},
        },
    }


def zero(s: FloatArray, curvature: FloatArray) -> float:
    """Where a parabola through curvatures vanishes, before or behind them."""
    roots = np.roots(np.polyfit(s, curvature, 2))
    return float(roots[np.abs(roots - s.mean()).argmin()].real)


@pytest.mark.slow
def test_a_heavy_fold() -> None:
    report = simulate(deck())
    assert report.exit == 0
    frame = report.frames[-1]
    x, z, force = frame.positions[:, 0], frame.positions[:, 2], frame.fields["contact_force"][:, 2]
    edges = np.diff(np.column_stack((x, z)), axis=0)
    lengths = np.hypot(*edges.T)
    angles = np.unwrap(np.arctan2(edges[:, 1], edges[:, 0]))
    s = np.append(0.0, np.cumsum(lengths))
    curvature = np.append(0.0, np.diff(angles) / (0.5 * (lengths[1:] + lengths[:-1])))
    # what floor and fold press is spread over a few edges, about where the curvature of the free part ends
    last = int(np.flatnonzero(force[: x.argmax()] > 0.0)[-1])
    first = int(z.argmax() + np.flatnonzero(force[z.argmax() :] > 0.0)[0])
    rise, fall = slice(last + 2, last + 14), slice(first - 14, first - 2)
    off, on = zero(s[rise], curvature[rise]), zero(s[fall], curvature[fall])
    x_off, x_on = np.interp([off, on], s, x)
    # the strip is a hundredth of l thick: that moves what it lands on
    assert_allclose((z.max() - RADIUS) / L, HEIGHT, rtol=0.01)
    assert_allclose((x.max() - x_off) / L, OVERHANG, rtol=0.01)
    assert_allclose((on - off) / L, LENGTH, rtol=0.01)
    assert_allclose((x_off - x_on) / L, LANDING, rtol=0.01)
    assert_allclose(curvature.max() * L, CURVATURE, rtol=0.01)
    assert abs(report.scalars["pull"][-1]) < 0.01 * RHO * np.pi * RADIUS**2 * G * L
    assert report.outcome.state.memory["contact.worst"][0] <= 0.05
