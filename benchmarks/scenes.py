"""Scenes of any number of nodes, built from scenario text as a user's would be."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dismech_cli import load
from dismech_cli.compose.compose import compose
from dismech_cli.run.simulation import Simulation
from dismech_cli.scenario.load import LoadedScenario
from dismech_cli.solve.step import Stepper

SCENARIOS = Path(__file__).resolve().parents[1] / "scenarios"
EDGE = 5e-3  # length of an edge [m]


def helix(nodes: int, **numerics: object) -> Simulation:
    """The thick soft helix of the gallery, with as many turns as its nodes make: framed bending."""
    turns = 3.7 * (nodes - 1) / 99
    shape = {"shape": "helix", "origin": [0, 0, 0], "axis": [0, 0, -1], "radius": 0.02, "pitch": 0.05}
    shape |= {"turns": turns, "handedness": "right", "nodes": nodes}
    return built(_falling(shape, dimension=3), numerics)


def cantilever(nodes: int, *, dimension: int, **numerics: object) -> Simulation:
    """A straight rod of the same wire and edge length: isotropic in space, two DOFs per node in the plane."""
    shape = {"shape": "line", "from": [0, 0, 0], "to": [EDGE * (nodes - 1), 0, 0], "nodes": nodes}
    return built(_falling(shape, dimension=dimension), numerics)


def gallery(name: str, overrides: Sequence[str] = ()) -> LoadedScenario:
    """A scenario of the gallery."""
    return load(SCENARIOS / f"{name}.yaml", overrides=overrides)


def simulation_of(loaded: LoadedScenario) -> Simulation:
    """What a scenario builds."""
    return compose(loaded).simulation


def stepper_of(simulation: Simulation) -> Stepper:
    """A stepper as the run loop makes it."""
    return Stepper(simulation.model, simulation.integrator, simulation.newton, simulation.linear_solver)


def _falling(shape: Mapping[str, object], *, dimension: int) -> dict[str, Any]:
    rod = {"type": "rod", "name": "rod", "material": "rubber", "radius": 5e-3, "generate": shape}
    deck: dict[str, Any] = {"schema_version": 1, "name": "benchmark", "dimension": dimension}
    if dimension == 2:
        deck["plane"] = "xz"
    return deck | {
        "materials": {"rubber": {"youngs_modulus": 1e7, "poisson_ratio": 0.5, "density": 1273.52}},
        "geometry": [rod],
        "motions": [{"type": "clamp", "where": "rod.start", "at": "edge"}],
        "forces": [{"type": "gravity", "acceleration": [0, 0, -9.81]}],
        "output": {"fields": []},
    }


def built(deck: dict[str, Any], numerics: Mapping[str, object]) -> Simulation:
    """The simulation of a scenario given as a tree, with these numerics."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.yaml"
        path.write_text(json.dumps(deck | {"numerics": dict(numerics)}), encoding="utf-8")
        return compose(load(path)).simulation
