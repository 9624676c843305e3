"""Scenes in which bodies touch, for the benchmark of contact."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from dismech_cli import load_mapping, simulate
from dismech_cli.compose.compose import compose
from dismech_cli.contact.contact import Contact
from dismech_cli.model.model import Model
from dismech_cli.model.state import State

SCENES = Path(__file__).resolve().parents[1] / "scenarios"
DT = 5e-3


@dataclass(frozen=True, slots=True)
class Case:
    """A scene in which bodies touch.

    Attributes:
        name: What touches.
        model: The scene.
        state: A state with contact.
    """

    name: str
    model: Model
    state: State


def shipped(name: str, until: float) -> Case:
    """A scene of the gallery at a time."""
    report = simulate(SCENES / f"{name}.yaml", overrides=[f"numerics.t_end={until}"], kernels="numba")
    return Case(name, report.composition.simulation.model, report.outcome.state)


def composed(name: str, bodies: list[dict[str, object]]) -> Case:
    """Bodies of a soft material as they lie."""
    deck = {
        "schema_version": 1,
        "name": "contact",
        "materials": {"m": {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1e3}},
        "geometry": bodies,
        "contact": {},
        "numerics": {"dt": DT, "t_end": 1.0, "integrator": {"type": "implicit_euler"}},
    }
    simulation = compose(load_mapping(deck), kernels="numba").simulation
    return Case(name, simulation.model, simulation.start)


def heap(rods: int, nodes: int) -> Case:
    """Rods thrown on a heap: straight, at random, about ten thousand pairs near each other."""
    rng = np.random.default_rng(0)
    size = 0.1 * (rods / 100.0) ** (1.0 / 3.0)
    bodies: list[dict[str, object]] = []
    for k in range(rods):
        middle, direction = rng.uniform(-size, size, 3), rng.normal(size=3)
        half = 0.25 * direction / np.linalg.norm(direction)
        line = {"shape": "line", "from": (middle - half).tolist(), "to": (middle + half).tolist()}
        bodies.append(
            {"type": "rod", "name": f"r{k}", "material": "m", "radius": 2e-3}
            | {"generate": line | {"nodes": nodes}}
        )
    return composed(f"{rods} rods of {nodes} nodes", bodies)


def folded(triangles: int) -> Case:
    """Three wavy layers of cloth, each a tenth of its thickness in the next, edges of 20 thicknesses."""
    thickness = 1e-3
    edge = 20.0 * thickness
    # a sheet has about 2.3 triangles per division squared
    divisions = round(np.sqrt(triangles / 3.0 / 2.3))
    size = divisions * edge
    bodies: list[dict[str, object]] = [
        {
            "type": "shell",
            "name": f"layer{k}",
            "material": "m",
            "thickness": thickness,
            "generate": {
                "shape": "sheet",
                "origin": [0.31 * k * edge, 0.17 * k * edge, 0.9 * k * thickness],
                "length": size,
                "width": size,
                "divisions": divisions,
            },
        }
        for k in range(3)
    ]
    case = composed("", bodies)
    q = case.state.q.copy()
    x = case.model.dofs.positions(q)
    x[:, 2] += np.random.default_rng(0).uniform(-0.05, 0.05, len(x)) * thickness
    (contact,) = case.model.changing
    assert isinstance(contact, Contact)
    assert contact.faces is not None
    count = len(contact.faces.surface.nodes)
    return Case(f"three layers of {count} triangles", case.model, replace(case.state, q=q))
