"""Small scenes with controllers."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
from decks import Deck

from dismech_cli import Report, load, simulate
from dismech_cli.arrays import FloatArray
from dismech_cli.compose.compose import Composition, compose
from dismech_cli.run.loop import End
from dismech_cli.scenario.load import LoadedScenario, load_mapping

SCENARIOS = Path(__file__).parents[2] / "scenarios"


def s_shape(name: str = "s_shape", *overrides: str) -> LoadedScenario:
    """The scene of an arm in an S, sampled or ideal."""
    return load(SCENARIOS / f"{name}.yaml", overrides=overrides)


def finished(loaded: LoadedScenario) -> Report:
    """Run to the end."""
    report = simulate(loaded)
    assert report.outcome.end is End.DONE, report.message
    return report


def rmse(report: Report, *times: float) -> list[float]:
    """Root mean square over all coordinates of the nodes [m], as others count it, at some times."""
    off = report.probes["off"] / np.sqrt(3.0)
    return [float(np.interp(t, report.scalars["t"], off)) for t in times]


ARM: Deck = {
    "schema_version": 1,
    "name": "arm",
    "dimension": 2,
    "materials": {"m": {"youngs_modulus": 1e5, "poisson_ratio": 0.5, "density": 1000}},
    "geometry": [
        {
            "type": "rod",
            "name": "arm",
            "material": "m",
            "radius": 5e-3,
            "generate": {"shape": "line", "from": [0, 0, 0], "to": [0.1, 0, 0], "nodes": 6},
        }
    ],
    "motions": [{"type": "clamp", "where": "arm.start"}],
    "forces": [{"type": "viscous", "coefficient": 200}],
    "actuation": [{"type": "curvature_1", "rod": "arm", "value": {"controlled_by": "bend"}}],
    "controllers": {
        "bend": {"type": "pi", "target": 5.0, "gains": {"p": 3, "i": 20}, "period": 0.02},
    },
    "numerics": {"integrator": {"type": "implicit_euler"}, "dt": 0.01, "t_end": 0.4},
    "output": {
        "every": 0.02,
        "probes": {
            "error": {"controller": "bend", "measure": "error"},
            "command": {"controller": "bend", "measure": "command"},
            "balance": {"energy": "error"},
        },
    },
}
"""A clamped arm in fluid that is to bend evenly."""


def arm(**keys: Any) -> Deck:
    """The arm with other keys; those under ``bend`` are merged into its controller."""
    deck = copy.deepcopy(ARM)
    deck["controllers"]["bend"].update(keys.pop("bend", {}))
    for key, value in keys.items():
        deck[key] = {**deck[key], **value} if isinstance(deck.get(key), dict) else value
    return deck


def ideal(gains: Deck, target: Any = 5.0, **keys: Any) -> Deck:
    """The arm under ideal feedback."""
    deck = arm(**keys)
    deck["controllers"]["bend"] = {"type": "pi", "feedback": "ideal", "target": target, "gains": gains}
    return deck


def composed(deck: Deck, directory: str | Path = ".") -> Composition:
    """Compose a deck."""
    return compose(load_mapping(deck, directory=directory))


def positions(report: Report) -> FloatArray:
    """Positions in all frames, shape (F, N, 3)."""
    return np.stack([frame.positions for frame in report.frames])
