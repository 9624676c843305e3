"""Cost of contact by phase: search, distances, points with forces and stiffness, beside a factorisation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from dismech_cli import load_mapping, simulate
from dismech_cli.compose.compose import compose
from dismech_cli.contact.contact import Contacts
from dismech_cli.contact.rod_pairs import RodPairs
from dismech_cli.contact.surface_pairs import SurfacePairs
from dismech_cli.kernels.linearization import Linearization
from dismech_cli.model.configuration import Configuration
from dismech_cli.model.model import Model
from dismech_cli.model.state import State
from dismech_cli.solve.integrators import ImplicitEuler
from dismech_cli.solve.system import System

from .clock import in_turns
from .table import table, verdict

SCENES = Path(__file__).resolve().parents[1] / "scenarios"
DT = 5e-3
# Detection and terms against a factorisation and solution of the scene without contact; the extension of the
# pattern with its slots against a factorisation with contact.
BAR, EXTENSION_BAR = 0.8, 0.5


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
    count = len(contact.faces.surface.nodes)  # type: ignore[attr-defined]
    return Case(f"three layers of {count} triangles", case.model, replace(case.state, q=q))


def report(quick: bool) -> str:
    """Milliseconds of each phase."""
    cases: list[Callable[[], Case]] = [
        lambda: shipped("entanglement_gripper", 2.0),
        lambda: shipped("overhand_knot", 1.0),
        lambda: heap(20 if quick else 100, 200),
        lambda: folded(2_000),
        lambda: folded(10_000),
    ]
    if not quick:
        cases.append(lambda: folded(20_000))
    rows = [_row(case(), 0.5 if quick else 2.0) for case in cases]
    return "\n\n".join(
        (
            "## Contact\n\nBodies that touch, by Numba [ms]: the search for what is near (once per half a "
            "thickness of motion), distances of what it found and points of contact (both once per trial "
            "point), their forces and stiffness; beside factorisation and solution of the matrix "
            "with contact and without, and the extension of the pattern (once per change: entries, merging, "
            "slots).",
            table(
                (
                    "scene",
                    "candidates",
                    "points",
                    "search",
                    "distances",
                    "points of contact",
                    "forces and stiffness",
                    "solve with contact",
                    "solve without",
                    "extension",
                    "distances, points and terms / solve without",
                    "extension / solve with",
                ),
                rows,
            ),
        )
    )


def _row(case: Case, seconds: float) -> tuple[object, ...]:
    model, state = case.model, case.state
    free = np.ones(model.dofs.n, dtype=np.bool_)
    system, alone = System(model, free), System(replace(model, changing=()), free, "pardiso")
    system.recall(state)
    stage = ImplicitEuler().stage(0, state, state, DT)
    values = system.linearize(stage, state.q, state.frames).values.copy()
    less = alone.linearize(stage, state.q, state.frames).values.copy()
    overlay = system._overlay
    assert overlay is not None
    (contacts,) = overlay.sets
    assert isinstance(contacts, Contacts)
    c: Configuration = system.configuration(stage, state.q, state.frames)
    x = model.dofs.space_positions(state.q)
    source = next(one for one in contacts._sources if isinstance(one, RodPairs | SurfacePairs))
    into = Linearization.of(model.dofs.n, system.pattern.slots)
    (normal,) = contacts.terms
    b = np.ones(system.pattern.m)

    def found() -> object:
        contacts._at = None
        return contacts.touching(c)

    def extended() -> None:
        extender = overlay._extender
        extender.extended(extender.entries(contacts.couplings))
        normal.place(system.pattern)

    search, distances = _detection(source, x)
    actions: list[Callable[[], object]] = [
        search,
        distances,
        found,
        lambda: normal.add_linearization(c, into),
        lambda: system.solver.factorize(values).solve(b),
        lambda: alone.solver.factorize(less).solve(b),
        extended,
    ]
    points = sum(len(one.points.item) for one in contacts.touching(c))
    turns = 1e3 * in_turns(actions, seconds=seconds)
    ratio = float(np.median(turns[:, 1:4].sum(axis=1) / turns[:, 5]))
    growth = float(np.median(turns[:, 6] / turns[:, 4]))
    return (
        case.name,
        _candidates(source),
        points,
        *turns.min(axis=0).tolist(),
        verdict(ratio, BAR),
        verdict(growth, EXTENSION_BAR),
    )


def _candidates(source: RodPairs | SurfacePairs) -> int:
    return len(source._candidates.keys if isinstance(source, SurfacePairs) else source._search.candidates)


def _detection(
    source: RodPairs | SurfacePairs, x: np.ndarray
) -> tuple[Callable[[], object], Callable[[], object]]:
    """Search, and distances of what it found."""
    if isinstance(source, SurfacePairs):

        def look() -> object:
            source._seen = None
            return source._look(x)

        return lambda: source._find(x, source._skin), look
    search = source._search

    def measure() -> None:
        search._measured = np.empty(0)
        search.measure(x)

    return lambda: search._find(x, search.skin), measure
