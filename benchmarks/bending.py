"""The three bending models of shells on regular and random meshes: error, unknowns, time."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_bvp

from dismech_cli.model.state import State
from dismech_cli.run.simulation import Simulation
from dismech_cli.solve.status import Status

from .scenes import built, stepper_of
from .table import table

BENDING: dict[str, dict[str, str]] = {
    "hinge": {"bending": "hinge"},
    "hinge, weighted": {"bending": "hinge", "hinges": "weighted"},
    "averaged": {"bending": "averaged"},
    "midedge": {"bending": "midedge"},
}
PATTERNS = ("equilateral", "right", "alternating", "unstructured")
DIVISIONS = (10, 20, 40)
SIDE, LOAD_STEPS = 0.1, 4


def plate(divisions: int, pattern: str, bending: dict[str, str]) -> Simulation:
    """A square plate, supported along its rim, that sags a little under its weight."""
    surface = {"shape": "sheet", "origin": [0, 0, 0], "length": SIDE, "width": SIDE}
    surface |= {"divisions": divisions, "pattern": pattern}
    return _static(surface, bending, (200e9, 0.3, 7750), [{"type": "pin", "where": "sheet.boundary"}], 1)


def navier(simulation: Simulation, state: State) -> float:
    """Relative error of the sag in the middle against Navier's series."""
    x = simulation.model.dofs.positions(simulation.model.rest)
    middle = int(np.argmin(np.linalg.norm(x - [SIDE / 2, SIDE / 2, 0.0], axis=1)))
    m = np.arange(1, 400, 2)
    a, b = (m[:, None] * x[middle, i] * np.pi / SIDE for i in (0, 1))
    waves = np.sin(a) * np.sin(b.T) / (m[:, None] * m * (m[:, None] ** 2 + m**2) ** 2)
    stiffness = 200e9 * 1e-3**3 / (12.0 * (1.0 - 0.3**2))
    exact = 16.0 * 7750 * 1e-3 * 9.81 * SIDE**4 / (np.pi**6 * stiffness) * waves.sum()
    return float(-state.q[3 * middle + 2] / exact) - 1.0


def strip(divisions: int, pattern: str, bending: dict[str, str]) -> Simulation:
    """A soft strip that hangs far down, held over a tenth of its length; Poisson's ratio is zero."""
    surface = {"shape": "sheet", "origin": [0, 0, 0], "length": SIDE, "width": SIDE / 5}
    surface |= {"divisions": divisions, "pattern": pattern}
    held = {"box": {"min": [-1.0, -1.0, -1.0], "max": [0.1001 * SIDE, 1.0, 1.0]}}
    return _static(surface, bending, (1e7, 0.0, 1000), [{"type": "clamp", "where": held}], LOAD_STEPS)


def elastica(simulation: Simulation, state: State) -> float:
    """Relative error of the tip's sag against the heavy elastica of the free length."""
    length = 0.9 * SIDE
    gamma = 12.0 * 1000 * 9.81 * length**3 / (1e7 * 1e-3**2)

    def slopes(s: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.stack((y[1], gamma * (1.0 - s) * np.cos(y[0]), np.sin(y[0])))

    def ends(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.array([a[0], b[1], a[2]])

    s = np.linspace(0.0, 1.0, 101)
    start = np.stack((-s, 0 * s, -s * s))
    exact = length * float(-solve_bvp(slopes, ends, s, start, tol=1e-9).y[2, -1])
    rest, now = (simulation.model.dofs.positions(q) for q in (simulation.model.rest, state.q))
    tip = rest[:, 0] > SIDE - 1e-9
    return -float(now[tip, 2].mean()) / exact - 1.0


CASES: dict[str, tuple[Callable[..., Simulation], Callable[[Simulation, State], float], int]] = {
    "supported plate": (plate, navier, 1),
    "hanging strip": (strip, elastica, LOAD_STEPS),
}


def _static(
    surface: dict[str, object],
    bending: dict[str, str],
    material: tuple[float, float, float],
    motions: list[dict[str, object]],
    load_steps: int,
) -> Simulation:
    shell = {"type": "shell", "name": "sheet", "material": "sheet", "thickness": 1e-3, **bending}
    keys = ("youngs_modulus", "poisson_ratio", "density")
    deck = {
        "schema_version": 1,
        "name": "benchmark",
        "materials": {"sheet": dict(zip(keys, material, strict=True))},
        "geometry": [shell | {"generate": surface}],
        "motions": motions,
        "forces": [{"type": "gravity", "acceleration": [0, 0, -9.81]}],
        "output": {"fields": []},
    }
    numerics = {"integrator": {"type": "static", "load_steps": load_steps}, "kernels": "numpy"}
    return built(deck, numerics)


def solved(simulation: Simulation, load_steps: int) -> tuple[State, float]:
    """The equilibrium and the CPU time to it [s]."""
    stepper = stepper_of(simulation)
    start = time.process_time()
    state = stepper.prepare(stepper.rest_state())
    for _ in range(load_steps):
        result = stepper.step(stepper.prepare(state), 1.0 / load_steps)
        if result.status is not Status.CONVERGED:
            raise RuntimeError(f"no balance at {state.t:g} of the load: {result.status.name}")
        state = result.state
    return state, time.process_time() - start


def report(quick: bool) -> str:
    """Errors by mesh and model, unknowns and time on the finest mesh."""
    divisions = DIVISIONS[:2] if quick else DIVISIONS
    rows = []
    for name, (scene, error, load_steps) in CASES.items():
        for pattern in PATTERNS:
            for label, bending in BENDING.items():
                errors, spent = [], 0.0
                for count in divisions:
                    simulation = scene(count, pattern, bending)
                    state, spent = solved(simulation, load_steps)
                    errors.append(f"{100.0 * error(simulation, state):+.3g}")
                rows.append((name, pattern, label, *errors, simulation.model.dofs.n, spent))
    head = [f"error at {count} [%]" for count in divisions]
    return "\n\n".join(
        (
            "## Bending models of shells: accuracy and time\n\n"
            "Static scenes with NumPy kernels; error of the sag by divisions of the length, unknowns and CPU "
            "time with the analysis of the matrix on the finest mesh. A square plate, supported along its "
            "rim, against Navier's series at its node nearest the middle; a strip of a fifth of its length, "
            "held over a tenth, that hangs far down under its weight, against the heavy elastica of the free "
            "length (Poisson's ratio zero; where no row of edges ends the clamp, that adds an error of first "
            "order). Hinges have a Poisson's ratio of their own and a stiffness that depends on the mesh.",
            table(("scene", "mesh", "bending", *head, "DOFs", "CPU [s]"), rows),
        )
    )
