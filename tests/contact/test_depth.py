"""How deep bodies are that press each other with a force: as deep as the law says, at any mesh."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from contact_decks import MASS, crossing, on_floor
from numpy.testing import assert_allclose

import dismech_cli
from dismech_cli.arrays import FloatArray

RADIUS, KAPPA = 2e-3, 1e6


def crossed(height: float, nodes: int) -> dict[str, Any]:
    """Two rods that are held across each other at a height."""
    deck = crossing(1e-3, 1.0, stiffness=KAPPA)
    for rod in deck["geometry"]:
        rod["generate"]["nodes"] = nodes
    for end in ("from", "to"):
        deck["geometry"][1]["generate"][end][2] = height
    del deck["initial_velocity"]
    deck["motions"] = [{"type": "pin", "where": "low"}, {"type": "pin", "where": "high"}]
    deck["numerics"] = {"integrator": {"type": "implicit_euler"}, "dt": 1e-3, "t_end": 1e-3}
    contact = ["low", "high"]
    deck["output"] = {
        "every": 1e-3,
        "probes": {
            "force": {"contact": contact, "measure": "normal", "component": "z"},
            "depth": {"contact": contact, "measure": "depth"},
        },
    }
    return deck


@pytest.mark.parametrize("nodes", [2, 6, 201])
@pytest.mark.parametrize("share", [0.01, 0.05, 0.2])
def test_crossed_rods(share: float, nodes: int) -> None:
    """Either pass has half of the energy kappa int (H^2 - d^2)^2 / (4 H^2) ds with d^2 = h^2 + s^2."""
    reach = 2.0 * RADIUS
    height = (1.0 - share) * reach
    report = dismech_cli.simulate(crossed(height, nodes))
    force = KAPPA * height / reach**2 * (4.0 / 3.0) * (reach**2 - height**2) ** 1.5
    assert_allclose(-report.scalars["force"][-1], force, rtol=1e-6)
    assert_allclose(report.scalars["depth"][-1], share, rtol=1e-6)


@pytest.mark.parametrize("nodes", [2, 9, 33])
def test_a_rod_on_a_floor(nodes: int) -> None:
    """Lying still, m g = 2 kappa delta L."""
    deck = on_floor()
    deck["geometry"][0]["generate"]["nodes"] = nodes
    del deck["contact"]["friction"]
    deck["motions"] = [{"type": "pin", "where": "rod.start", "components": ["x"]}]
    deck["numerics"] = {"integrator": {"type": "static"}}
    deck["output"] = {"probes": {"height": {"position": "rod", "component": "z"}}}
    report = dismech_cli.simulate(deck)
    assert report.exit == 0, report.message
    depth = 0.025 - report.scalars["height"][-1]
    assert_allclose(2.0 * 1e4 * depth, MASS * 9.8, rtol=1e-6)


@pytest.mark.parametrize("stop", [pytest.param(1.0, marks=pytest.mark.slow), 0.5])
def test_a_barrier_under_load_keeps_its_distance_in_every_frame(stop: float) -> None:
    """A rod that is thrown at another and pressed on it with ten times its weight."""
    deck = crossing(1e-3, 0.5)
    deck["contact"] = {"law": {"type": "barrier", "stop": stop}}
    deck["motions"] = [{"type": "pin", "where": "low"}]
    deck["forces"] = [{"type": "gravity", "acceleration": [0, 0, -98.0]}]
    deck["numerics"] = {"integrator": {"type": "implicit_euler"}, "dt": 1e-3, "t_end": 0.06}
    report = dismech_cli.simulate(deck)
    assert report.exit == 0, report.message
    assert not [line for line in report.warnings if "nearer" in line]
    gaps = [float(np.linalg.norm(one[:, None] - other, axis=2).min()) for one, other in sampled(report)]
    assert min(gaps) > stop * 2.0 * RADIUS
    # pressed: within the gap where forces act, 2 % of the thickness, and the spacing of the samples
    assert min(gaps) < (stop + 0.05) * 2.0 * RADIUS


def sampled(report: dismech_cli.Report) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Points of both rods, frame by frame."""
    s, nodes = np.linspace(0.0, 5.0, 1001), np.arange(6)

    def points(rod: FloatArray) -> FloatArray:
        return np.stack([np.interp(s, nodes, component) for component in rod.T], axis=1)

    for frame in report.frames:
        yield points(frame.positions[:6]), points(frame.positions[6:])
