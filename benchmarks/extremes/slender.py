"""Rods and plates that hardly stretch, at rest and in time; and those that collapse."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from math import pi, sqrt
from typing import Any, Final

import numpy as np

from dismech_cli import Report

from .cell import Cell, Check, Deck, near
from .rod_balance import Rod

_LOAD: Final = 0.005  # times EI/L^2, and three times that for rods: the tip moves by about L/600 and L/200
_WEIGHT: Final = [0.0, 0.0, -9.81]


def slender() -> Iterator[Cell]:
    """Stretching stiffness over bending stiffness from 1e5 to 1e17."""
    for aspect in (1e2, 1e3, 1e4, 1e5, 1e6, 1e8):
        label = f"L/h = {aspect:g}"
        yield Cell("hardly stretches", f"rod, {label}", slender_rod(aspect), _tip("rod", -_LOAD, 0.01))
        yield Cell("hardly stretches", f"plate, {label}", slender_plate(aspect), _tip("sheet", 1.67e-3, 0.06))
        yield Cell("hardly stretches", f"pendulum, EA = {aspect**2:g} m g", _pendulum(aspect**2), _swings)


def slender_rod(aspect: float) -> Deck:
    """A cantilever with EA L^2 = 4 aspect^2 EI under a load that moves its tip by L/200."""
    force = {"type": "point", "where": "rod.end", "force": [0.0, 0.0, -3.0 * _LOAD]}
    return rod_scene(axial=4.0 * aspect**2, nodes=21, forces=[force])


def slender_plate(aspect: float) -> Deck:
    """A cantilever plate under the same load over its stiffness, whatever its thickness.

    No Poisson ratio: with one, a plate that sags by more than its thickness is stiffer than a thick one.
    """
    thickness = 100.0 / aspect
    load = _LOAD * 1e6 * thickness**3 / 12.0 / 100.0**2
    return {
        "schema_version": 1,
        "name": "plate",
        "materials": {"m": {"youngs_modulus": 1e6, "poisson_ratio": 0.0, "density": 1000.0}},
        "geometry": [
            {
                "type": "shell",
                "name": "sheet",
                "material": "m",
                "thickness": thickness,
                "generate": {
                    "shape": "sheet",
                    "origin": [0, 0, 0],
                    "length": 100.0,
                    "width": 25.0,
                    "divisions": 6,
                },
            }
        ],
        "motions": [{"type": "clamp", "where": "sheet.left"}],
        "forces": [{"type": "line", "where": "sheet.right", "force_per_length": [0, 0, load]}],
        "numerics": {"integrator": {"type": "static", "load_steps": 2}},
        "output": {"probes": {"tip": {"displacement": "sheet.right", "component": "z"}}},
    }


def _tip(body: str, expected: float, share: float) -> Check:
    length = {"rod": 1.0, "sheet": 100.0}[body]
    return lambda report: near(
        float(report.frames[-1].scalars["tip"]) / length, expected, share, "tip over length"
    )


def _pendulum(stiffness: float) -> Deck:
    """One edge of unit length and mass."""
    start = {"shape": "line", "from": [0, 0, 0], "to": [0.01, 0.0, -1.0], "nodes": 2}
    deck = rod_scene(axial=stiffness * 9.81, line=start, motions=[{"type": "pin", "where": "rod.start"}])
    return deck | {
        "forces": [{"type": "gravity", "acceleration": _WEIGHT}],
        "numerics": {"integrator": {"type": "tr_bdf2"}, "dt": 1e-2, "t_end": 4.2},
        "output": {"every": 1e-2, "probes": {"tip": {"position": "rod.end", "component": "x"}}},
    }


def _swings(report: Report) -> str:
    t, x = np.array([frame.t for frame in report.frames]), report.scalars["tip"]
    down = np.flatnonzero((x[:-1] > 0.0) & (x[1:] <= 0.0))
    crossings = t[down] + x[down] / (x[down] - x[down + 1]) * (t[down + 1] - t[down])
    if len(crossings) < 2:
        return f"{len(crossings)} swings"
    return near(float(np.diff(crossings)[0]), 2.0 * pi / sqrt(9.81), 1e-2, "period")


def collapsing() -> Iterator[Cell]:
    """Ends led together and past each other, rods that shrink to nothing, plates crushed in their plane."""
    for way, steps, axial in product((-0.5, -0.9, -0.999, -1.0, -1.999, -3.0), (5, 40), (1e2, 1e4, 1e6)):
        deck = rod_scene(
            axial=axial,
            nodes=7,
            motions=[
                {"type": "clamp", "where": "rod.start"},
                {"type": "pin", "where": "rod.end", "displacement": [way, 0.0, 1e-3]},
            ],
            numerics={"integrator": {"type": "static", "load_steps": steps}},
        )
        label = f"end led by {way:g} L in {steps} steps, EA = {axial:g} EI/L^2"
        yield Cell("collapses", label, deck, _led(way, axial))
    for strain, integrator in product((-0.5, -0.9, -0.99, -0.9999), ("static", "tr_bdf2")):
        yield Cell(
            "collapses",
            f"shrinks to {1.0 + strain:g} L, {integrator}",
            _shrinking(strain, integrator),
            _shrunk(strain),
        )
    for way, thickness in product((-0.2, -0.6, -0.95), (1e-2, 1e-3)):
        label = f"plate crushed by {-way:g} L, thickness {thickness:g} L"
        yield Cell("collapses", label, _crushed(way, thickness), _held(way))


def _led(way: float, axial: float) -> Check:
    rod = Rod(axial=axial, bending=1.0, mass_per_length=1.0, length=1.0, nodes=7)

    def check(report: Report) -> str:
        x = report.frames[-1].positions[:, [0, 2]]
        if np.abs(x[-1] - [1.0 + way, 1e-3]).max() > 1e-12:
            return f"its end is at {x[-1]}"
        found = rod.unbalanced(x, free=slice(1, -1))
        return "" if found <= 1e-4 else f"forces out of balance by {found:.2g}"

    return check


def _shrinking(strain: float, integrator: str) -> Deck:
    numerics: dict[str, Any] = {"integrator": {"type": "static", "load_steps": 10}}
    value: Any = {"expression": f"{strain}*t"}
    if integrator != "static":
        numerics = {"integrator": {"type": integrator}, "dt": 0.02, "t_end": 2.0}
        value = {"expression": f"{strain}*smoothstep(t)"}
    deck = rod_scene(axial=1e4, nodes=21, numerics=numerics)
    damping = [{"type": "viscous", "coefficient": 10.0}] if integrator != "static" else []
    return deck | {"forces": damping, "actuation": [{"type": "stretch", "rod": "rod", "value": value}]}


def _shrunk(strain: float) -> Check:
    def check(report: Report) -> str:
        x = report.frames[-1].positions
        return near(float(x[-1, 0] - x[0, 0]), 1.0 + strain, 0.02, "length")

    return check


def _crushed(way: float, thickness: float) -> Deck:
    return {
        "schema_version": 1,
        "name": "crushed",
        "materials": {"m": {"youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000.0}},
        "geometry": [
            {
                "type": "shell",
                "name": "sheet",
                "material": "m",
                "thickness": thickness,
                "generate": {
                    "shape": "sheet",
                    "origin": [0, 0, 0],
                    "length": 1.0,
                    "width": 0.4,
                    "divisions": 3,
                },
            }
        ],
        "motions": [
            {"type": "clamp", "where": "sheet.left"},
            {"type": "pin", "where": "sheet.right", "displacement": [way, 0.0, 0.0]},
        ],
        "forces": [{"type": "gravity", "acceleration": [0.0, 0.0, -1.0]}],
        "numerics": {"integrator": {"type": "static", "load_steps": 10}},
    }


def _held(way: float) -> Check:
    """No formula: the edges are where they were led to, and nothing stretches without bound."""

    def check(report: Report) -> str:
        x = report.frames[-1].positions
        if abs(np.ptp(x[[0, -1], 0]) - (1.0 + way)) > 1e-9 and abs(x[:, 0].max() - x[:, 0].min()) < 1.0 + way:
            return "its edges are not where they were led"
        size = float(np.ptp(x, axis=0).max())
        return "" if size <= 1.01 else f"it is {size:.3g} times its size"

    return check


def rod_scene(*, axial: float, nodes: int = 2, line: Deck | None = None, **keys: Any) -> dict[str, Any]:
    """A planar rod along x of unit length, mass and bending stiffness, static and clamped unless told "
    "otherwise."""
    section = {
        "type": "given",
        "axial_stiffness": axial,
        "bending_stiffness_1": 1.0,
        "bending_stiffness_2": 1.0,
        "torsional_stiffness": 1.0,
        "mass_per_length": 1.0,
        "rotary_inertia_per_length": 1e-4,
        "radius": 1e-2,
    }
    body = {"type": "rod", "name": "rod", "material": "m", "section": section}
    straight = {"shape": "line", "from": [0, 0, 0], "to": [1.0, 0, 0], "nodes": nodes}
    return {
        "schema_version": 1,
        "name": "slender",
        "dimension": 2,
        "materials": {"m": {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1000.0}},
        "geometry": [body | {"generate": line or straight}],
        "motions": [{"type": "clamp", "where": "rod.start"}],
        "numerics": {"integrator": {"type": "static", "load_steps": 5}},
        "output": {"probes": {"tip": {"displacement": "rod.end", "component": "z"}}},
    } | keys
