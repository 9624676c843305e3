"""Rubber against closed forms: uniaxial, equibiaxial and pure shear, and a balloon up to its limit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from shell_decks import Deck, ran, write

from dismech_cli.arrays import FloatArray, IntArray
from dismech_cli.mesh.generate.rings import hemisphere
from dismech_cli.run.loop import End
from dismech_cli.session.simulate import simulate

__all__ = ["ran", "write"]

MU, H, SIDE = 4e5, 1e-3, 0.1
RUBBER: Deck = {"model": "neo_hookean", "youngs_modulus": 3 * MU, "poisson_ratio": 0.5, "density": 1000.0}
STRETCH = 3.0


def square(pattern: str, motions: list[Deck]) -> Deck:
    """A square sheet in its plane, stretched to ``STRETCH`` along x."""
    pull = {"ramp": {"from": 0.0, "to": (STRETCH - 1.0) * SIDE, "end": 1.0}}
    flat = {"type": "pin", "where": "sheet", "components": ["z"]}
    roller = {"type": "pin", "where": "sheet.left", "components": ["x"]}
    pulled = {
        "type": "pin",
        "where": "sheet.right",
        "components": ["x"],
        "displacement": [pull, 0.0, 0.0],
    }
    surface = {"shape": "sheet", "origin": [0.0, 0.0, 0.0], "length": SIDE, "width": SIDE, "divisions": 6}
    return {
        "schema_version": 1,
        "name": "rubber",
        "materials": {"rubber": RUBBER},
        "geometry": [
            {"type": "shell", "name": "sheet", "material": "rubber", "thickness": H}
            | {"generate": surface | {"pattern": pattern}}
        ],
        "motions": [flat, roller, pulled, *motions],
        "numerics": {"integrator": {"type": "static", "load_steps": 8}},
        "output": {
            "every": 0.125,
            "probes": {
                "force": {"reaction": "sheet.right", "component": "x"},
                "lift": {"position": "sheet.top", "component": "y"},
            },
        },
    }


def across(displacement: Any) -> list[Deck]:
    """Sliding on the bottom; the top driven along y, or free where nothing is given."""
    bottom: Deck = {"type": "pin", "where": "sheet.bottom", "components": ["y"]}
    if displacement is None:
        return [bottom]
    driven = {"displacement": [0.0, displacement, 0.0]}
    return [bottom, {"type": "pin", "where": "sheet.top", "components": ["y"]} | driven]


CASES = {
    # name: motions across, stretch across, force over mu h w0
    "uniaxial": (across(None), lambda a: a**-0.5, lambda a: a - a**-2),
    "equibiaxial": (
        across({"ramp": {"from": 0.0, "to": (STRETCH - 1.0) * SIDE, "end": 1.0}}),
        lambda a: a,
        lambda a: a - a**-5,
    ),
    "pure shear": (across(0.0), lambda a: 1.0 + 0.0 * a, lambda a: a - a**-3),
}


@pytest.mark.parametrize("pattern", ["alternating", "unstructured"])
@pytest.mark.parametrize("name", CASES)
def test_sheets_of_rubber(ran: Any, name: str, pattern: str) -> None:
    """A uniform state is exact on any mesh, at every stretch up to 3: to Newton's tolerance."""
    motions, width, force = CASES[name]
    report = ran(square(pattern, motions))
    stretch = 1.0 + (STRETCH - 1.0) * report.scalars["t"]
    assert stretch[-1] == STRETCH
    assert_allclose(report.probes["force"], MU * H * SIDE * force(stretch), rtol=1e-4, atol=1e-6)
    assert_allclose(report.probes["lift"], SIDE * width(stretch), rtol=1e-4)


def test_a_balloon_up_to_its_limit(write: Any) -> None:
    """p = 2 mu h / R (1/a - 1/a^7) at the stretch a, largest at a^6 = 7: no rest lies beyond.

    The sphere of triangles is thinner by its mesh, O(1/rings^2): as 3 V / A to R, 0.5 % here.
    """
    radius, rings = 0.1, 12
    unit = 0.1 * MU * H / radius
    limit = 2.0 * 7.0 ** (-1.0 / 6.0) * 6.0 / 7.0
    mesh = hemisphere(radius, rings)
    volume, area = volume_and_area(mesh.nodes, mesh.triangles)
    finer = radius * area / (3.0 * volume)
    assert 1.0 < finer < 1.006
    ramp = {"ramp": {"from": 0.0, "to": 1.3 * unit, "end": 1.0}}
    surface = {"shape": "hemisphere", "center": [0.0, 0.0, 0.0], "radius": radius, "rings": rings}
    deck = {
        "schema_version": 1,
        "name": "balloon",
        "materials": {"rubber": RUBBER},
        "geometry": [
            {"type": "shell", "name": "half", "material": "rubber", "thickness": 0.1 * H, "generate": surface}
        ],
        "motions": [
            {"type": "symmetry", "where": "half.rim", "normal": "z"},
            {"type": "pin", "where": "half.apex", "components": ["x", "y"]},
            {"type": "pin", "where": {"nearest": [radius, 0.0, 0.0]}, "components": ["y"]},
        ],
        "forces": [{"type": "pressure", "shell": "half", "pressure": ramp}],
        "numerics": {"integrator": {"type": "static", "load_steps": 20}},
        "output": {"every": 0.05},
    }
    report = simulate(write(deck))
    assert report.outcome.end is End.FAILED  # under a pressure it cannot bear
    reached = 1.3 * report.outcome.state.t
    assert_allclose(reached, limit, rtol=0.01)
    assert_allclose(reached, limit * finer, rtol=0.002)
    # on the way there, away from the limit, where the stretch answers to the pressure
    volumes = np.array([volume_and_area(frame.positions, mesh.triangles)[0] for frame in report.frames])
    stretch, pressure = np.cbrt(volumes / volume), 1.3 * report.scalars["t"]
    early = stretch < 1.2
    assert early.sum() > 10
    assert_allclose(pressure[early], 2.0 * finer * (stretch**-1 - stretch**-7)[early], rtol=0.01, atol=1e-3)


def volume_and_area(nodes: FloatArray, triangles: IntArray) -> tuple[float, float]:
    """Of the half above the plane through its rim [m^3], [m^2]."""
    x = nodes[triangles]
    normal = 0.5 * np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    return float((x[:, 0] * normal).sum() / 3.0), float(np.linalg.norm(normal, axis=1).sum())
