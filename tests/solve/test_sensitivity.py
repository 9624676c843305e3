"""Derivatives of whole runs: against differences of runs, forward against backward, known answers."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from slope_cases import (
    STATIC,
    Case,
    central,
    differentiated,
    dynamics,
    framed,
    hybrid,
    planar,
    sheet,
)

from dismech_cli.solve.adjoint import Owed, adjoint
from dismech_cli.solve.integrators import INTEGRATORS
from dismech_cli.solve.sensitivity import forward

E, RHO = "materials.rubber.youngs_modulus", "materials.rubber.density"
MOVING = [one.name for one in INTEGRATORS if one.name != "static"]
PLANAR = {
    "modulus": (E, 1e6),
    "density": (RHO, 1000.0),
    "radius": ("geometry[0].radius", 5e-3),
    "gravity": ("forces[0].acceleration[2]", -9.81),
    "drag": ("forces[1].coefficient", 0.3),
    "curvature": ("actuation[0].value.table[1][1]", 6.0),
    "time": ("actuation[0].value.table[1][0]", 0.055),
    "amplitude": ("motions[0].displacement[2].sine.amplitude", 0.02),
    "frequency": ("motions[0].displacement[2].sine.frequency", 3.0),
    "length": ("geometry[0].generate.to[0]", 0.3),
}
CASES = {f"planar {name}": Case(planar(), *where) for name, where in PLANAR.items()}
CASES |= {f"planar {kind}": Case(planar(dynamics(kind)), E, 1e6) for kind in MOVING}
CASES |= {
    "planar static": Case(planar(STATIC), E, 1e6),
    "framed modulus": Case(framed(), E, 1e6),
    "framed ratio": Case(framed(), "materials.rubber.poisson_ratio", 0.4),
    "framed relaxation": Case(framed(), "materials.rubber.relaxation_time", 0.01),
    "framed twist": Case(framed(), "actuation[0].value.table[1][1]", 20.0),
    "framed shape": Case(framed(), "geometry[0].generate.radius", 0.05),
    "framed stages": Case(framed(dynamics("tr_bdf2")), E, 1e6),
    "framed midpoint": Case(framed(dynamics("implicit_midpoint", 5e-3)), RHO, 1000.0),
    "framed static": Case(framed(STATIC, actuation=[]), E, 2e7),
    "hinges": Case(sheet("hinge"), E, 1e6),
    "hinges thickness": Case(sheet("hinge"), "geometry[0].thickness", 2e-3),
    "free normals": Case(sheet("midedge"), E, 1e6),
    "free normals stages": Case(sheet("midedge", dynamics("tr_bdf2")), "geometry[0].thickness", 2e-3),
    "free normals shape": Case(sheet("midedge"), "geometry[0].generate.length", 0.1),
    "free normals static": Case(sheet("midedge", STATIC), E, 1e6),
    "hybrid": Case(hybrid(), E, 1e6),
}


@pytest.mark.parametrize("name", CASES)
def test_the_derivative_is_that_of_the_run(name: str) -> None:
    case = CASES[name]
    simulation, steps = case.taped()
    *_, d = forward(differentiated([case], simulation), simulation.start, steps)
    size = np.abs(d.q).max()
    parts = np.array([4e-3, 2e-3])
    errors = np.array([np.abs(central(case, part) - d.q[:, 0]).max() / size for part in parts])
    slope = np.polyfit(np.log(parts), np.log(errors), 1)[0]
    assert slope == pytest.approx(2.0, abs=0.1) or errors.max() < 1e-8, errors


@pytest.mark.parametrize("name", ["planar", "static", "tr_bdf2", "framed", "free normals", "hybrid"])
def test_forward_and_adjoint_agree(name: str) -> None:
    decks = {
        "planar": (planar(), list(PLANAR.values())),
        "static": (planar(STATIC), [(E, 1e6), ("forces[0].acceleration[2]", -9.81)]),
        "tr_bdf2": (planar(dynamics("tr_bdf2")), [(E, 1e6), (RHO, 1000.0)]),
        "framed": (framed(), [(E, 1e6), ("materials.rubber.poisson_ratio", 0.4)]),
        "free normals": (sheet("midedge"), [(E, 1e6), ("geometry[0].thickness", 2e-3)]),
        "hybrid": (hybrid(), [(E, 1e6), (RHO, 1000.0)]),
    }
    deck, where = decks[name]
    cases = [Case(deck, *one) for one in where]
    simulation, steps = cases[0].taped()
    model = differentiated(cases, simulation)
    *_, d = forward(model, simulation.start, steps)
    rng = np.random.default_rng(0)
    by_q, by_v = rng.normal(size=(2, len(simulation.start.q)))
    turns = tuple(rng.normal(size=len(edges.angles)) for edges in model.edges)
    direct = by_q @ d.q + by_v @ d.v + sum(x @ y for x, y in zip(turns, d.turns, strict=True))
    owed = Owed(by_q.copy(), by_v.copy(), np.zeros_like(by_q), turns)
    assert_allclose(adjoint(model, simulation.start, steps, owed), direct, rtol=1e-9)
