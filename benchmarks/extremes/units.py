"""The same scene in other units of length and mass: the numbers are the same, so must be the answers."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from itertools import product
from typing import Any, Final

import numpy as np

from dismech_cli import Report, simulate

from .cell import Cell, Deck

UNITS: Final = {
    # one metre and one kilogram in the new unit
    "mm and kg": (1e3, 1.0),
    "mm and g": (1e3, 1e3),
    "um and kg": (1e6, 1.0),
    "um and ug": (1e6, 1e9),
    "km and t": (1e-3, 1e-3),
}
INTEGRATORS: Final = ("static", "implicit_euler", "generalized_alpha", "tr_bdf2", "adaptive")
# Of the size: all that rounding leaves, of five load steps or thirty time steps.
_SAME: Final = 1e-9


def units() -> Iterator[Cell]:
    """A coil and a sheet in all units, at rest and in time."""
    for (unit, (length, mass)), integrator, make in product(UNITS.items(), INTEGRATORS, (coil, sheet)):

        def check(
            report: Report,
            length: float = length,
            integrator: str = integrator,
            make: Any = make,
        ) -> str:
            expected = _in_metres(make, integrator)
            found = report.frames[-1].positions / length
            off = float(np.abs(found - expected).max() / np.ptp(expected, axis=0).max())
            return "" if off <= _SAME else f"off by {off:.2g} of the size"

        yield Cell(
            "other units", f"{make.__name__} in {unit}, {integrator}", make(length, mass, integrator), check
        )


@cache
def _in_metres(make: Any, integrator: str) -> Any:
    report = simulate(make(1.0, 1.0, integrator))
    return report.raise_for_status().frames[-1].positions


def coil(length: float, mass: float, integrator: str) -> Deck:
    """A soft spring hung up by its end."""
    rod = {"type": "rod", "name": "coil", "material": "m", "radius": 1e-3 * length}
    rod["generate"] = {
        "shape": "helix",
        "origin": [0.0, 0.0, 0.0],
        "axis": [0.3, 0.2, 1.0],
        "radius": 0.02 * length,
        "pitch": 0.01 * length,
        "turns": 2.3,
        "handedness": "left",
        "nodes": 24,
    }
    return _scene(rod, "coil.start", length, mass, integrator)


def sheet(length: float, mass: float, integrator: str) -> Deck:
    """A soft sheet held along one side."""
    shell = {"type": "shell", "name": "sheet", "material": "m", "thickness": 1e-3 * length}
    shell["generate"] = {
        "shape": "sheet",
        "origin": [0.0, 0.0, 0.0],
        "length": 0.05 * length,
        "width": 0.02 * length,
        "divisions": 3,
    }
    return _scene(shell, "sheet.left", length, mass, integrator)


def _scene(body: dict[str, Any], held: str, length: float, mass: float, integrator: str) -> Deck:
    numerics: dict[str, Any] = {
        "integrator": {"type": integrator},
        "dt": 5e-3,
        "t_end": 0.15,
    }
    if integrator == "static":
        numerics = {"integrator": {"type": "static", "load_steps": 5}}
    elif integrator == "adaptive":
        numerics = {"t_end": 0.15}
    material = {
        "youngs_modulus": 2e6 * mass / length,
        "poisson_ratio": 0.5,
        "density": 1200.0 * mass / length**3,
    }
    return {
        "schema_version": 1,
        "name": "units",
        "dimension": 3,
        "materials": {"m": material},
        "geometry": [body],
        "motions": [{"type": "clamp", "where": held}],
        "forces": [{"type": "gravity", "acceleration": [0.0, 0.0, -1.0 * length]}],
        "numerics": numerics | {"newton": {"tolerance": 1e-11}},
    }
