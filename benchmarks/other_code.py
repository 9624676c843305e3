"""Beside PyElastica: CPU time per simulated second of the dynamic cantilever and the helices."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dismech_cli.arrays import FloatArray
from dismech_cli.compose.compose import compose
from dismech_cli.scenario.language.geometry import Rod
from dismech_cli.scenario.language.material import Material

from .elastica_scenes import Wire, fall, largest_stable_step
from .newton_iteration import advance
from .scenes import gallery, stepper_of
from .table import table

# Steps tried from the largest; the first whose error is below the goal is taken.
STEPS = (1e-2, 5e-3, 4e-3, 2.5e-3, 2e-3, 1.25e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4)
GOAL = 0.01


@dataclass(frozen=True, slots=True)
class Case:
    """A scene of the gallery, for a short time that each step divides.

    Attributes:
        name: Of the scenario.
        t_end: Simulated time [s].
    """

    name: str
    t_end: float


CASES = (Case("cantilever_dynamic_1e6", 0.08), Case("helix_soft", 0.2), Case("helix_stiff", 0.1))


def ours(case: Case, dt: float) -> tuple[FloatArray, float]:
    """Position of the tip at the end and CPU time of the steps [s]."""
    settings = ["numerics.integrator={type: generalized_alpha}", f"numerics.dt={dt!r} s"]
    settings += [f"numerics.t_end={case.t_end!r} s", "numerics.kernels=numba", "expect={}"]
    simulation = compose(gallery(case.name, settings)).simulation
    stepper = stepper_of(simulation)
    state = stepper.prepare(stepper.rest_state())
    start = time.process_time()
    state, _ = advance(stepper, state, dt, round(case.t_end / dt))
    return simulation.model.dofs.space_positions(state.q)[-1], time.process_time() - start


def wire_of(case: Case) -> Wire:
    """The rod of a scenario as plain numbers."""
    loaded = gallery(case.name)
    geometry = compose(loaded).geometry
    (rod,), (material,) = loaded.scenario.geometry, loaded.scenario.materials.values()
    match rod, material:
        case Rod(radius=float(radius)), Material(youngs_modulus=float(modulus), density=float(density)):
            return Wire(geometry.nodes, radius, modulus, density)
        case _:
            raise ValueError(f"{case.name} is no round rod that is the same all along")


def chosen_step(case: Case, exact: FloatArray, swing: float) -> tuple[float, float]:
    """Largest step below the goal, and its error over the tip's displacement."""
    for dt in STEPS:
        error = float(np.linalg.norm(ours(case, dt)[0] - exact)) / swing
        if error <= GOAL:
            return dt, error
    raise RuntimeError("no step tried is accurate enough")


def report(quick: bool) -> str:
    """Steps, errors, CPU seconds per simulated second and their ratio."""
    rows: list[Sequence[object]] = []
    for case in CASES:
        wire = wire_of(case)
        exact, _ = ours(case, STEPS[-1] / 4)
        swing = float(np.linalg.norm(exact - wire.nodes[-1]))
        explicit = largest_stable_step(wire, case.t_end)
        refined, _ = fall(wire, case.t_end, explicit / 4)
        theirs_error = float(np.linalg.norm(fall(wire, case.t_end, explicit)[0] - refined)) / swing
        apart = float(np.linalg.norm(refined - exact)) / swing
        dt, error = chosen_step(case, exact, swing)
        mine = theirs = np.inf
        for _ in range(2 if quick else 4):
            mine = min(mine, ours(case, dt)[1])
            theirs = min(theirs, fall(wire, case.t_end, explicit)[1])
        errors = (100.0 * error, 100.0 * theirs_error, 100.0 * apart)
        costs = (mine / case.t_end, theirs / case.t_end, theirs / mine)
        rows.append((case.name, 1e3 * dt, 1e3 * explicit, *errors, *costs))
    header = ["scene", "our dt [ms]", "PyElastica dt [ms]", "our error [%]", "PyElastica error [%]"]
    header += ["apart [%]", "ours [s/s]", "PyElastica [s/s]", "PyElastica / ours"]
    return "\n\n".join(
        (
            "## Beside PyElastica\n\nCPU time per simulated second of the cheapest run whose error is below "
            f"{100 * GOAL:g} %, 100 or 101 nodes, both compiled by Numba. The error is that of time: the tip "
            "against the same code at far smaller steps, over its displacement. We take the largest step "
            "tried that meets the goal; PyElastica meets it wherever it is stable, and takes the largest "
            "step tried. The codes differ in their physics (PyElastica's rods shear, and its clamp is at "
            "the node), hence the refined tips apart:",
            table(header, rows),
        )
    )
