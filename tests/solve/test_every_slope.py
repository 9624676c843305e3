"""Derivatives of runs for every energy with every integrator, and with every kind of value."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose
from slope_cases import (
    ALPHA,
    STATIC,
    Case,
    Deck,
    central,
    differentiated,
    dynamics,
    framed,
    hybrid,
    isotropic,
    planar,
    sheet,
)

from dismech_cli.solve.adjoint import Owed, adjoint
from dismech_cli.solve.integrators import INTEGRATORS
from dismech_cli.solve.sensitivity import forward

E, RHO = "materials.rubber.youngs_modulus", "materials.rubber.density"
KINDS = [one.name for one in INTEGRATORS]
DRAG: Deck = {"type": "area_damping", "coefficient": 3.0}


def numerics_of(kind: str) -> Deck:
    return STATIC if kind == "static" else dynamics(kind, 8e-3, 6)


def straight(numerics: Deck = ALPHA) -> Deck:
    """The helix, in statics without the drive that needs time."""
    return framed(numerics, actuation=[]) if numerics is STATIC else framed(numerics)


def folded(numerics: Deck = ALPHA) -> Deck:
    """A flag with hinges that fold themselves."""
    fold: Deck = {"type": "dihedral", "shell": "flag", "value": {"table": [[0.0, 0.0], [0.2, 0.5]]}}
    deck = sheet("hinge", numerics)
    return deck if numerics is STATIC else deck | {"actuation": [fold], "forces": [*deck["forces"], DRAG]}


def curled(bending: str) -> Callable[[Deck], Deck]:
    """A flag with mid-edge normals that curls itself."""

    def deck(numerics: Deck = ALPHA) -> Deck:
        curl: Deck = {
            "type": "surface_curvature",
            "shell": "flag",
            "along": [1, 0, 0],
            "value": {"table": [[0.0, 0.0], [0.2, 5.0]]},
        }
        found = sheet(bending, numerics)
        if numerics is STATIC:
            return found
        return found | {"actuation": [curl], "forces": [*found["forces"], DRAG]}

    return deck


ENERGIES: dict[str, Callable[[Deck], Deck]] = {
    "planar": planar,
    "isotropic": isotropic,
    "framed": straight,
    "hinge": folded,
    "free normals": curled("midedge"),
    "averaged normals": curled("averaged"),
    "hybrid of hinges": lambda numerics: hybrid("hinge", numerics),
    "hybrid of free normals": lambda numerics: hybrid("midedge", numerics),
}
_LOAD = ("forces[0].acceleration[2]", -9.81)
VALUES: dict[str, dict[str, tuple[str, float]]] = {
    # the plane has all kinds in test_sensitivity.py
    "isotropic": {
        "density": (RHO, 1000.0),
        "damping": ("forces[2].coefficient", 0.3),
        "section": ("geometry[0].radius", 5e-3),
        "law": ("forces[1].force[1].table[1][1]", 0.02),
        "load": _LOAD,
    },
    "framed": {
        "density": (RHO, 1000.0),
        "damping": ("materials.rubber.relaxation_time", 0.01),
        "section": ("geometry[0].section.width", 8e-3),
        "natural": ("geometry[0].generate.pitch", 0.08),
        "law": ("actuation[0].value.table[1][1]", 20.0),
        "load": _LOAD,
    },
    "hinge": {
        "density": (RHO, 1000.0),
        "damping": ("forces[1].coefficient", 3.0),
        "section": ("geometry[0].thickness", 2e-3),
        "law": ("actuation[0].value.table[1][1]", 0.5),
        "load": _LOAD,
    },
    "free normals": {
        "density": (RHO, 1000.0),
        "damping": ("forces[1].coefficient", 3.0),
        "section": ("geometry[0].thickness", 2e-3),
        "law": ("actuation[0].value.table[1][1]", 5.0),
        "load": _LOAD,
    },
    "averaged normals": {
        "density": (RHO, 1000.0),
        "damping": ("forces[1].coefficient", 3.0),
        "section": ("geometry[0].thickness", 2e-3),
        "law": ("actuation[0].value.table[1][1]", 5.0),
        "load": _LOAD,
    },
    "hybrid of hinges": {"density": (RHO, 1000.0), "section": ("geometry[1].radius", 5e-3), "load": _LOAD},
    "hybrid of free normals": {
        "density": (RHO, 1000.0),
        "section": ("geometry[1].radius", 5e-3),
        "load": _LOAD,
    },
}


def holds(case: Case) -> None:
    """Differences of runs come nearer to the derivative as the square of their step, down to rounding."""
    simulation, steps = case.taped()
    *_, d = forward(differentiated([case], simulation), simulation.start, steps)
    size = np.abs(d.q).max()
    parts = np.array([4e-3, 2e-3])
    errors = np.array([np.abs(central(case, part) - d.q[:, 0]).max() / size for part in parts])
    slope = np.polyfit(np.log(parts), np.log(errors), 1)[0]
    assert slope == pytest.approx(2.0, abs=0.1) or errors.max() < 1e-8, errors


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("energy", ENERGIES)
def test_every_integrator_of_every_energy(energy: str, kind: str) -> None:
    # stiff enough to sag and not to fold at rest
    stiff = 2e7 if kind == "static" else 1e6
    holds(Case(ENERGIES[energy](numerics_of(kind)), E, stiff))


@pytest.mark.slow
@pytest.mark.parametrize(("energy", "value"), [(one, name) for one, all_ in VALUES.items() for name in all_])
def test_every_kind_of_value(energy: str, value: str) -> None:
    holds(Case(ENERGIES[energy](numerics_of("generalized_alpha")), *VALUES[energy][value]))


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("energy", ENERGIES)
def test_the_adjoint_is_the_transpose(energy: str, kind: str) -> None:
    deck = ENERGIES[energy](numerics_of(kind))
    where = [(E, 2e7 if kind == "static" else 1e6), (RHO, 1000.0), _LOAD]
    deck = deck | {"materials": {"rubber": dict(deck["materials"]["rubber"], youngs_modulus=where[0][1])}}
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
