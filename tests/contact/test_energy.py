"""Impacts without friction under the integrator that scenes of contact take: none makes energy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from contact_decks import crossing
from numpy.testing import assert_allclose

import dismech_cli

MOST = 1e-3
"""Share of the energy of an impact that may come from nowhere."""


def falling(law: dict[str, Any], dt: float) -> dict[str, Any]:
    """A slanted rod that flies at a floor at 1 m/s."""
    return {
        "schema_version": 1,
        "name": "falling",
        "materials": {"m": {"youngs_modulus": 2e9, "poisson_ratio": 0.3, "density": 1500.0}},
        "geometry": [
            {
                "type": "rod",
                "name": "rod",
                "material": "m",
                "radius": 1e-3,
                "generate": {"shape": "line", "from": [0, 0, 2e-3], "to": [0.05, 0, 0.03], "nodes": 11},
            }
        ],
        "obstacles": [{"name": "floor", "type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}],
        "contact": {"law": law},
        "initial_velocity": [{"where": "rod", "velocity": [0, 0, -1.0]}],
        "numerics": {"dt": dt, "t_end": 0.04},
        "output": {"every": dt},
    }


def sheets(law: dict[str, Any], dt: float, thickness: Any = 2e-3) -> dict[str, Any]:
    """A sheet that flies at another at 1 m/s."""

    def sheet(name: str, origin: list[float]) -> dict[str, Any]:
        plan = {"shape": "sheet", "origin": origin, "length": 0.1, "width": 0.06, "divisions": 3}
        body = {"type": "shell", "name": name, "material": "m", "thickness": thickness, "bending": "midedge"}
        return body | {"generate": plan | {"pattern": "alternating"}}

    return {
        "schema_version": 1,
        "name": "sheets",
        "materials": {"m": {"youngs_modulus": 1e8, "poisson_ratio": 0.3, "density": 1000.0}},
        "geometry": [sheet("low", [0.0, 0.0, 0.0]), sheet("high", [0.02, 0.01, 0.006])],
        "contact": {"law": law, "pairs": [{"between": ["low", "high"]}]},
        "initial_velocity": [{"where": "high", "velocity": [0.0, 0.0, -1.0]}],
        "numerics": {"dt": dt, "t_end": 0.02},
        "output": {"every": dt},
    }


def energy_made(deck: dict[str, Any]) -> float:
    """Largest surplus of a balance, as a share of the energy at the start."""
    report = dismech_cli.simulate(deck)
    assert report.exit == 0, report.message
    assert report.scalars["contact"].max() > 0.0 or report.outcome.state.memory["contact.worst"][0] > 0.0
    return float(report.scalars["error"].max() / report.scalars["kinetic"][0])


@pytest.mark.parametrize("dt", [1e-3, pytest.param(1e-4, marks=pytest.mark.slow)])
@pytest.mark.parametrize("law", [{"tolerance": 0.05}, {"stiffness": 1e6}, {"stiffness": 1e8}])
def test_a_rod_on_a_floor(law: dict[str, float], dt: float) -> None:
    assert energy_made(falling(law, dt)) <= MOST


@pytest.mark.parametrize("dt", [1e-3, pytest.param(2.5e-4, marks=pytest.mark.slow)])
@pytest.mark.parametrize("law", [{"tolerance": 0.05}, {"stiffness": 1e6}, {"stiffness": 1e8}])
def test_a_rod_on_a_rod(law: dict[str, float], dt: float) -> None:
    assert energy_made(crossing(dt, 1.0, **law)) <= MOST


@pytest.mark.parametrize("dt", [1e-3, pytest.param(2.5e-4, marks=pytest.mark.slow)])
@pytest.mark.parametrize("tolerance", [0.1, 0.02])
def test_a_sheet_on_a_sheet(tolerance: float, dt: float) -> None:
    assert energy_made(sheets({"tolerance": tolerance}, dt)) <= MOST


BUMPY = {"expression": "0.002 + 0.0006*sin(700*x)*cos(900*y)"}


@pytest.mark.parametrize("kernels", ["numpy", "numba"])
def test_sheets_whose_thickness_changes_from_triangle_to_triangle(kernels: str) -> None:
    """Layers are taken off of each other where bodies slide, too: momentum is kept, and no energy is made."""
    deck = sheets({"tolerance": 0.05}, 1e-3, BUMPY)
    deck["initial_velocity"][0]["velocity"] = [0.5, 0.2, -1.0]
    deck["numerics"]["kernels"] = kernels
    report = dismech_cli.simulate(deck)
    assert report.exit == 0, report.message
    assert 0.0 < report.outcome.state.memory["contact.worst"][0] <= 0.05
    assert report.scalars["error"].max() <= MOST * report.scalars["kinetic"][0]
    state, model = report.outcome.state, report.composition.simulation.model
    momentum = (model.mass * state.v)[: model.dofs.n_positions].reshape(-1, 3)
    mass = float(model.mass[: model.dofs.n_positions].reshape(-1, 3)[12:, 0].sum())
    assert_allclose(momentum.sum(axis=0), mass * np.array([0.5, 0.2, -1.0]), atol=1e-10 * mass)
    assert momentum[:12, 2].sum() < -0.2 * mass
