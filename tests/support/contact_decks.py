"""Scenes of contact as mappings."""

from __future__ import annotations

from typing import Any

import numpy as np

MASS = 509.2985 * np.pi * 0.025**2


def on_floor(force: float = 0.0, **changes: Any) -> dict[str, Any]:
    """The rod of a kilogram that lies on a floor of 10 kPa and is pulled along it."""
    deck: dict[str, Any] = {
        "schema_version": 1,
        "name": "floor",
        "dimension": 2,
        "materials": {"m": {"youngs_modulus": 1e5, "poisson_ratio": 0.5, "density": 509.2985}},
        "geometry": [
            {
                "type": "rod",
                "name": "rod",
                "material": "m",
                "radius": 0.025,
                "generate": {
                    "shape": "line",
                    "from": [0.0, 0.0, 0.02451],
                    "to": [1.0, 0.0, 0.02451],
                    "nodes": 9,
                },
            }
        ],
        "obstacles": [{"name": "floor", "type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}],
        "contact": {
            "pairs": [{"between": ["rod", "floor"]}],
            "law": {"stiffness": 1e4},
            "friction": {"coefficient": 0.4, "slip_speed": 1e-3},
        },
        "forces": [
            {"type": "gravity", "acceleration": [0, 0, -9.8]},
            {"type": "distributed", "force_per_length": [force, 0, 0]},
        ],
        "numerics": {"dt": 5e-3, "t_end": 1.0},
        "output": {"every": 0.1},
    }
    return deck | changes


def crossing(dt: float, speed: float, **law: float) -> dict[str, Any]:
    def rod(name: str, start: list[float], end: list[float]) -> dict[str, Any]:
        return {
            "type": "rod",
            "name": name,
            "material": "m",
            "radius": 0.002,
            "generate": {"shape": "line", "from": start, "to": end, "nodes": 6},
        }

    return {
        "schema_version": 1,
        "name": "crossing",
        "materials": {"m": {"youngs_modulus": 1e7, "poisson_ratio": 0.5, "density": 1000.0}},
        "geometry": [
            rod("low", [-0.25, 0.0, 0.0], [0.25, 0.0, 0.0]),
            rod("high", [0.0, -0.25, 0.05], [0.0, 0.25, 0.05]),
        ],
        "contact": {"law": law},
        "initial_velocity": [{"where": "high", "velocity": [0.0, 0.0, -speed]}],
        "numerics": {"dt": dt, "t_end": max(0.1 / speed, 4 * dt)},
        "output": {
            "every": dt,
            "probes": {
                "low": {"position": {"nodes": {"of": "low", "indices": [2, 3]}}, "component": "z"},
                "high": {"position": {"nodes": {"of": "high", "indices": [2, 3]}}, "component": "z"},
            },
        },
    }
