"""Sheets of any number of triangles, built from scenario text as a user's would be."""

from __future__ import annotations

from typing import Any

from dismech_cli.run.simulation import Simulation

from .scenes import built

EDGE = 5e-3  # length of an edge [m]
# Divisions of a square sheet of equilateral triangles that give about so many triangles.
DIVISIONS = {1000: 21, 10_000: 66, 20_000: 93, 50_000: 147}


def sheet(triangles: int, *, bending: str, **numerics: object) -> Simulation:
    """A square of silicone sheet, clamped at one side, that starts to fall."""
    return built(sheet_deck(triangles, bending=bending), numerics)


def sheet_deck(triangles: int, *, bending: str) -> dict[str, Any]:
    """The same as a scenario without numerics."""
    divisions = DIVISIONS[triangles]
    size = EDGE * divisions
    surface = {"shape": "sheet", "origin": [0, 0, 0], "length": size, "width": size, "divisions": divisions}
    shell = {"type": "shell", "name": "sheet", "material": "silicone", "thickness": 1e-3}
    return {
        "schema_version": 1,
        "name": "benchmark",
        "materials": {"silicone": {"youngs_modulus": 1e6, "poisson_ratio": 0.49, "density": 1100}},
        "geometry": [shell | {"bending": bending, "generate": surface}],
        "motions": [{"type": "clamp", "where": "sheet.left"}],
        "forces": [{"type": "gravity", "acceleration": [0, 0, -9.81]}],
        "output": {"fields": []},
    }
