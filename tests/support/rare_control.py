"""Scenes for what controllers and sensors have that no shipped scenario uses."""

from __future__ import annotations

from typing import Any

import numpy as np
from decks import Deck, line, rod_deck
from numpy.testing import assert_array_equal

SHORT: Deck = {"integrator": {"type": "implicit_euler"}, "dt": 0.01, "t_end": 0.02}
_BEND: Deck = {"type": "curvature_1", "rod": "rod", "value": {"controlled_by": "bend"}}
_STEP: Deck = {"period": 0.01, "hold": "step"}

SENSORS: Deck = rod_deck(
    line(4),
    dimension=3,
    geometry=[
        {"type": "rod", "name": "rod", "material": "m", "radius": 0.01, "generate": line(4)},
        {
            "type": "shell",
            "name": "sheet",
            "material": "m",
            "thickness": 0.01,
            "generate": {
                "shape": "sheet",
                "origin": [0, 1, 0],
                "length": 0.3,
                "width": 0.2,
                "divisions": 3,
                "pattern": "alternating",
            },
        },
    ],
    forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -9.81]}],
    sensors={
        "stretch": {"strain": "stretch", "rod": "rod"},
        "one": {"strain": "curvature_1", "rod": "rod"},
        "two": {"strain": "curvature_2", "rod": "rod"},
        "twist": {"strain": "twist", "rod": "rod"},
        "dihedral": {"strain": "dihedral", "shell": "sheet"},
        "surface": {"strain": "surface_curvature", "shell": "sheet", "along": [1, 0, 0]},
    },
    actuation=[
        {"type": "twist", "rod": "rod", "value": {"controlled_by": "turn"}},
        {"type": "dihedral", "shell": "sheet", "value": {"controlled_by": "fold"}},
        {
            "type": "surface_curvature",
            "shell": "sheet",
            "along": [1, 0, 0],
            "value": {"controlled_by": "curl"},
        },
    ],
    controllers={
        "turn": {"type": "pi", "target": 0.0, "gains": {"p": 0.1}, "period": 0.01},
        "fold": {"type": "pi", "target": 0.0, "gains": {"p": 0.1}, "period": 0.01},
        "curl": {"type": "pi", "target": 0.0, "gains": {"p": 0.1}, "period": 0.01},
    },
    output={
        "probes": {
            f"{sensor}_{measure}": {"sensor": sensor, "measure": measure}
            for sensor in ("stretch", "one", "two", "twist", "dihedral", "surface")
            for measure in ("mean", "rms", "max", "min")
        }
    },
    numerics=SHORT,
)
"""Every sensor of a strain, read every way, and loops around those that no shipped scenario closes."""


def reads_all(loaded: Any, result: Any) -> None:
    """The least is below the mean, the mean below the most, and below the root of the mean square."""
    for name in loaded.scenario.sensors:
        mean, rms, most, least = (
            result.probes[f"{name}_{measure}"][-1] for measure in ("mean", "rms", "max", "min")
        )
        assert least <= mean <= most
        assert abs(mean) <= rms * (1.0 + 1e-12)
    # the rod bends about one axis alone, and not at all about itself
    assert max(abs(result.probes[f"{name}_rms"][-1]) for name in ("one", "two")) > 0.0
    assert abs(result.probes["twist_rms"][-1]) < 1e-9


INCREMENTAL: Deck = rod_deck(
    line(4),
    actuation=[_BEND],
    controllers={"bend": {"type": "incremental", "target": 1.0, "gains": {"p": 0.1}, **_STEP}},
    output={"every": 0.01, "probes": {"bend": {"controller": "bend", "measure": "reading"}}},
    numerics=SHORT,
)
"""The law of other codes, at once and held."""


def bends(loaded: Any, result: Any) -> None:
    """Towards the target, from the first step on."""
    assert np.all(np.diff(result.probes["bend"]) > 0.0)


EACH: Deck = rod_deck(
    line(4),
    actuation=[_BEND],
    controllers={
        "bend": {
            "type": "pi",
            "target": {"each": {"file": "each.csv", "interpolation": "linear"}},
            "gains": {"p": 0.1},
            "period": 0.01,
        }
    },
    numerics=SHORT,
)
RUN: Deck = rod_deck(
    line(4),
    actuation=[_BEND],
    controllers={"bend": {"type": "pi", "target": {"run": "run.csv"}, "gains": {"p": 0.1}, "period": 0.01}},
    numerics=SHORT,
)


def follows(*values: float) -> Any:
    """Asserts the target of the only loop at 5 ms."""

    def told(made: Any) -> None:
        (loop,) = made.simulation.controls.loops
        assert_array_equal(np.round(loop.target(0.005), 12), values)

    return told
