"""Rods that hit a floor with their ends: what the prediction misjudges is put right in the step."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import dismech_cli

LEAN = 0.1


def falling(integrator: dict[str, Any], dt: float) -> dict[str, Any]:
    """A rod that leans, skids and lands on its lower end: the wave in it is heavier than an edge."""
    end = [0.1 * np.sin(LEAN), 0.0, 0.1 * np.cos(LEAN)]
    return {
        "schema_version": 1,
        "name": "upright",
        "materials": {"m": {"youngs_modulus": 3e6, "poisson_ratio": 0.5, "density": 1180.0}},
        "geometry": [
            {
                "type": "rod",
                "name": "rod",
                "material": "m",
                "radius": 5e-3,
                "generate": {"shape": "line", "from": [0.0, 0.0, 0.0], "to": end, "nodes": 25},
            }
        ],
        "obstacles": [{"name": "floor", "type": "plane", "point": [0, 0, -0.007], "normal": [0, 0, 1]}],
        "contact": {"law": {"tolerance": 0.05}, "friction": {"coefficient": 0.4, "slip_speed": 5e-3}},
        "initial_velocity": [{"where": "rod", "velocity": [0.14, 0.0, -1.35]}],
        "numerics": {"integrator": integrator, "dt": dt, "t_end": 0.03},
        "output": {"every": dt, "probes": {"low": {"position": "rod.start", "component": "z"}}},
    }


@pytest.mark.parametrize(
    ("integrator", "dt"),
    [({"type": "implicit_euler"}, 2.5e-3), ({"type": "generalized_alpha", "spectral_radius": 0}, 1e-3)],
)
def test_an_end_that_lands_and_skids_stays_within_the_tolerance(
    integrator: dict[str, Any], dt: float
) -> None:
    report = dismech_cli.simulate(falling(integrator, dt))
    assert report.exit == 0
    assert report.warnings == ()
    # the surface of the end, in frames that no rule of stiffness has a part in
    depth = -(report.scalars["low"] + 0.007 - 5e-3).min() / 10e-3
    assert 0.0 < depth <= 0.05
