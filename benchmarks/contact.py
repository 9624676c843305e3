"""Cost of contact by phase: search, distances, points with forces and stiffness, beside a factorisation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dismech_cli import simulate
from dismech_cli.compose.compose import compose
from dismech_cli.contact.contact import Contact
from dismech_cli.contact.rod_pairs import RodPairs
from dismech_cli.kernels.linearization import Linearization
from dismech_cli.model.configuration import Configuration
from dismech_cli.model.model import Model
from dismech_cli.model.state import State
from dismech_cli.solve.integrators import ImplicitEuler
from dismech_cli.solve.system import System

from .clock import in_turns
from .table import table

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
    report = simulate(SCENES / f"{name}.yaml", overrides=[f"numerics.t_end={until}"])
    return Case(name, report.composition.simulation.model, report.outcome.state)


def heap(rods: int, nodes: int) -> Case:
    """Rods thrown on a heap: straight, at random, about ten thousand pairs near each other."""
    rng = np.random.default_rng(0)
    size = 0.1 * (rods / 100.0) ** (1.0 / 3.0)
    bodies = []
    for k in range(rods):
        middle, direction = rng.uniform(-size, size, 3), rng.normal(size=3)
        half = 0.25 * direction / np.linalg.norm(direction)
        line = {"shape": "line", "from": (middle - half).tolist(), "to": (middle + half).tolist()}
        bodies.append(
            {
                "type": "rod",
                "name": f"r{k}",
                "material": "m",
                "radius": 2e-3,
                "generate": line | {"nodes": nodes},
            }
        )
    deck = {
        "schema_version": 1,
        "name": "heap",
        "materials": {"m": {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1e3}},
        "geometry": bodies,
        "contact": {},
        "numerics": {"dt": DT, "t_end": 1.0},
    }
    from dismech_cli import load_mapping

    simulation = compose(load_mapping(deck)).simulation
    return Case(f"{rods} rods of {nodes} nodes", simulation.model, simulation.start)


def report(quick: bool) -> str:
    """Milliseconds of each phase."""
    cases = [
        shipped("entanglement_gripper", 2.0),
        shipped("overhand_knot", 2.5),
        heap(20 if quick else 100, 100),
    ]
    rows = [_row(case, 1.0 if quick else 5.0) for case in cases]
    return "\n\n".join(
        (
            "## Contact\n\nBodies that touch, by NumPy [ms]: the search for what is near (once per half a "
            "thickness of motion), distances of what it found and points of contact (both once per trial "
            "point), their forces and stiffness; beside a factorisation of the matrix with contact and the "
            "extension of its pattern (once per change).",
            table(
                (
                    "scene",
                    "candidates",
                    "touching",
                    "search",
                    "distances",
                    "points",
                    "forces and stiffness",
                    "factorisation",
                    "extension",
                ),
                rows,
            ),
        )
    )


def _row(case: Case, seconds: float) -> tuple[object, ...]:
    model, state = case.model, case.state
    (contact,) = model.changing
    assert isinstance(contact, Contact)
    assert contact.neighbours is not None
    system = System(model, np.ones(model.dofs.n, dtype=np.bool_))
    system.recall(state)
    stage = ImplicitEuler().stage(0, state, state, DT)
    now = system.linearize(stage, state.q, state.frames)
    values = now.values.copy()
    x = model.dofs.space_positions(state.q)
    pairs = RodPairs(contact.neighbours)
    pairs.recall(state.memory)
    pairs.detect(x)
    candidates = contact.neighbours.search(x, pairs._search.skin)
    overlay = system._overlay
    assert overlay is not None
    into = Linearization(
        np.zeros(model.dofs.n), np.zeros(system.pattern.slots), np.zeros(system.pattern.slots)
    )
    c: Configuration = system.configuration(stage, state.q, state.frames)
    (normal,) = overlay.sets[0].terms
    touching = [len(np.unique(one.points.item)) for one in pairs.touching(x, 0.0 * x, 0.0, 1.0)]
    couplings = overlay.sets[0].couplings
    base = system._base
    actions: list[Callable[[], object]] = [
        lambda: contact.neighbours.search(x, pairs._search.skin),
        lambda: contact.neighbours.distances(x, candidates),
        lambda: list(pairs.touching(x, 0.0 * x, 0.0, 1.0)),
        lambda: normal.add_linearization(c, into),
        lambda: system.solver.factorize(values),
        lambda: base.extended(couplings),
    ]
    spent = 1e3 * in_turns(actions, seconds=seconds).min(axis=0)
    return (case.name, len(candidates), touching[0] // 2 if touching else 0, *spent.tolist())
