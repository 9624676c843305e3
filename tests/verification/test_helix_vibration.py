"""Bouncing of a hanging coil: periods against the Kirchhoff-Love equations of the helical rod.

The spring formula T = 4 sqrt(m/k) of the gallery's scenes neglects how bouncing couples to winding and
swaying, five per cent here; the eigenvalue problem does not.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from decks import rod_deck, scalar, solve
from kirchhoff_helix import RoundHelix
from numpy.testing import assert_allclose
from order import observed_order

SOFT = RoundHelix(radius=0.02, height=0.185, turns=3.7, wire=5e-3, modulus=1e7, density=1273.52)
STIFF = RoundHelix(radius=0.02, height=0.185, turns=3.7, wire=1e-3, modulus=1e9, density=1273.52)


def period_ratio(folder: Path, helix: RoundHelix, integrator: str, nodes: int) -> float:
    """Measured over exact period of the mode that bounces, at 1/100 of a period per step."""
    places = np.linspace(0.0, 1.0, nodes)
    formula = 4.0 * np.sqrt(_mass(helix) / _spring(helix))
    omega, shape = helix.mode(2.0 * np.pi / (1.10 * formula), 2.0 * np.pi / (0.95 * formula), places)
    # more than half of the movement is along the axis, all coils at once
    assert abs(shape[:, 2].mean()) > 0.75 * np.sqrt((shape**2).sum(axis=1).mean())
    speed = 1e-4 * helix.radius * omega * shape
    np.savetxt(folder / "speed.csv", speed, delimiter=",", header="x,y,z", comments="")
    dt = 2.0 * np.pi / omega / 100
    deck = rod_deck(
        {
            "shape": "helix",
            "origin": [0.0, 0.0, 0.0],
            "axis": [0.0, 0.0, -1.0],
            "radius": helix.radius,
            "pitch": helix.height / helix.turns,
            "turns": helix.turns,
            "handedness": "right",
            "phase": "-90 deg",
            "nodes": nodes,
        },
        {"type": "round", "radius": helix.wire},
        materials={"m": {"youngs_modulus": helix.modulus, "poisson_ratio": 0.5, "density": helix.density}},
        dimension=3,
        initial_velocity=[{"where": "rod", "velocity": {"file": "speed.csv"}}],
        numerics={"integrator": {"type": integrator}, "dt": dt, "t_end": 2.05 * 100 * dt},
        output={"every": dt, "probes": {"z": {"displacement": "rod.end", "component": "z"}}},
    )
    result = solve(folder, deck)
    t, z = np.array([frame.t for frame in result.frames]), scalar(result, "z")
    here = np.flatnonzero((z[1:-1] * z[2:] <= 0.0) & (z[1:-1] != 0.0)) + 1
    crossings = t[here] - z[here] * (t[here + 1] - t[here]) / (z[here + 1] - z[here])
    # it starts from zero: crossings are half periods apart
    return float(2.0 * crossings[-1] / len(crossings) * omega / (2.0 * np.pi))


def _mass(helix: RoundHelix) -> float:
    return helix.density * np.pi * helix.wire**2 * helix.length


def _spring(helix: RoundHelix) -> float:
    """G d^4 / (8 D^3 n) [N/m]."""
    return helix.modulus / 3.0 * helix.wire**4 / (4.0 * helix.radius**3 * helix.turns)


@pytest.mark.parametrize("integrator", ["implicit_midpoint", "newmark"])
@pytest.mark.parametrize("helix", [SOFT, STIFF], ids=["soft", "stiff"])
def test_period_of_the_bouncing_helix(tmp_path: Path, helix: RoundHelix, integrator: str) -> None:
    assert_allclose(period_ratio(tmp_path, helix, integrator, 100), 1.0, atol=1e-2)


@pytest.mark.slow
def test_period_converges_with_the_mesh(tmp_path: Path) -> None:
    """Differences of meshes: what is left of the error in time is the same in all."""
    nodes = np.array([50, 99, 197])
    ratios = np.array([period_ratio(tmp_path, STIFF, "newmark", int(n)) for n in nodes])
    differences = np.abs(np.diff(ratios))
    assert observed_order(1.0 / (nodes[:-1] - 1.0), differences) > 1.8
    assert_allclose(ratios[-1], 1.0, atol=3e-3)
