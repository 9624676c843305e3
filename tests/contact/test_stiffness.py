"""How stiff contact gets in an impact: as stiff as the tolerance asks for, and not a hundred times that."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import dismech_cli
from dismech_cli.contact.law.stiffness import asked_for
from dismech_cli.scenario.load import load_mapping

TOLERANCE = 0.05


def test_what_comes_together_is_stopped_together() -> None:
    """One tip that holds nothing does not set the stiffness of all; what comes elsewhere does not help."""
    force, held = np.array([1.0, 1.0, 8.0]), np.array([1.0, 1e-6, 2.0])
    assert_allclose(asked_for(force, held, np.array([0, 0, 1])), 4.0, rtol=1e-15)
    assert_allclose(asked_for(force, held, np.array([1, 1, 1])), 10.0 / 3.000001, rtol=1e-15)


def falling(
    folder: Path, dt: float, modulus: float, divisions: tuple[int, int], **integrator: Any
) -> dict[str, Any]:
    """A strip that is folded over, held by its lower leaf; the upper one comes down at 1 m/s."""
    write_folded(folder / "strip.txt", *divisions)
    return {
        "schema_version": 1,
        "name": "strip",
        "materials": {"m": {"youngs_modulus": modulus, "poisson_ratio": 0.3, "density": 1000}},
        "geometry": [
            {
                "type": "shell",
                "name": "strip",
                "material": "m",
                "thickness": 1e-3,
                "mesh": {"file": "strip.txt"},
            }
        ],
        "contact": {"law": {"tolerance": TOLERANCE}},
        "forces": [{"type": "gravity", "acceleration": [0, 0, -9.81]}],
        "motions": [{"type": "pin", "where": {"box": {"min": [-1, -1, -1e-4], "max": [1, 1, 1e-4]}}}],
        "initial_velocity": [
            {"where": {"box": {"min": [-1, -1, 0.0195], "max": [1, 1, 1]}}, "velocity": [0, 0, -1]}
        ],
        "numerics": {"dt": dt, "t_end": 0.03} | integrator,
        "output": {"every": dt},
    }


def write_folded(file: Path, along: int, across: int) -> None:
    """Two leaves of a strip of 0.2 m by 0.03 m, 20 mm apart, and the half circle between them."""
    radius, length, width = 0.01, 0.2, 0.03
    leaf = 0.5 * (length - np.pi * radius)
    s = np.linspace(0.0, length, along + 1)
    angle = np.clip((s - leaf) / radius, 0.0, np.pi)
    x = np.maximum(leaf - s, 0.0) + np.maximum(s - leaf - np.pi * radius, 0.0) - radius * np.sin(angle)
    z = radius * (1.0 - np.cos(angle))
    y = np.linspace(0.0, width, across + 1)
    nodes = [f"{x[i]:.9g}, {v:.9g}, {z[i]:.9g}" for i in range(along + 1) for v in y]
    triangles = []
    for i in range(along):
        for j in range(across):
            a = i * (across + 1) + j + 1
            b, c, d = a + 1, a + across + 1, a + across + 2
            pair = ((a, c, b), (b, c, d)) if (i + j) % 2 else ((a, c, d), (a, d, b))
            triangles += [f"{p}, {q}, {r}" for p, q, r in pair]
    file.write_text("\n".join(("*Nodes", *nodes, "*Triangles", *triangles, "")))


@pytest.mark.parametrize(
    ("dt", "modulus", "divisions", "integrator"),
    [
        pytest.param(5e-3, 1e6, (20, 2), {}, marks=pytest.mark.slow),
        (1e-3, 1e9, (20, 2), {"integrator": {"type": "implicit_euler"}}),
        pytest.param(1e-3, 1e8, (14, 4), {}, marks=pytest.mark.slow),
    ],
)
def test_a_strip_falls_on_itself(
    tmp_path: Path, dt: float, modulus: float, divisions: tuple[int, int], integrator: dict[str, Any]
) -> None:
    """It gets in nearly as deep as it may: contact is no stiffer than the impact of its corners asks for."""
    deck = falling(tmp_path, dt, modulus, divisions, **integrator)
    report = dismech_cli.simulate(load_mapping(deck, directory=tmp_path))
    assert report.exit == 0
    assert report.warnings == ()
    assert TOLERANCE / 5.0 < report.outcome.state.memory["contact.worst"][0] <= TOLERANCE


@pytest.mark.slow
def test_a_cloth_falls_on_a_ball_and_itself() -> None:
    """Corners and creases tap the ball all the time; contact stays soft enough for steps to converge."""
    deck = {
        "schema_version": 1,
        "name": "cloth",
        "materials": {"m": {"youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 400}},
        "geometry": [
            {
                "type": "shell",
                "name": "cloth",
                "material": "m",
                "thickness": 1e-3,
                "generate": {
                    "shape": "sheet",
                    "origin": [-0.15, -0.15, 0.11],
                    "length": 0.3,
                    "width": 0.3,
                    "divisions": 10,
                },
            }
        ],
        "obstacles": [{"name": "ball", "type": "sphere", "center": [0, 0, 0], "radius": 0.1}],
        "contact": {"friction": {"coefficient": 0.4, "slip_speed": 5e-3}},
        "forces": [{"type": "gravity", "acceleration": [0, 0, -9.81]}],
        "numerics": {"integrator": {"type": "implicit_euler"}, "dt": 5e-3, "t_end": 0.2},
        "output": {"every": 0.02},
    }
    report = dismech_cli.simulate(deck)
    counters = report.outcome.counters
    assert report.exit == 0
    assert counters["cuts"] <= counters["steps"] / 3
    assert TOLERANCE / 5.0 < report.outcome.state.memory["contact.worst"][0] <= TOLERANCE
