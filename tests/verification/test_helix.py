"""A helical spring pulled by its ends: the exact solution is another helix (Love 1927, art. 271)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from decks import Deck, rod_deck, scalar, solve
from numpy.testing import assert_allclose
from order import observed_order

from dismech_cli.arrays import FloatArray

MODULUS, DIAMETER, RADIUS, RISE, TURNS = 1e6, 2e-3, 20e-3, np.deg2rad(2.0), 10
STAGES = (10.0, 20.0, 40.0)
# rise angle in degrees: axial force [N] and height [m]
EXPECTED = {10.0: (1.864431e-4, 0.218346), 20.0: (4.441419e-4, 0.430057), 40.0: (1.178740e-3, 0.808243)}


def helix(rise: float, nodes: int) -> FloatArray:
    """Nodes [m] of the spring drawn to a rise angle [rad] without turning its ends, shape (nodes, 3)."""
    angle = np.linspace(0.0, 2.0 * np.pi * TURNS, nodes)
    radius = RADIUS * np.cos(rise) / np.cos(RISE)
    length = 2.0 * np.pi * TURNS * RADIUS / np.cos(RISE)
    height = length * np.sin(rise) * np.linspace(0.0, 1.0, nodes)
    return np.stack((radius * np.cos(angle), radius * np.sin(angle), height), axis=1)


@dataclass(frozen=True)
class Pulled:
    """Force [N] and radii [m] of the spring at each stage."""

    forces: FloatArray
    radii: FloatArray


def pull(folder: Path, per_turn: int, stages: tuple[float, ...]) -> Pulled:
    """Moves the end edges from helix to helix; their directors stay on the normal by themselves."""
    nodes = per_turn * TURNS + 1
    rest = helix(RISE, nodes)
    paths = np.array([np.zeros_like(rest)] + [helix(np.deg2rad(a), nodes) - rest for a in stages])
    times = np.linspace(0.0, 1.0, len(paths))

    def at(*indices: int) -> Deck:
        return {"nodes": {"of": "rod", "indices": list(indices)}}

    motions: list[Deck] = [
        {
            "type": "pin",
            "where": at(node),
            "displacement": [{"table": np.stack((times, paths[:, node, k]), axis=1)} for k in range(3)],
        }
        for node in (0, 1, nodes - 2, nodes - 1)
    ]
    motions += [
        {"type": "twist", "where": {"edges": {"of": "rod", "indices": [edge]}}, "angle": 0.0}
        for edge in (0, nodes - 2)
    ]
    steps = 8 * len(stages)
    deck = rod_deck(
        {
            "shape": "helix",
            "origin": [0.0, 0.0, 0.0],
            "axis": [0.0, 0.0, 1.0],
            "radius": RADIUS,
            "pitch": 2.0 * np.pi * RADIUS * np.tan(RISE),
            "turns": TURNS,
            "handedness": "right",
            "nodes": nodes,
        },
        {"type": "round", "radius": 0.5 * DIAMETER},
        materials={"m": {"youngs_modulus": MODULUS, "poisson_ratio": 0.5, "density": 1000.0}},
        dimension=3,
        motions=motions,
        numerics={"integrator": {"type": "static", "load_steps": steps}},
        output={"probes": {"force": {"reaction": at(nodes - 2, nodes - 1), "component": "z"}}},
    )
    result = solve(folder, deck)
    assert_allclose(result.frames[0].positions, rest, atol=1e-9 * RADIUS)
    # steps that were cut write frames in between
    written = np.array([frame.t for frame in result.frames])
    at_stage = [int(np.argmin(np.abs(written - t))) for t in times[1:]]
    assert_allclose(written[at_stage], times[1:], rtol=1e-12)
    radii = np.array([np.hypot(*result.frames[k].positions[:, :2].T) for k in at_stage])
    return Pulled(scalar(result, "force")[at_stage], radii)


@pytest.mark.parametrize(
    ("per_turn", "stages", "force_error"),
    [
        # the polygon's curvature errs by (2 pi/n)^2/12, stretched by the difference that the force is: 2 %
        (24, STAGES[:1], 3e-2),
        pytest.param(56, STAGES, 5e-3, marks=pytest.mark.slow),
    ],
)
def test_pulled_spring_stays_a_helix(
    tmp_path: Path, per_turn: int, stages: tuple[float, ...], force_error: float
) -> None:
    pulled = pull(tmp_path, per_turn, stages)
    for rise, force, radii in zip(stages, pulled.forces, pulled.radii, strict=True):
        expected, height = EXPECTED[rise]
        nodes = helix(np.deg2rad(rise), per_turn * TURNS + 1)
        assert_allclose(nodes[-1, 2], height, rtol=2e-6)
        assert_allclose(force, expected, rtol=force_error)
        assert_allclose(radii, np.hypot(*nodes[0, :2]), rtol=1e-3)


@pytest.mark.slow
def test_force_converges_at_second_order(tmp_path: Path) -> None:
    per_turn = np.array([16, 24, 36])
    errors = [abs(pull(tmp_path, int(n), (10.0,)).forces[-1] / EXPECTED[10.0][0] - 1.0) for n in per_turn]
    assert observed_order(1.0 / per_turn, np.array(errors)) > 1.8


@pytest.mark.slow
def test_small_pull_has_the_stiffness_of_a_coil_spring(tmp_path: Path) -> None:
    """F/h = G d^4 / (8 D^3 n) for a flat spring: within its rise angle squared."""
    rise = 2.02
    force = pull(tmp_path, 60, (rise,)).forces[-1]
    stretch = helix(np.deg2rad(rise), 601)[-1, 2] - helix(RISE, 601)[-1, 2]
    shear = MODULUS / 3.0
    assert_allclose(force / stretch, shear * DIAMETER**4 / (8.0 * (2.0 * RADIUS) ** 3 * TURNS), rtol=5e-3)
